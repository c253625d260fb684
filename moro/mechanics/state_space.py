"""The equations of motion solved for the accelerations: x' = f(x, u)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import sympy as sp

from moro.abc import t
from moro.closed_form import ClosedForm
from moro.closed_form.inverse import LIMIT, Inverse, Rows, TooLongError, inverse
from moro.mechanics.dynamics import Dynamics
from moro.printing.display import Display
from moro.scalars.quotient import lowest
from moro.scalars.relative import RelativeRing
from moro.scalars.trig import Trig, TrigRing


class StateSpace(NamedTuple):
    """x' = f(x, u): x = (q, qd) and f are 2n x 1, u = tau is n x 1."""

    x: sp.Matrix
    u: sp.Matrix
    f: sp.Matrix


@dataclass(frozen=True)
class Solved:
    """A closed form with the inverse of its M, and how quotients are shown."""

    form: ClosedForm
    inverse: Inverse
    display: Display

    def quotients(self, numerators: Sequence[Trig]) -> list[Any]:
        """Return these over the denominators of M^-1, row by row."""
        both = zip(numerators, self.inverse.denominators, strict=True)
        return [self._quotient(x, d) for x, d in both]

    def product(self, rows: Rows, scale: Trig) -> sp.Matrix:
        """Return M^-1 times a matrix, divided by ``scale``."""
        columns = []
        for column in zip(*rows, strict=True):
            both = zip(self.inverse.times(column), self.inverse.denominators, strict=True)
            columns.append([self._quotient(x, d * scale) for x, d in both])
        return sp.Matrix(columns).T

    def matrix(self) -> sp.Matrix:
        """Return M^-1."""
        return sp.Matrix([*map(self.quotients, zip(*self.inverse.numerators, strict=True))]).T

    def _quotient(self, numerator: Trig, denominator: Trig) -> Any:
        """Return a quotient in lowest terms as people write it."""
        numerator, denominator = lowest(numerator, denominator)
        below = self.display(denominator)
        if sum(c < 0 for c in numerator.terms.values()) * 2 > len(numerator):
            return sp.Mul(-1, self.display(-numerator), 1 / below)
        return self.display(numerator) / below


class StateSpaces(Dynamics):
    """Forward dynamics in symbols."""

    def inertia_matrix_inverse(self) -> sp.Matrix:
        """M^-1 (n x n), by cofactors.

        ValueError where the determinant of M is too long to be read; kernels have no such bound.
        """
        self._needed("masses", "cm_positions", "inertia_tensors")

        method = "inertia_matrix_inverse"
        return sp.Matrix(self._kept(method, lambda: self._solved(method).matrix().as_immutable()))

    def forward_dynamics(self) -> sp.Matrix:
        """Accelerations qdd = M^-1 (tau - C qd - G - friction) (n x 1), in q, qd and tau_1..tau_n.

        ValueError where the determinant of M is too long to be read; kernels have no such bound.
        """
        self._warn_if_static("forward_dynamics")
        return self._accelerations()

    def state_space(self) -> StateSpace:
        """Return (x, u, f): x' = f(x, u), x = (q, qd), u = tau, f = (qd, ``forward_dynamics``)."""
        self._warn_if_static("state_space")
        qd = [q.diff(t) for q in self.qs]
        x, f = sp.Matrix([*self.qs, *qd]), sp.Matrix([*qd, *self._accelerations()])
        return StateSpace(x, sp.Matrix(self._taus()), f)

    # -- elements ---------------------------------------------------------------------------------

    def _accelerations(self) -> sp.Matrix:
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")

        def made() -> sp.ImmutableMatrix:
            solved = self._solved("forward_dynamics")
            taus = map(solved.form.ring.convert, self._taus())
            right = [tau - x for tau, x in zip(taus, self._bias(solved.form), strict=True)]
            return sp.ImmutableMatrix(solved.quotients(solved.inverse.times(right)))

        return sp.Matrix(self._kept("qdd", made))

    def _bias(self, form: ClosedForm) -> list[Trig]:
        """Return C qd + G + friction."""
        convert, zero = form.ring.convert, form.ring.zero
        qd = [convert(q.diff(t)) for q in self.qs]
        return [
            sum((x * rate for x, rate in zip(row, qd, strict=True)), zero)
            + form.gravity_vector[i]
            + convert(self._friction(i))
            for i, row in enumerate(form.coriolis_matrix(qd))
        ]

    def _solved(self, method: str) -> Solved:
        """Return M^-1 in the angles of the closed form, or relative ones if that is shorter."""

        def over(form: ClosedForm) -> Solved:
            found = self._inverse(form.inertia_matrix, form.ring, method)
            return Solved(form, found, self._show.over(form.ring, forces=self._taus()))

        def made() -> Solved:
            relative = over(self._form_over(RelativeRing()))
            try:
                plain = over(self._form)
            except ValueError:
                return relative
            return min(plain, relative, key=lambda x: sum(map(len, x.inverse.denominators)))

        return self._kept("solved", made)

    def _inverse(self, M: Rows, ring: TrigRing, method: str) -> Inverse:
        try:
            return inverse(M, ring)
        except TooLongError:
            raise ValueError(
                f"{method}: the determinant of M has more than {LIMIT} terms here; linearize takes "
                "numbers for q0, with_parameters for symbols, and moro_codegen makes kernels of "
                "forward_dynamics and forward_dynamics_derivatives"
            ) from None
        except ZeroDivisionError:
            raise ValueError(
                f"{method}: M is singular, for some joint moves nothing that has inertia; give "
                "masses, inertia tensors or rotor inertias"
            ) from None
