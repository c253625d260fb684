"""The linear model of a robot at a point: how deviations from it go on."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import Any, NamedTuple

import sympy as sp

from moro.checks import values as checks
from moro.closed_form.slopes import Slopes
from moro.mechanics.state_space import Solved, StateSpaces
from moro.mechanics.substitution import Substitution
from moro.printing.equations import Equation, in_brackets
from moro.printing.notation import Notation
from moro.printing.notebook import WIDTH, Shown
from moro.scalars.points import Point
from moro.scalars.relative import RelativeRing
from moro.scalars.trig import Trig


class _Pair(NamedTuple):
    A: sp.Matrix
    B: sp.Matrix


class LinearModel(_Pair, Shown):
    """dx/dt = A dx + B du for small deviations from a point: unpacks as ``A, B``."""

    _notation: Notation

    def __new__(cls, A: sp.Matrix, B: sp.Matrix, notation: Notation | None = None) -> LinearModel:
        """Join A (2n x 2n) and B (2n x n)."""
        self = super().__new__(cls, A, B)
        self._notation = notation or Notation()
        return self

    def formulas(self) -> list[Equation]:
        """Return A and B as matrices if they fit on a line, else the entries that are not zero."""
        write = self._notation.formula
        return [*in_brackets("A", self.A, write, WIDTH), *in_brackets("B", self.B, write, WIDTH)]


class Linearization(StateSpaces, Substitution):
    """Linear models, by exact derivatives of the equations of motion."""

    def equilibrium_torques(self, q0: Sequence[Any] | None = None) -> sp.Matrix:
        """Torques (n x 1) that hold the robot at rest at ``q0``: G, springs included.

        Coulomb friction holds it, too, where they are off by less than what breaks away.
        """
        return self.substitute(self.gravity_vector(), q=q0)

    def linearize(
        self,
        q0: Sequence[Any] | None = None,
        qd0: Sequence[Any] | None = None,
        tau0: Sequence[Any] | None = None,
    ) -> LinearModel:
        """Return A (2n x 2n) and B (2n x n) of dx/dt = A dx + B du, x = (q, qd), u = tau.

        The point is q0 (None: any, in symbols), qd0 (at rest), tau0 (the torques at which qdd = 0
        there, ``equilibrium_torques`` at rest). With tau(q, qd, qdd) the left-hand sides of the
        equations of motion, springs and friction included,

            A = [0, 1; -M^-1 dtau/dq, -M^-1 dtau/dqd],    B = [0; M^-1].

        Exact values give exact results, floats numbers. The sharp step of Coulomb friction has no
        slope: at rest it is left out, so A and B say how a joint goes on that has broken away;
        smooth friction (``Drive.width``) has the slope of its tanh. ValueError where the
        determinant of M is too long to be read, which it is not where q0 is in numbers.
        """
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")
        given = {"q0": q0, "qd0": qd0, "tau0": tau0}
        q, qd, tau = (self._point_value(x, name) for name, x in given.items())
        decimal = self._source.decimal or any(map(checks.has_float, given.values()))
        form = self._form if q else self._form_over(RelativeRing())
        point = Point(form.ring, dict(zip(self.qs, q or (), strict=False)), decimal)
        rates = [point.value(x) for x in qd or [0] * self.dof]
        slopes, frictions = Slopes(form, point, rates), self._frictions(rates, point)
        M = self._inverse(slopes.inertia_matrix(), form.ring, "linearize")
        by_position, scale = slopes.of_forces(), form.ring.one
        if tau is not None:
            forces = zip(tau, slopes.forces(), frictions, strict=True)
            left = [point.value(x) - force - friction for x, force, (friction, _) in forces]
            scale = prod(dict.fromkeys(M.denominators), start=scale)  # that of all accelerations
            qdd = [x * y for x, y in zip(M.times(left), _others(M.denominators), strict=True)]
            parts = zip(by_position, slopes.of_inertia(qdd), strict=True)
            by_position = [[x * scale + y for x, y in zip(*rows, strict=True)] for rows in parts]
        by_rate = [[x * 2 for x in row] for row in slopes.coriolis_matrix()]
        for i, (_, slope) in enumerate(frictions):
            by_rate[i][i] += slope
        solved = Solved(form, M, self._show.over(form.ring, decimal=decimal))
        below = [solved.product(by_position, -scale), solved.product(by_rate, -form.ring.one)]
        n = self.dof
        A = sp.Matrix.vstack(sp.Matrix.hstack(sp.zeros(n), sp.eye(n)), sp.Matrix.hstack(*below))
        B = sp.Matrix.vstack(sp.zeros(n), solved.matrix())
        return LinearModel(A, B, self._notation)

    # -- elements ---------------------------------------------------------------------------------

    def _point_value(self, values: Sequence[Any] | None, name: str) -> list[Any] | None:
        if values is None:
            return None
        items = checks.scalars(values, self.dof, name, of="joint")
        return [checks.scalar(x, f"{name} of joint {i}") for i, x in enumerate(items, 1)]

    def _frictions(self, qd: Sequence[Trig], point: Point) -> list[tuple[Trig, Trig]]:
        """Return the friction of every coordinate, and its slope, of which steps have none."""
        found = []
        for i, x in enumerate(qd):
            rate, value = sp.Dummy(real=True), x.ring.expanded(x)
            friction = self._friction(i, rate)
            slope = friction.diff(rate).replace(sp.DiracDelta, lambda *_: sp.Integer(0))
            at = (point.value(y.xreplace({rate: value})) for y in (friction, slope))
            found.append((next(at), next(at)))
        return found


def _others(denominators: Sequence[Trig]) -> list[Trig]:
    """Return for each the product of those that differ from it."""
    different = dict.fromkeys(denominators)
    one = denominators[0].ring.one
    return [prod((y for y in different if y != x), start=one) for x in denominators]
