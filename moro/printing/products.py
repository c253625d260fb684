"""Sums that are products of sums: a c + a d + b c + b d is (a + b) (c + d)."""

from __future__ import annotations

from fractions import Fraction

from moro.scalars.relations import BITS, FIELD, Coefficient, Monomial, common_factor

Terms = dict[Monomial, Coefficient]

#: terms of a sum that is looked at
_MOST = 40


def factors(terms: Terms) -> tuple[Terms, Terms] | None:
    """Return a sum of two, and another sum, whose product is the sum; None where there are none.

    In (u + v) Q every term of u Q, from the greatest on, has one of v Q beside it, at the same
    distance: so the first two terms of both tell what u and v are.
    """
    if len(terms) % 2 or not 4 <= len(terms) <= _MOST:
        return None
    order = sorted(terms, reverse=True)
    first, last = order[0], order[-1]
    for second in order[1:]:
        step = second - first
        ratio = Fraction(terms[second]) / terms[first]
        before = last - step
        if terms.get(before) and terms[last] == ratio * terms[before]:
            found = _split(terms, order, second, ratio)
            if found is not None:
                return found
    return None


def _split(
    terms: Terms, order: list[Monomial], second: Monomial, ratio: Fraction
) -> tuple[Terms, Terms] | None:
    """Return u + v and Q, where the first term is u times one of Q, and ``second`` v times it."""
    first, left, Q = order[0], dict(terms), {}
    common = common_factor(first, second)
    u, v = first - common, second - common
    for m in order:
        if m not in left:
            continue
        c = left.pop(m)
        if left.pop(m - u + v, None) != ratio * c or not _divides(u, m):
            return None
        Q[m - u] = c
    above, below = ratio.numerator, ratio.denominator
    if any((c % below if isinstance(c, int) else 1) for c in Q.values()) and below != 1:
        return None
    return {u: below, v: above}, {m: c // below if below != 1 else c for m, c in Q.items()}


def _divides(a: Monomial, b: Monomial) -> bool:
    count = (a.bit_length() + BITS - 1) // BITS
    return all(a >> BITS * i & FIELD <= b >> BITS * i & FIELD for i in range(count))
