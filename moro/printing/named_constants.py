"""Names for the coefficients of polynomials: those of a basis of their rational span."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import gcd
from typing import Any

import sympy as sp

from moro.scalars.relations import Coefficient, Monomial
from moro.scalars.trig import Trig, TrigRing

#: a coefficient as a vector: {monomial: rational}
SparseVector = dict[Monomial, Fraction]
#: a linear combination of names (symbols) and of monomials that need none
Combination = dict[Any, Fraction]


class NamedConstants:
    """Names ``letter``_1, ... for the coefficients of polynomials in the generators ``moving``.

    ``polynomials`` are in reading order; names are numbered as they turn up there. Multiples of one
    coefficient share its name, and what depends on others linearly is a combination of them.
    Numbers, and symbols that are a coefficient alone, need no names.
    """

    def __init__(
        self, ring: TrigRing, polynomials: Sequence[Trig], moving: Sequence[Any], letter: str
    ):
        self._ring = ring
        self._combinations: dict[frozenset[tuple[Monomial, Fraction]], Combination] = {}
        found = self._coefficients(polynomials, moving)
        span = _Span()
        for m in self._unnamed(found):
            span.add({m: Fraction(1)}, m)
        by_use = sorted(found, key=lambda key: (-found[key][1], len(key), sorted(key)))
        basis = {key for key in by_use if span.add(found[key][0], key)}
        in_order = enumerate((key for key in found if key in basis), 1)
        names = {key: sp.Symbol(f"{letter}_{n}") for n, key in in_order}
        #: {name: what it stands for}, in the order of the numbers
        self.meanings = {
            name: _polynomial(self._ring, found[key][0]) for key, name in names.items()
        }
        for key in found:
            combination = span.combination(dict(key))
            self._combinations[key] = {names.get(item, item): c for item, c in combination.items()}

    def combination(self, coefficient: Trig) -> Combination | None:
        """Return a coefficient as a combination of names and monomials; None if it has none."""
        lead, key = _proportional(coefficient)
        found = self._combinations.get(key)
        return None if found is None else {item: c * lead for item, c in found.items()}

    def _coefficients(
        self, polynomials: Sequence[Trig], variables: Sequence[Any]
    ) -> dict[Any, tuple[SparseVector, int]]:
        """Return {key: (coefficient, how often)}, one for all multiples, in reading order."""
        found: dict[Any, tuple[SparseVector, int]] = {}
        for p in polynomials:
            parts = self._ring.coefficients(p, variables)
            for m in sorted(parts, key=lambda m: (self._degree(m), m)):
                _, key = _proportional(parts[m])
                vector, count = found.get(key, (None, 0))
                found[key] = vector or _primitive(parts[m]), count + 1
        return found

    def _degree(self, m: Monomial) -> int:
        return sum(e for _, e in self._ring.exponents(m))

    def _unnamed(self, coefficients: Iterable[Any]) -> list[Monomial]:
        """Return the monomials that stay as they are: numbers, and symbols that stand alone."""
        found = set()
        for key in coefficients:
            monomials = [m for m, _ in key]
            factors = {m: self._ring.exponents(m) for m in monomials}
            generators = self._ring.generators
            if all(generators[i].is_number for m in monomials for i, _ in factors[m]):
                found.update(monomials)
            elif len(monomials) == 1:
                ((i, e), *others) = factors[monomials[0]]
                if e == 1 and not others and generators[i].is_Symbol:
                    found.add(monomials[0])
        return sorted(found)


class _Span:
    """The rational span of vectors that have been added, each known as an item."""

    def __init__(self) -> None:
        # rows in echelon form, by pivot, each with the combination of items that it is
        self._rows: dict[Monomial, tuple[SparseVector, Combination]] = {}

    def add(self, vector: SparseVector, item: Any) -> bool:
        """Add a vector; return False if it was in the span before."""
        rest, combination = self._reduced(vector)
        if rest:
            how = {known: -c for known, c in combination.items()}
            self._rows[max(rest)] = rest, how | {item: Fraction(1)}
        return bool(rest)

    def combination(self, vector: SparseVector) -> Combination:
        """Return a vector of the span as a combination of items."""
        return self._reduced(vector)[1]

    def _reduced(self, vector: SparseVector) -> tuple[SparseVector, Combination]:
        rest, combination = dict(vector), Combination()
        for m in sorted(self._rows, reverse=True):
            if m in rest:
                row, items = self._rows[m]
                factor = rest[m] / row[m]
                _subtract(rest, factor, row)
                _subtract(combination, -factor, items)
        return rest, combination


def _polynomial(ring: TrigRing, vector: SparseVector) -> Trig:
    return Trig(ring, {m: whole(c) for m, c in vector.items()})


def _subtract(terms: dict[Any, Fraction], factor: Fraction, others: dict[Any, Fraction]) -> None:
    for key, c in others.items():
        total = terms.get(key, Fraction(0)) - factor * c
        if total:
            terms[key] = total
        else:
            del terms[key]


def _proportional(p: Trig) -> tuple[Fraction, frozenset[tuple[Monomial, Fraction]]]:
    """Return (lead, key): the key is the same for all multiples of ``p``."""
    lead = Fraction(p.terms[min(p.terms)])
    return lead, frozenset((m, c / lead) for m, c in p.terms.items())


def _primitive(p: Trig) -> SparseVector:
    """Return the multiple of ``p`` to name: coprime whole numbers, or as it is; few minus signs."""
    numbers = [Fraction(c) for c in p.terms.values()]
    divisor = Fraction(1)
    if len(numbers) == 1:
        divisor = numbers[0]
    elif all(c.denominator == 1 for c in numbers):
        divisor = Fraction(gcd(*(c.numerator for c in numbers)))
    negative = sum(c / divisor < 0 for c in numbers)
    divisor = -divisor if 2 * negative > len(numbers) else divisor
    return {m: c / divisor for m, c in p.terms.items()}


def whole(c: Fraction) -> Coefficient:
    """Return a whole fraction as an integer."""
    return c.numerator if c.denominator == 1 else c
