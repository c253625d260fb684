"""Sums of packed monomials as SymPy's sparse polynomials, for factors and common divisors.

Generators count as independent there: what divides then, divides.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import sympy as sp

from moro.scalars.relations import BITS, FIELD, Monomial, Terms


class FreePolynomials:
    """Polynomials in the generators that occur in some monomials, with rational coefficients."""

    def __init__(self, monomials: Iterable[Monomial]):
        together = 0
        for m in monomials:
            together |= m
        count = (together.bit_length() + BITS - 1) // BITS
        self._shifts = [BITS * i for i in range(count) if together >> BITS * i & FIELD]
        self._ring, *_ = sp.ring([f"x{i}" for i in range(max(1, len(self._shifts)))], sp.QQ)

    def of(self, terms: Terms) -> Any:
        """Return a sum of monomials as a polynomial."""
        return self._ring.from_dict(
            {
                tuple(m >> shift & FIELD for shift in self._shifts) or (0,): sp.QQ(
                    c.numerator, c.denominator
                )
                for m, c in terms.items()
            }
        )

    def terms(self, polynomial: Any) -> Terms:
        """Return a polynomial as a sum of monomials."""
        return {
            sum(e << shift for e, shift in zip(exponents, self._shifts, strict=False)): rational(c)
            for exponents, c in polynomial.terms()
        }


def rational(x: Any) -> Any:
    """Return a number of SymPy's polynomials as an integer or a fraction."""
    number = Fraction(int(x.numerator), int(x.denominator))
    return number.numerator if number.denominator == 1 else number
