"""Trigonometric polynomials as people write them: the way from ``Trig`` to SymPy.

The canonical form is made for computing. For reading, an entry is brought to its shortest
common form, always by the same rules, so that equal polynomials give identical expressions:

- parallel joints show their differences and sums as one angle: ``c2 c23 + s2 s23`` is ``cos(q3)``;
- ``x - x c^2`` is ``x s^2``;
- what all terms share stands in front of a bracket;
- terms are grouped by velocities, then by trigonometric factors or by masses and inertias,
  whichever takes fewer operations.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import Any

import sympy as sp

from moro.trig import Coefficient, Monomial, Trig, TrigRing

Terms = dict[Monomial, Coefficient]


@dataclass(frozen=True)
class Group:
    """A part of a sum: ``key * content * sum of terms``, the first two monomials."""

    key: Monomial
    content: Monomial
    terms: Terms


class Display:
    """Writes the polynomials of one ring as SymPy expressions.

    ``inertial`` are the symbols of masses and inertia tensors, ``velocities`` those of joint
    velocities and accelerations: the texts group by them. With ``decimal``,
    coefficients that are not whole become floats.
    """

    def __init__(
        self,
        ring: TrigRing,
        inertial: Iterable[Any] = (),
        velocities: Iterable[Any] = (),
        decimal: bool = False,
    ):
        self.ring = ring
        self._decimal = decimal
        self._inertial_symbols = list(inertial)
        self._velocity_symbols = list(velocities)
        self._monomials: dict[Monomial, Any] = {0: sp.Integer(1)}
        self._costs: dict[Monomial, int] = {0: 0}
        self._terms: dict[tuple[Monomial, Coefficient], Any] = {}
        self._differences: dict[tuple[Any, Any], tuple[int, Trig, Trig]] = {}

    def __call__(self, p: Trig) -> Any:
        """Return ``p`` in its shortest common form."""
        return self._sum(self.shortened(p))

    def by_trig(self, p: Trig) -> list[Group]:
        """Return ``p`` grouped by its trigonometric (and velocity) monomials."""
        mask = self._trig_mask() | self.ring.mask(self._velocity_symbols)
        return self._grouped(self.shortened(p), mask)

    # -- shorter terms ----------------------------------------------------------------------------

    def shortened(self, p: Trig) -> Terms:
        """Join terms by ``c_a c_b + s_a s_b = cos(b - a)`` and ``x - x c^2 = x s^2``."""
        terms = {m: _whole(c) for m, c in sorted(p.terms.items())}
        for group in self.ring.groups:
            for j, b in enumerate(group):
                for a in group[:j]:
                    self._join_differences(terms, a, b)
        for sine, cosine in self.ring.pairs.values():
            self._join_squares(terms, self.ring.unit(sine), self.ring.unit(cosine))
        return terms

    def _join_differences(self, terms: Terms, a: Any, b: Any) -> None:
        (sa, ca), (sb, cb) = (map(self.ring.unit, self.ring.pairs[x]) for x in (a, b))
        ss, cc, sc, cs = sa + sb, ca + cb, sb + ca, cb + sa
        field = self.ring.field
        for m in [m for m in terms if m & sa and m & sb]:
            partner = m - ss + cc
            if terms.get(partner) == terms[m]:
                _, _, cosine = self._difference(a, b)
                _move(terms, m, partner, m - ss + _only(cosine), terms[m])
        for m in [m for m in terms if m & sb and m & field(ca) and not m & sa]:
            partner = m - sc + cs
            if terms.get(partner) == -terms[m]:
                sign, sine, _ = self._difference(a, b)
                _move(terms, m, partner, m - sc + _only(sine), sign * terms[m])

    def _difference(self, a: Any, b: Any) -> tuple[int, Trig, Trig]:
        """Return (sign, sin, cos) with sin(b - a) = sign * sin, as generators for reading only."""
        if (a, b) not in self._differences:
            angle = sp.expand(b - a)
            sign = -1 if angle.could_extract_minus_sign() else 1
            sine, cosine = sp.sin(sign * angle), sp.cos(sign * angle)
            self._differences[a, b] = sign, self.ring.generator(sine), self.ring.generator(cosine)
        return self._differences[a, b]

    def _join_squares(self, terms: Terms, sine: Monomial, cosine: Monomial) -> None:
        field = self.ring.field(cosine)
        for m in [m for m in terms if m & field == 2 * cosine]:
            partner = m - 2 * cosine
            if terms.get(partner) == -terms[m]:
                _move(terms, m, partner, partner + 2 * sine, -terms[m])

    # -- brackets ---------------------------------------------------------------------------------

    def _sum(self, terms: Terms) -> Any:
        """Return the terms as a SymPy expression with the fewest operations of a few groupings."""
        if len(terms) < 2:
            return self._flat(terms)
        common = self._common(terms)
        if common:
            inner = self._sum({m - common: c for m, c in terms.items()})
            return _product(self._monomial(common), inner)
        velocity = self.ring.mask(self._velocity_symbols)
        if any(m & velocity for m in terms) and any(m & ~velocity for m in terms):
            return self._by_velocity(terms, velocity)
        candidates = [self._trig_mask(), self.ring.mask(self._inertial_symbols)]
        groupings = [self._grouped(terms, mask) for mask in candidates]
        best = min(groupings, key=self._cost)
        return sp.Add(*map(self._bracket, best))

    def _by_velocity(self, terms: Terms, velocity: int) -> Any:
        """Group by products of velocities; those with proportional factors share one bracket."""
        brackets: dict[Any, tuple[Terms, Terms]] = {}
        for key, part in self._parts(terms, velocity).items():
            scale = _content(part)
            if scale != 1:
                part = {m: _quotient(c, scale) for m, c in part.items()}
            _, rates = brackets.setdefault(frozenset(part.items()), (part, {}))
            rates[key] = scale
        return sp.Add(
            *(_product(self._sum(rates), self._sum(part)) for part, rates in brackets.values())
        )

    def _bracket(self, group: Group) -> Any:
        front = self._monomial(group.key + group.content)
        return _product(front, self._inner(group.terms))

    def _inner(self, terms: Terms) -> Any:
        """Return the terms as they are, or grouped by masses and inertias where that is shorter."""
        if len(terms) > 2:
            groups = self._grouped(terms, self.ring.mask(self._inertial_symbols))
            if self._cost(groups) < self._cost([Group(0, 0, terms)]):
                fronts = [self._monomial(group.key + group.content) for group in groups]
                flats = [self._flat(group.terms) for group in groups]
                return sp.Add(*map(_product, fronts, flats))
        return self._flat(terms)

    def _grouped(self, terms: Terms, mask: int) -> list[Group]:
        groups = []
        for key, part in self._parts(terms, mask).items():
            common = self._common(part)
            groups.append(Group(key, common, {m - common: c for m, c in part.items()}))
        return groups

    @staticmethod
    def _parts(terms: Terms, mask: int) -> dict[Monomial, Terms]:
        parts: dict[Monomial, Terms] = {}
        for m, c in terms.items():
            parts.setdefault(m & mask, {})[m & ~mask] = c
        return parts

    def _common(self, terms: Terms) -> Monomial:
        """Return the greatest monomial that divides every term."""
        monomials = iter(terms)
        common = next(monomials)
        for m in monomials:
            if not common:
                return 0
            common = self.ring.common_factor(common, m)
        return common

    def _trig_mask(self) -> int:
        indices = [i for pair in self.ring.pairs.values() for i in pair]
        fields = [self.ring.field(self.ring.unit(i)) for i in indices]
        for _, sine, cosine in self._differences.values():
            fields += [self.ring.field(_only(sine)), self.ring.field(_only(cosine))]
        return sum(fields)

    # -- operations -------------------------------------------------------------------------------

    def _cost(self, groups: list[Group]) -> int:
        total = -1
        for group in groups:
            inside = sum(self._term_cost(m, c) for m, c in group.terms.items())
            front = self._monomial_cost(group.key + group.content)
            total += 1 + inside + len(group.terms) - 1 + front + (1 if front and inside else 0)
        return total

    def _term_cost(self, m: Monomial, c: Coefficient) -> int:
        return self._monomial_cost(m) + (1 if m and c not in (1, -1) else 0)

    def _monomial_cost(self, m: Monomial) -> int:
        cost = self._costs.get(m)
        if cost is None:
            factors = self.ring.exponents(m)
            cost = len(factors) - 1
            for i, e in factors:
                cost += (e > 1) + (0 if self.ring.generators[i].is_Symbol else 1)
            self._costs[m] = cost
        return cost

    # -- SymPy ------------------------------------------------------------------------------------

    def _flat(self, terms: Terms) -> Any:
        return sp.Add(*(self._term(m, c) for m, c in terms.items()))

    def _term(self, m: Monomial, c: Coefficient) -> Any:
        term = self._terms.get((m, c))
        if term is None:
            term = self._terms[m, c] = sp.Mul(self._number(c), self._monomial(m))
        return term

    def _number(self, c: Coefficient) -> Any:
        number = sp.Rational(c.numerator, c.denominator)
        return sp.Float(number) if self._decimal and not number.is_Integer else number

    def _monomial(self, m: Monomial) -> Any:
        found = self._monomials.get(m)
        if found is None:
            generators = self.ring.generators
            factors = (generators[i] ** e for i, e in self.ring.exponents(m))
            found = self._monomials[m] = sp.Mul(*factors)
        return found


def _only(generator: Trig) -> Monomial:
    (m,) = generator.terms
    return m


def _move(terms: Terms, m: Monomial, partner: Monomial, joined: Monomial, c: Coefficient) -> None:
    del terms[m], terms[partner]
    total = terms.get(joined, 0) + c
    if total:
        terms[joined] = total
    else:
        del terms[joined]


def _content(terms: Terms) -> Coefficient:
    """Return the number to divide by: coprime whole numbers, or a first one, remain."""
    numbers = [c for c in terms.values() if isinstance(c, int)]
    if len(numbers) == len(terms):
        content = gcd(*numbers)
        return -content if all(c < 0 for c in numbers) else content
    return terms[min(terms)]


def _quotient(c: Coefficient, divisor: Coefficient) -> Coefficient:
    return _whole(Fraction(c, divisor))


def _whole(c: Coefficient) -> Coefficient:
    """Return a whole fraction as an integer."""
    return c.numerator if c.denominator == 1 else c


def _product(front: Any, bracket: Any) -> Any:
    """Return front * bracket; a minus sign that all terms of a sum share is pulled out."""
    sign = 1
    factors = []
    for factor in (front, bracket):
        negative = factor.is_Add and all(x.could_extract_minus_sign() for x in factor.args)
        sign = -sign if negative else sign
        factors.append(-factor if negative else factor)
    return sp.Mul(sign, *factors)
