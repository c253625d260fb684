"""Long results in few names: the coefficients of M and P are named, everything follows in names.

M is a sum of trigonometric monomials times coefficients, combinations of masses, lengths and
inertias. The coefficients span a vector space over the rationals. A basis of it is picked among
the coefficients themselves, the most frequent first, and gets names k_1, k_2, ...; the few others
are combinations of the basis. This is how explicit models of arms are published: Armstrong, Khatib
& Burdick, The explicit dynamic model and inertial parameters of the PUMA 560 arm, ICRA 1986, have
a11 = Im1 + I1 + I3 CC2 + I7 SS23 + ... with a list of the I_k.

Since the names are independent, two polynomials in them are equal exactly if what they stand for
is equal. So C, the Christoffel symbols of M in names, needs no further names and is as short as it
can be; so are K and the equations of motion. The coefficients of P get names of their own, for G.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any

import sympy as sp

from moro.abc import t
from moro.closed_form import ClosedForm
from moro.printing.collected import Collected
from moro.printing.display import Display
from moro.printing.named_constants import Combination, NamedConstants, whole
from moro.printing.notation import Notation
from moro.scalars.relations import Monomial
from moro.scalars.trig import Trig, TrigRing


class Collector:
    """Writes M, C, G, the energies and the equations of motion of an arm in named constants.

    ``form`` holds the closed forms, ``display`` writes them, ``notation`` prints them; ``symbols``
    are those that the model has itself.
    """

    def __init__(
        self, form: ClosedForm, display: Display, notation: Notation, symbols: Iterable[Any] = ()
    ):
        self._form = form
        self._display = display
        self._taken = {x.name for x in (*symbols, *form.qs)}
        self._notation = notation

    def inertia_matrix(self) -> Collected:
        """M in names k_1, k_2, ..."""
        form = self._inertial_form
        return self._collected("M", form, form.inertia_matrix)

    def coriolis_matrix(self) -> Collected:
        """C, by Christoffel symbols of M in names."""
        form = self._inertial_form
        return self._collected("C", form, form.coriolis_matrix(form.rates(1)))

    def gravity_vector(self) -> Collected:
        """G in names gamma_1, gamma_2, ..."""
        form = self._gravity_form
        return self._collected("G", form, [[x] for x in form.gravity_vector])

    def kinetic_energy(self) -> Collected:
        """K = 1/2 qd^T M qd, as a 1 x 1 matrix."""
        form = self._inertial_form
        return self._collected("K", form, [[form.kinetic_energy()]])

    def potential_energy(self) -> Collected:
        """P, as a 1 x 1 matrix."""
        form = self._gravity_form
        return self._collected("P", form, [[form.potential_energy]])

    def equations(self, friction: Sequence[Any], taus: Sequence[Any]) -> Collected:
        """M qdd + C qd + G + friction = tau, row by row."""
        form = NamedForm(self._form, self._inertial_names, self._gravity_names)
        left = [[x] for x in form.equations()]
        return self._collected("tau", form, left, friction, tuple(taus))

    def christoffel_symbols(self) -> dict[tuple[int, int, int], Any]:
        """c_ijk in names for j <= k, counted from 1, without those that are 0."""
        form, n = self._inertial_form, self._form.n
        write = self._display.over(form.ring, form.names)
        indices = [(i, j, k) for i in range(n) for j in range(n) for k in range(j, n)]
        values = {(i + 1, j + 1, k + 1): form.christoffel(i, j, k) for i, j, k in indices}
        return {key: write(c) for key, c in values.items() if c}

    @cached_property
    def constants(self) -> dict[Any, Any]:
        """All names of M and what they stand for."""
        return {name: self._display(p) for name, p in self._inertial_names.meanings.items()}

    @cached_property
    def _inertial_names(self) -> NamedConstants:
        M, n = self._form.inertia_matrix, self._form.n
        return self._names([M[i][j] for i in range(n) for j in range(i, n)], "k")

    @cached_property
    def _gravity_names(self) -> NamedConstants:
        P = sum(self._form.potential_energies, self._form.ring.zero)
        return self._names([*self._form.gravity_vector, P], "gamma")

    @cached_property
    def _inertial_form(self) -> NamedForm:
        return NamedForm(self._form, self._inertial_names)

    @cached_property
    def _gravity_form(self) -> NamedForm:
        return NamedForm(self._form, self._gravity_names)

    def _names(self, polynomials: Sequence[Trig], letter: str) -> NamedConstants:
        while any(re.fullmatch(rf"{letter}_\{{?\d+\}}?", name) for name in self._taken):
            letter += "c"
        return NamedConstants(self._form.ring, polynomials, moving(self._form), letter)

    def _collected(
        self,
        name: str,
        form: NamedForm,
        rows: Sequence[Sequence[Trig]],
        extra: Sequence[Any] | None = None,
        right: tuple[Any, ...] = (),
    ) -> Collected:
        write = self._display.over(form.ring, form.names)
        extra = extra or [sp.Integer(0)] * len(rows)

        def matrix(show: Callable[[Trig], Any]) -> list[list[Any]]:
            return [[show(p) + x for p in row] for row, x in zip(rows, extra, strict=True)]

        written = sp.ImmutableMatrix(matrix(write))
        occurring = written.free_symbols
        constants = {k: self._display(p) for k, p in form.names.items() if k in occurring}
        return Collected(
            name,
            written,
            MappingProxyType(constants),
            right,
            _expanded=lambda: sp.Matrix(matrix(lambda p: self._display(form.expanded(p)))),
            _notation=self._notation,
        )


class NamedForm(ClosedForm):
    """The closed form of an arm in names: polynomials over a ring that has them as generators."""

    def __init__(self, form: ClosedForm, *names: NamedConstants):
        self.ring: TrigRing
        super().__init__(form.model, TrigRing())
        self._original = form
        self._original_ring: TrigRing = form.ring
        self._names = names
        #: {name: what it stands for}, in the original ring
        self.names = {k: p for some in names for k, p in some.meanings.items()}
        for symbol in (*self.qs, *self._derivatives(1), *self._derivatives(2), *self.names):
            self.ring.convert(symbol)
        self._moving = moving(form)
        self._factors: dict[Any, Trig] = {}
        self._originals: dict[Monomial, Trig] = {}

    def rates(self, order: int) -> list[Trig]:
        """Return the joint velocities (order 1) or accelerations (2), 0 for plain symbols."""
        return [self.ring.convert(x) for x in self._derivatives(order)]

    @cached_property
    def inertia_matrix(self) -> list[list[Trig]]:
        """M in names."""
        M, n = self._original.inertia_matrix, self.n
        lower = [[self._named(M[i][j]) for j in range(i + 1)] for i in range(n)]
        return [[lower[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]

    @cached_property
    def potential_energy(self) -> Trig:
        """P in names."""
        return self._named(sum(self._original.potential_energies, self._original_ring.zero))

    @cached_property
    def gravity_vector(self) -> list[Trig]:
        """G = grad P in names."""
        return [self.ring.diff(self.potential_energy, q) for q in self.qs]

    def kinetic_energy(self) -> Trig:
        """K = 1/2 qd^T M qd in names."""
        M, qd, n = self.inertia_matrix, self.rates(1), range(self.n)
        K: Trig = self._sum(M[i][j] * qd[i] * qd[j] for i in n for j in n) * self.ring.half
        return K

    def equations(self) -> list[Trig]:
        """M qdd + C qd + G in names."""
        M, qd, qdd = self.inertia_matrix, self.rates(1), self.rates(2)
        C, G, n = self.coriolis_matrix(qd), self.gravity_vector, range(self.n)
        return [
            G[i] + self._sum(M[i][j] * qdd[j] for j in n) + self._sum(C[i][j] * qd[j] for j in n)
            for i in n
        ]

    def expanded(self, p: Trig) -> Trig:
        """Return a polynomial in names in the original ring, with what they stand for."""
        mask = self.ring.mask(self.names)
        parts: dict[Monomial, Trig] = {}
        total = zero = self._original_ring.zero
        for m, c in p.terms.items():
            rest = m & ~mask
            parts[rest] = parts.get(rest, zero) + self._original_of(m & mask) * c
        for m, coefficient in parts.items():
            total = total + self._original_of(m) * coefficient
        return total

    def _named(self, p: Trig) -> Trig:
        total = self.ring.zero
        for m, coefficient in self._original_ring.coefficients(p, self._moving).items():
            combination = self._combination(coefficient)
            terms = (self._factor(item) * whole(c) for item, c in combination.items())
            total = total + self._factor(m) * sum(terms, self.ring.zero)
        return total

    def _combination(self, coefficient: Trig) -> Combination:
        for some in self._names:
            found = some.combination(coefficient)
            if found is not None:
                return found
        raise ValueError(f"a coefficient has no name: {coefficient}")

    def _factor(self, item: Any) -> Trig:
        """Return a name, or a monomial of the original ring, in this ring."""
        if item not in self._factors:
            powers = [(item, 1)]
            if isinstance(item, int):
                powers = _powers(self._original_ring, item)
            converted = [(self.ring.convert(g), e) for g, e in powers]
            self._factors[item] = _product(self.ring, converted)
        return self._factors[item]

    def _original_of(self, m: Monomial) -> Trig:
        """Return a monomial of this ring in the original ring, with what names stand for."""
        if m not in self._originals:
            ring = self._original_ring
            meanings = _powers(self.ring, m)
            powers = [(self.names.get(g) or ring.convert(g), e) for g, e in meanings]
            self._originals[m] = _product(ring, powers)
        return self._originals[m]

    def _derivatives(self, order: int) -> list[Any]:
        return [q.diff(t, order) for q in self.qs]


def moving(form: ClosedForm) -> list[Any]:
    """Return the generators that hold joint variables or their derivatives."""
    return [g for g in form.ring.generators if g.has(*form.qs)]


def _powers(ring: TrigRing, m: Monomial) -> list[tuple[Any, int]]:
    return [(ring.generators[i], e) for i, e in ring.exponents(m)]


def _product(ring: TrigRing, powers: Iterable[tuple[Trig, int]]) -> Trig:
    product = ring.one
    for factor, times in powers:
        for _ in range(times):
            product = product * factor
    return product
