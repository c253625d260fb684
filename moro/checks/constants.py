"""Constants: which are zero in disguise, negative, beyond any sane size, or no real number."""

from __future__ import annotations

from typing import Any

import sympy as sp

#: a constant other than 0 lies between 10**-MAX_MAGNITUDE and 10**MAX_MAGNITUDE in size
MAX_MAGNITUDE = 300
RANGE = f"1e-{MAX_MAGNITUDE}..1e{MAX_MAGNITUDE}"

_LARGEST = sp.Integer(10) ** MAX_MAGNITUDE
_SMALLEST = 1 / _LARGEST
#: bits of a fraction's numerator more, or less, than of its denominator, if it is within the range
_SURELY = 990
#: what is smaller has no digit among the 100 that are computed where terms cancel
_ZERO = sp.Float("1e-90")


def numeric(constant: Any) -> Any:
    """Return a number as a rational or floating-point one; a complex one is neither."""
    return constant if constant.is_Rational else constant.evalf()


def is_zero(value: Any) -> bool:
    """Whether a value is zero, or is a number that 100 digits do not tell from zero."""
    if value.is_Rational or not value.is_number:
        return bool(value == 0)
    return bool(abs(value.evalf()) < _ZERO)


def is_negative(value: Any) -> bool:
    """Whether a value is known to be negative."""
    return bool(numeric(value) < 0) if value.is_number else bool(value.is_negative)


def is_sane(value: Any) -> bool:
    """Whether the numbers of a value are zero or within ``RANGE``."""
    if value.is_Rational and abs(value.p.bit_length() - value.q.bit_length()) < _SURELY:
        return True
    numbers = [numeric(value)] if value.is_number else value.atoms(sp.Rational)
    return all(x == 0 or _SMALLEST <= abs(x) <= _LARGEST for x in numbers)


def settled(value: Any) -> Any:
    """Return a value with 0 for each constant in it that is zero: sin(1)**2 + cos(1)**2 - 1."""
    if value.is_Rational or value.is_Symbol:
        return value
    parts = value.atoms(sp.Add, sp.Function) | {value}
    zeros = [x for x in parts if x.is_number and x != 0 and is_zero(x)]
    # the innermost first: what holds a zero may have no value, log(0)
    for zero in sorted(zeros, key=lambda x: (sp.count_ops(x), sp.default_sort_key(x))):
        value = value.xreplace({zero: sp.Integer(0)})
    return value


#: functions that NumPy has
_IN_NUMPY = (
    *(sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.atan2, sp.sinh, sp.cosh, sp.tanh),
    *(sp.asinh, sp.acosh, sp.atanh, sp.exp, sp.log, sp.Abs, sp.sign),
)


def for_numpy(value: Any) -> Any:
    """Return a value with the constants in it that NumPy has no function for, zeta(3), as floats.

    Integrals are such constants too.
    """
    parts = value.atoms(sp.Function, sp.Integral)
    return value.xreplace(
        {x: x.evalf() for x in parts if x.is_number and not isinstance(x, _IN_NUMPY)}
    )
