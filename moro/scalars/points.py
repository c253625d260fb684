"""Polynomials at a point: values in the place of some generators, exact or in many digits."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp
from mpmath import mp, mpf

from moro.scalars.relations import Monomial
from moro.scalars.trig import Trig, TrigRing

#: of numbers that are no fractions, where decimals are wanted
_DIGITS = 40


class Point:
    """Values of joint variables (or other symbols), for the polynomials of a ring.

    Exact values stay exact: sqrt(2)/2, sin(1/3). With ``decimal``, what is a number is one of many
    digits: so differences of near values keep theirs.
    """

    def __init__(self, ring: TrigRing, values: Mapping[Any, Any], decimal: bool = False):
        self._ring = ring
        self._values = dict(values)
        self._decimal = decimal
        self._known, self._mask = 0, 0  # how many generators have been looked at; those replaced
        self._powers: dict[tuple[int, int], Any] = {}
        self._products: dict[Monomial, Any] = {}

    def __call__(self, p: Trig) -> Trig:
        """Return a polynomial at the point."""
        self._look()
        total: dict[Monomial, Any] = {}
        with mp.workdps(_DIGITS):
            for m, c in p.terms.items():
                part, rest = self._product(m & self._mask), m & ~self._mask
                part = part * c.numerator / c.denominator  # mpf has no fractions
                total[rest] = self._sum(total[rest], part) if rest in total else part
        found = self._ring.zero
        for m, x in total.items():
            found = found + self._scalar(x) * Trig(self._ring, {m: 1})
        return found

    def value(self, expr: Any) -> Trig:
        """Return an expression at the point, as a scalar of the ring."""
        return self._scalar(self._number(expr))

    def _look(self) -> None:
        """Look at the generators that have turned up."""
        new = self._ring.generators[self._known :]
        self._known += len(new)
        self._mask |= self._ring.mask(x for x in new if self._is_replaced(x))

    def _is_replaced(self, meaning: Any) -> bool:
        if meaning.is_Derivative:
            return False
        return bool(meaning.has(*self._values) or (self._decimal and meaning.is_number))

    def _product(self, m: Monomial) -> Any:
        found = self._products.get(m)
        if found is None:
            found = mpf(1) if self._decimal else self._ring.one
            for index, e in self._ring.exponents(m):
                found = self._times(found, self._power(index, e))
            self._products[m] = found
        return found

    def _power(self, index: int, e: int) -> Any:
        if (index, e) not in self._powers:
            base = self._number(self._ring.generators[index])
            power = base if e == 1 else self._times(self._power(index, e - 1), base)
            self._powers[index, e] = power
        return self._powers[index, e]

    def _number(self, expr: Any) -> Any:
        value = sp.sympify(expr).xreplace(self._values)
        if self._decimal and value.is_number:
            with mp.workdps(_DIGITS):
                return mpf(sp.Float(value.evalf(_DIGITS), _DIGITS)._mpf_)
        return self._ring.convert(value)

    def _sum(self, a: Any, b: Any) -> Any:
        return a + b if type(a) is type(b) else self._scalar(a) + self._scalar(b)

    def _times(self, a: Any, b: Any) -> Any:
        return a * b if type(a) is type(b) else self._scalar(a) * self._scalar(b)

    def _scalar(self, x: Any) -> Trig:
        """Return a number of many digits as the fraction that it is, in the ring."""
        if isinstance(x, Trig):
            return x
        sign, mantissa, exponent, _ = x._mpf_
        number = Fraction(-mantissa if sign else mantissa) * Fraction(2) ** exponent
        total: Trig = self._ring.zero + (number.numerator if number.denominator == 1 else number)
        return total
