"""Quotients of trigonometric polynomials in lowest terms."""

from __future__ import annotations

from fractions import Fraction
from math import gcd, lcm

from moro.scalars.free import FreePolynomials
from moro.scalars.relations import Monomial
from moro.scalars.trig import Trig

#: products of numbers of terms up to which common divisors are looked for
_SHORT = 20_000
#: denominators of coefficients that are multiplied by
_WHOLE = 1000


def lowest(numerator: Trig, denominator: Trig) -> tuple[Trig, Trig]:
    """Return numerator and denominator without what divides both.

    Sine and cosine count as independent here: what divides then, divides. The denominator's
    coefficients are whole and coprime, most of them positive; of one term it is 1. Of long
    polynomials only what every term holds is cancelled.
    """
    ring = numerator.ring
    if not numerator:
        return ring.zero, ring.one
    short = len(numerator) * len(denominator) <= _SHORT
    shorter = _without_divisor if short else _without_monomial
    numerator, denominator = shorter(numerator, denominator)
    scale = _content(denominator)
    return numerator / scale, denominator / scale


def _content(p: Trig) -> Fraction:
    """Return what makes a polynomial's coefficients whole, coprime, and mostly positive.

    Decimals of many digits stay as they are.
    """
    coefficients = p.terms.values()
    divisor = lcm(*(c.denominator for c in coefficients))
    sign = -1 if sum(c < 0 for c in coefficients) * 2 > len(p) else 1
    if len(p) == 1:
        return Fraction(next(iter(coefficients)))
    if divisor > _WHOLE:
        return Fraction(sign)
    return Fraction(sign * gcd(*(int(c * divisor) for c in coefficients)), divisor)


def _without_monomial(numerator: Trig, denominator: Trig) -> tuple[Trig, Trig]:
    ring = numerator.ring
    common: Monomial | None = None
    for m in (*denominator.terms, *numerator.terms):
        common = m if common is None else ring.common_factor(common, m)

    def quotient(p: Trig) -> Trig:
        return Trig(ring, {m - (common or 0): c for m, c in p.terms.items()})

    return quotient(numerator), quotient(denominator)


def _without_divisor(numerator: Trig, denominator: Trig) -> tuple[Trig, Trig]:
    ring, free = numerator.ring, FreePolynomials((*numerator.terms, *denominator.terms))
    _, above, below = free.of(numerator.terms).cofactors(free.of(denominator.terms))
    return Trig(ring, free.terms(above)), Trig(ring, free.terms(below))
