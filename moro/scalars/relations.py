"""Relations of generators, by which packed monomials are rewritten to one normal form.

A reciprocal g of a polynomial p is a generator with the relation g p = 1. Alone, solved for its
leading monomial, it cancels p wherever it is a factor. Several reciprocals whose polynomials share
generators have relations in common, too,

    1/(a + b) 1/(a - b) 2 a = 1/(a + b) + 1/(a - b),

which Buchberger's algorithm finds: the rules are a Groebner basis, so equal elements are rewritten
to the same. In its order, reciprocals come before sines, and sines before the rest, the later ones
first: what has no reciprocal in some form has none in this one, and a new reciprocal changes no
form that it is not in. Source: Cox, Little & O'Shea, Ideals, Varieties, and Algorithms, chapter 2.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple, TypeAlias

Coefficient: TypeAlias = "int | Fraction"
Monomial: TypeAlias = int
Terms: TypeAlias = "dict[Monomial, Coefficient]"

#: bits of an exponent; the highest is free
BITS = 8
FIELD = (1 << BITS) - 1
#: more rules, or longer ones, are not looked for, nor any that take more steps to find:
#: forms are exact then, but need not be the same
_MAX_RULES, _MAX_TERMS, _MAX_WORK = 100, 100, 20000


class Rule(NamedTuple):
    """``lead`` is the sum of ``rest``."""

    lead: Monomial
    #: the highest bits of the exponents in ``lead``
    highest: int
    rest: tuple[tuple[Monomial, Coefficient], ...]

    def divides(self, m: Monomial) -> bool:
        """Whether the leading monomial divides another: no exponent of that is the smaller."""
        return ((m | self.highest) - self.lead) & self.highest == self.highest


class Relations:
    """The rules of a ring: for squares of sines and roots, and for reciprocals."""

    def __init__(self) -> None:
        #: bits of the exponents of reciprocals, and of sines
        self.reciprocals = 0
        self._sines = 0
        self._squares: list[Rule] = []
        self._rules: list[Rule] = []
        #: steps taken: terms rewritten, relations looked at
        self._work = 0

    def square(
        self, unit: Monomial, rest: Iterable[tuple[Monomial, Coefficient]], sine: bool
    ) -> None:
        """Let the square of a generator be a sum of others, of which it is none."""
        self._squares.append(_rule(2 * unit, rest))
        self._sines |= unit * FIELD if sine else 0

    def reciprocal(self, unit: Monomial, of: Terms) -> None:
        """Let a new generator be one over a polynomial."""
        self.reciprocals |= unit * FIELD
        relation = {m + unit: c for m, c in of.items()}
        self._add(relation | {0: -1})

    def cancelled(self, terms: Terms) -> Terms:
        """Return the normal form of a sum whose monomials without reciprocals have theirs."""
        work = {m: c for m, c in terms.items() if m & self.reciprocals}
        if not work:
            return terms
        found = {m: c for m, c in terms.items() if m not in work}
        while work:
            m, c = work.popitem()
            self._work += 1
            rule = self._rule_for(m)
            if rule is None:
                _accumulate(found, m, c)
            else:
                for other, factor in rule.rest:
                    _accumulate(work, m - rule.lead + other, c * factor)
        return found

    def _rule_for(self, m: Monomial) -> Rule | None:
        if m & self.reciprocals:
            for rule in self._rules:
                if rule.divides(m):
                    return rule
        return next((rule for rule in self._squares if rule.divides(m)), None)

    def _add(self, relation: Terms) -> None:
        """Add a sum that is zero, and what follows of it and of the rules that there are."""
        waiting, most = [relation], self._work + _MAX_WORK
        while waiting and len(self._rules) < _MAX_RULES and self._work < most:
            self._work += len(waiting)
            waiting.sort(key=lambda terms: self._order(self._lead(terms)), reverse=True)
            terms = {m: c for m, c in self.cancelled(waiting.pop()).items() if c}
            if not terms or len(terms) > _MAX_TERMS:
                continue
            lead = self._lead(terms)
            scale = -1 / Fraction(terms.pop(lead))
            new = _rule(lead, ((m, _whole(c * scale)) for m, c in terms.items()))
            waiting += (_as_terms(rule) for rule in self._rules if new.divides(rule.lead))
            self._rules = [rule for rule in self._rules if not new.divides(rule.lead)]
            others = (*self._rules, *self._squares)
            waiting += (s for rule in others if (s := _overlap(new, rule)))
            self._rules.append(new)

    def _lead(self, terms: Terms) -> Monomial:
        return max(terms, key=self._order)

    def _order(self, m: Monomial) -> tuple[int, int, int, int]:
        rest = m & ~(self.reciprocals | self._sines)
        degree = sum(rest.to_bytes((rest.bit_length() + BITS - 1) // BITS, "little"))
        return m & self.reciprocals, m & self._sines, degree, rest


def _overlap(a: Rule, b: Rule) -> Terms:
    """Return the difference of what two rules make of the least monomial that both apply to."""
    common = common_factor(a.lead, b.lead)
    if not common:
        return {}
    terms: Terms = {}
    for rule, sign in ((a, 1), (b, -1)):
        front = a.lead + b.lead - common - rule.lead
        for m, c in rule.rest:
            _accumulate(terms, m + front, c * sign)
    return {m: c for m, c in terms.items() if c}


def common_factor(a: Monomial, b: Monomial) -> Monomial:
    """Return the greatest monomial that divides both."""
    size = (min(a, b).bit_length() + BITS - 1) // BITS
    mask = (1 << BITS * size) - 1
    both = ((x & mask).to_bytes(size, "little") for x in (a, b))
    return int.from_bytes(bytes(map(min, *both)), "little")


def _rule(lead: Monomial, rest: Iterable[tuple[Monomial, Coefficient]]) -> Rule:
    packed = lead.to_bytes((lead.bit_length() + BITS - 1) // BITS, "little")
    highest = sum(1 << BITS * i + BITS - 1 for i, e in enumerate(packed) if e)
    return Rule(lead, highest, tuple(rest))


def _as_terms(rule: Rule) -> Terms:
    return {rule.lead: -1, **dict(rule.rest)}


def _accumulate(terms: Terms, m: Monomial, c: Coefficient) -> None:
    total = terms.get(m, 0) + c
    if total:
        terms[m] = total
    else:
        terms.pop(m, None)


def _whole(x: Fraction) -> Coefficient:
    return x.numerator if x.denominator == 1 else x
