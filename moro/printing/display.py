"""Trigonometric polynomials as people write them: the way from ``Trig`` to SymPy.

The canonical form is made for computing. For reading, an entry is brought to its shortest
common form, always by the same rules, so that equal polynomials give identical expressions:

- parallel joints show their differences and sums as one angle: ``c2 c23 + s2 s23`` is ``cos(q3)``;
- ``x - x c^2`` is ``x s^2``;
- ``a^2 + 2 a b + b^2`` is ``(a + b)^2``, and ``a c + a d + b c + b d`` is ``(a + b) (c + d)``;
- what all terms share, whole numbers and signs included, stands in front of a bracket;
- no minus sign stands before a bracket that begins with one, or in front of an angle;
- terms are grouped by velocities, then by trigonometric factors, by masses and inertias, or by
  all but these, whichever takes fewer operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key
from math import gcd, lcm
from typing import Any

import sympy as sp

from moro.printing.products import factors
from moro.printing.squares import Square, squares_in
from moro.scalars.relations import Coefficient, Monomial
from moro.scalars.trig import Trig, TrigRing

Terms = dict[Monomial, Coefficient]


#: terms that a bracket may have in common beside whole numbers: halves, quarters, ...
_MAX_DENOMINATOR = 8


@dataclass(frozen=True)
class Group:
    """A part of a sum: ``scale * sum of fronts * sum of terms``."""

    scale: Coefficient
    fronts: Terms
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
        self._powers: dict[tuple[int, int], tuple[Any, Any]] = {}
        self._terms: dict[tuple[Monomial, Coefficient], Any] = {}
        self._differences: dict[tuple[Any, Any], tuple[int, Trig, Trig]] = {}
        self._opposites: dict[Any, tuple[Trig, ...]] = {}
        self._shown: dict[Trig, Any] = {}
        self._brackets: dict[frozenset[tuple[Monomial, Coefficient]], Any] = {}

    def __call__(self, p: Trig) -> Any:
        """Return ``p`` in its shortest common form."""
        found = self._shown.get(p)
        if found is None:
            found = self._shown[p] = self._shortest(p)
        return found

    def _shortest(self, p: Trig) -> Any:
        """Return ``p`` as a sum, or over one denominator if that is shorter."""
        whole = self._sum(self.shortened(p))
        below = self.ring.one
        for index, divisor in self.ring.reciprocals.items():
            highest = max((self.ring.exponent(m, index) for m in p.terms), default=0)
            for _ in range(highest):
                p, below = p * divisor, below * divisor
        if below == 1:
            return whole
        found = sp.Mul(self._sum(self.shortened(p)), 1 / self._sum(self.shortened(below)))
        return found if found.count_ops() < whole.count_ops() else whole

    def simplified(self, expr: Any) -> Any:
        """Return a SymPy expression, or matrix, in its shortest common form."""
        if isinstance(expr, sp.MatrixBase):
            return expr.applyfunc(self.simplified)
        return self(self.ring.convert(expr))

    def over(
        self,
        ring: TrigRing,
        inertial: Iterable[Any] | None = None,
        forces: Iterable[Any] = (),
        decimal: bool = False,
    ) -> Display:
        """Return a display that writes alike, for another ring, and for masses and inertias there.

        It groups by ``forces`` as by velocities. With ``decimal`` it writes decimals.
        """
        inertial = self._inertial_symbols if inertial is None else inertial
        rates = [*self._velocity_symbols, *forces]
        return Display(ring, inertial, rates, self._decimal or decimal)

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
        for angle in [x for x in self.ring.pairs if x.could_extract_minus_sign()]:
            terms = self._turned(terms, angle)
        return terms

    def _turned(self, terms: Terms, angle: Any) -> Terms:
        """Write sin(x) as -sin(-x) and cos(x) as cos(-x)."""
        sine, cosine = self.ring.pairs[angle]
        turned: Terms = {}
        for m, c in terms.items():
            for index, new in zip((sine, cosine), self._opposite(angle), strict=True):
                e = self.ring.exponent(m, index)
                m += e * (_only(new) - self.ring.unit(index))
                c = -c if index == sine and e % 2 else c
            turned[m] = turned.get(m, 0) + c
        return turned

    def _opposite(self, angle: Any) -> tuple[Trig, Trig]:
        """Return sin(-angle) and cos(-angle), as generators for reading only."""
        if angle not in self._opposites:
            both = (f(-angle, evaluate=False) for f in (sp.sin, sp.cos))
            self._opposites[angle] = tuple(map(self.ring.generator, both))
        sine, cosine = self._opposites[angle]
        return sine, cosine

    def _join_differences(self, terms: Terms, a: Any, b: Any) -> None:
        (sa, ca), (sb, cb) = (map(self.ring.unit, self.ring.pairs[x]) for x in (a, b))
        ss, cc, sc, cs = sa + sb, ca + cb, sb + ca, cb + sa
        field = self.ring.field
        # c_a c_b x + s_a s_b x = cos(b - a) x; a sine's exponent is 0 or 1: its lowest bit tells
        for m in [m for m in terms if m & sa and m & sb]:
            partner = m - ss + cc
            if terms.get(partner) == terms[m]:
                _, _, cosine = self._difference(a, b)
                _move(terms, m, partner, m - ss + _only(cosine), terms[m])
        # s_b c_a x - s_a c_b x = sin(b - a) x; terms with s_a s_b belong to the rule above
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
        # x - x c^2 = x s^2; an exponent of c that is exactly 2 is all of its field
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
            scale, terms = _extracted({m - common: c for m, c in terms.items()})
            return _signed(self._number(scale), self._monomial(common), self._sum(terms))
        squares, rest = self._squares(terms)
        if squares and not rest:
            return sp.Add(*(self._square(x) for x in squares))
        both = factors(terms)
        if both is not None:
            return self._product(both, self._sum)
        velocity = self.ring.mask(self._velocity_symbols)
        if any(m & velocity for m in terms) and any(m & ~velocity for m in terms):
            return self._by_velocity(terms, velocity)
        candidates = [self._trig_mask(), self.ring.mask(self._inertial_symbols)]
        groupings = [self._grouped(terms, mask) for mask in candidates]
        best = min(groupings, key=self._cost)
        return sp.Add(*map(self._bracket, best))

    def _by_velocity(self, terms: Terms, velocity: int) -> Any:
        """Group by products of velocities; those with proportional factors share one bracket."""
        shared: dict[Any, tuple[Terms, Terms]] = {}
        for key, part in self._parts(terms, velocity).items():
            scale, factor = _primitive(part)
            _, rates = shared.setdefault(frozenset(factor.items()), (factor, {}))
            rates[key] = scale
        brackets = []
        for factor, rates in shared.values():
            for unit, multiples in _multiples(rates, 1 if len(factor) == 1 else None):
                scale, multiples = _extracted(multiples)
                bracket = self._sum({m: _whole(c * unit) for m, c in factor.items()})
                brackets.append(_signed(self._number(scale), self._sum(multiples), bracket))
        return sp.Add(*brackets)

    def _bracket(self, group: Group) -> Any:
        front, inner = self._sum(group.fronts), self._inner(group.terms)
        return _signed(self._number(group.scale), front, inner)

    def _inner(self, terms: Terms) -> Any:
        """Return the terms as they are, or grouped by masses and inertias where that is shorter."""
        if len(terms) < 3:
            return self._flat(terms)
        key = frozenset(terms.items())
        found = self._brackets.get(key)
        if found is None:
            inertial = self.ring.mask(self._inertial_symbols)
            groupings = [[Group(1, {0: 1}, terms)]]
            groupings.append(self._grouped(terms, inertial))
            if len({m & ~inertial for m in terms}) < len(terms):
                groupings.append(self._grouped(terms, ~inertial))
            best = min(groupings, key=self._cost)
            found = self._brackets[key] = sp.Add(
                *(
                    _signed(self._number(g.scale), self._flat(g.fronts), self._flat(g.terms))
                    for g in best
                )
            )
        return found

    def _grouped(self, terms: Terms, mask: int) -> list[Group]:
        """Group by the factors in ``mask``; those with equal brackets share one."""
        shared: dict[Any, tuple[Terms, Terms]] = {}
        for key, part in self._parts(terms, mask).items():
            common = self._common(part)
            front, part = key + common, {m - common: c for m, c in part.items()}
            scale, part = _extracted(part) if front else (1, part)
            _, fronts = shared.setdefault(
                frozenset(part.items()) if len(part) > 1 else front, (part, {})
            )
            fronts[front] = scale
        groups = []
        for part, fronts in shared.values():
            scale, fronts = _extracted(fronts)
            groups.append(Group(scale, fronts, part))
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
        others = [*(pair for _, *pair in self._differences.values()), *self._opposites.values()]
        fields += [self.ring.field(_only(x)) for pair in others for x in pair]
        return sum(fields)

    # -- operations -------------------------------------------------------------------------------

    def _cost(self, groups: list[Group]) -> int:
        total = -1
        for group in groups:
            factors = 1 + (abs(group.scale) != 1) + (group.fronts != {0: 1} != group.terms)
            total += factors + self._sum_cost(group.fronts) + self._sum_cost(group.terms)
        return total

    def _sum_cost(self, terms: Terms) -> int:
        both = factors(terms)
        if both is not None:
            return 1 + sum(map(self._sum_cost, both))
        squares, rest = self._squares(terms)
        total = sum(self._term_cost(m, c) for m, c in rest.items()) + len(rest) - 1
        for scale, root in squares:
            total += 2 + (scale not in (1, -1)) + self._sum_cost(root)
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
        both = factors(terms)
        if both is not None:
            return self._product(both, self._flat)
        squares, rest = self._squares(terms)
        flat = (self._term(m, c) for m, c in rest.items())
        return sp.Add(*map(self._square, squares), *flat)

    def _product(self, both: tuple[Terms, Terms], show: Callable[[Terms], Any]) -> Any:
        """Return a product of two sums, signs and whole numbers in front of it."""
        (scale, first), (other, second) = map(_extracted, both)
        number = self._number(_whole(Fraction(scale) * other))
        return _signed(number, show(first), show(second))

    def _squares(self, terms: Terms) -> tuple[list[Square], Terms]:
        """Return the squares of sums among the terms, and the others."""
        if len(terms) < 3:
            return [], terms
        odd = self.ring.lowest_bits
        even = sorted(m for m in terms if not m & odd)
        return squares_in(terms, even) if len(even) > 1 else ([], terms)

    def _square(self, square: Square) -> Any:
        root = self._sum(square.root)
        if root.is_Add and _begins_with_minus(root):
            root = _negated(root)
        return sp.Mul(self._number(square.scale), root**2)

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
            found = self._monomials[m] = self._sorted_product(self.ring.exponents(m))
        return found

    def _sorted_product(self, factors: list[tuple[int, int]]) -> Any:
        """Return a product of powers of generators.

        Powers of different symbols and functions are a SymPy product as they stand, in SymPy's
        order: ``Mul`` need not look for what they have in common.
        """
        generators = self.ring.generators
        if len(factors) < 2 or not all(_is_plain(generators[i]) for i, _ in factors):
            return sp.Mul(*(generators[i] ** e for i, e in factors))
        for factor in factors:
            if factor not in self._powers:
                i, e = factor
                power = generators[i] ** e
                self._powers[factor] = _sympy_order(power), power
        return sp.Mul._from_args([power for _, power in sorted(self._powers[f] for f in factors)])


def _signed(scale: Any, *factors: Any) -> Any:
    """Return a product, its sign in a bracket instead of before one that begins with a minus.

    -(-x + y) z is (x - y) z.
    """
    pairs = [factor.as_coeff_mul() for factor in factors]
    number = sp.Mul(scale, *(c for c, _ in pairs))
    parts = [x for _, several in pairs for x in several]
    if number.is_negative:
        for k, bracket in enumerate(parts):
            if bracket.is_Add and _begins_with_minus(bracket):
                return sp.Mul(-number, *parts[:k], _negated(bracket), *parts[k + 1 :])
    return sp.Mul(scale, *factors)


def _negated(bracket: Any) -> Any:
    return sp.Add(*(_signed(sp.Integer(-1), term) for term in bracket.args))


def _begins_with_minus(bracket: Any) -> bool:
    """Whether the term that SymPy prints first has a minus sign."""
    first, *_ = bracket.as_ordered_terms()
    return bool(first.as_coeff_Mul()[0].is_negative)


_sympy_order = cmp_to_key(sp.Basic.compare)


def _is_plain(generator: Any) -> bool:
    return bool(generator.is_Symbol or generator.is_Function or generator.is_Derivative)


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


def _extracted(terms: Terms) -> tuple[Coefficient, Terms]:
    """Return (scale, terms) with scale * terms as before: small whole numbers and fewer signs."""
    scale: Coefficient = _sign(terms)
    divisor = lcm(*(c.denominator for c in terms.values()))
    if divisor <= _MAX_DENOMINATOR:
        scale *= _whole(Fraction(gcd(*(c.numerator for c in terms.values())), divisor))
    if scale == 1:
        return 1, terms
    return scale, {m: _quotient(c, scale) for m, c in terms.items()}


def _primitive(terms: Terms) -> tuple[Coefficient, Terms]:
    """Return (scale, terms) with coprime whole numbers: the same for proportional terms."""
    divisor = lcm(*(c.denominator for c in terms.values()))
    content = Fraction(gcd(*(int(c * divisor) for c in terms.values())), divisor)
    scale = _whole(_sign(terms) * content)
    return scale, {m: _quotient(c, scale) for m, c in terms.items()}


def _multiples(rates: Terms, unit: Coefficient | None) -> Iterator[tuple[Coefficient, Terms]]:
    """Yield (unit, multiples of it): ``unit``, or else 1 or the least rates that divide others."""
    if unit or all(c.denominator <= _MAX_DENOMINATOR for c in rates.values()):
        yield unit or 1, rates
        return
    rest = dict(rates)
    while rest:
        least = min(abs(Fraction(c)) for c in rest.values())
        parts = {m: _quotient(c, least) for m, c in rest.items()}
        found = {m: c for m, c in parts.items() if c.denominator == 1}
        yield least, found
        rest = {m: c for m, c in rest.items() if m not in found}


def _sign(terms: Terms) -> int:
    """Return the sign that most terms have, the first one's in doubt."""
    negative = sum(c < 0 for c in terms.values()) * 2 - len(terms)
    return -1 if negative > 0 or (negative == 0 and terms[min(terms)] < 0) else 1


def _quotient(c: Coefficient, divisor: Coefficient) -> Coefficient:
    return _whole(Fraction(c) / divisor)


def _whole(c: Coefficient) -> Coefficient:
    """Return a whole fraction as an integer."""
    return c.numerator if c.denominator == 1 else c
