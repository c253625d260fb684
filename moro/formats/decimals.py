"""Numbers and vectors in attributes, exact; angles and directions that decimals mean.

A decimal that is k pi/4 or k pi/6 to its last digit (1.5708, 1.57079632679, 0.7854) means that
angle, and so does one that is the angle in single precision. Directions likewise: 0.8660 0.5 0 is
at 30 degrees. What computing leaves of a zero, 6.12e-17 or 4.9e-12, is one: angles, lengths and
components of directions below 1e-10, and entries of a tensor below 1e-10 of the largest.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp

from moro.checks.constants import MAX_MAGNITUDE, RANGE, is_sane

_DECIMAL = re.compile(
    r"[+-]?(\d+\.?(?P<digits>\d*)|\.(?P<alone>\d+))([eE](?P<power>[+-]?\d+))?", re.ASCII
)
#: characters of a number
_LONGEST = 100
#: of doubles, and what computing with them leaves of a zero
_ROUNDING, _NOISE = sp.Rational(1, 2**52), sp.Rational("1e-10")
#: decimals that tell a quarter turn, and those that tell k pi/4 or k pi/6
_FEWEST = {True: 2, False: 4}
#: multiples of pi/12 that a decimal of two digits may be off
_NEAR = 0.1
#: decimals that tell a number in single precision, and a cosine
_SINGLE, _ENOUGH = 7, 3
_HALF = sp.Rational(1, 2)


@dataclass(frozen=True)
class Number:
    """A decimal, exact, and how many digits it has after the point."""

    value: Any
    digits: int
    text: str


def number(text: str) -> Number | str:
    """Return a decimal, or what is wrong with it."""
    word = text.strip()
    found = _DECIMAL.fullmatch(word) if len(word) <= _LONGEST else None
    if not found:
        return f"expected a number, found {_quoted(word)}"
    power = int(found["power"] or 0)
    if abs(power) > MAX_MAGNITUDE + _LONGEST:
        return f"expected 0 or a number within {RANGE} in size, found {_quoted(word)}"
    value = sp.Rational(word)
    if not is_sane(value):
        return f"expected 0 or a number within {RANGE} in size, found {_quoted(word)}"
    return Number(value, max(0, len(found["digits"] or found["alone"] or "") - power), word)


def numbers(text: str, count: int) -> list[Number] | str:
    """Return decimals with blanks between them, or what is wrong with them."""
    words = text.split()
    if len(words) != count:
        return f"expected {count} numbers, found {_quoted(text) if words else 'nothing'}"
    found = []
    for word in words:
        x = number(word)
        if isinstance(x, str):
            return x
        found.append(x)
    return found


def _quoted(text: str) -> str:
    short = " ".join(text.split())
    return f"`{short if len(short) <= 40 else short[:37] + '...'}`"


# -- angles ---------------------------------------------------------------------------------------

_PI = sp.Rational(str(sp.pi.evalf(60)))


def angle(x: Number, as_written: bool = False) -> tuple[Any, bool]:
    """Return the angle that a decimal means [rad], and whether that is to be said.

    The double next to a multiple of pi/4 or pi/6 is that multiple, which need not be said; a
    decimal that is one to its last digit is too, unless ``as_written``.
    """
    size = float(x.value) * 12 / math.pi
    twelfths = round(size)
    if abs(size - twelfths) > _NEAR or (twelfths % 2 and twelfths % 3) or abs(twelfths) > 24:
        return x.value, False
    exact = _PI * twelfths / 12
    if abs(x.value - exact) <= _ROUNDING * max(abs(exact), 1):
        return twelfths * sp.pi / 12, False
    if not as_written and twelfths == 0:
        return meant_zero(x.value)
    if not as_written and x.digits >= _FEWEST[twelfths % 6 == 0] and _ends_as(x, exact, twelfths):
        return twelfths * sp.pi / 12, True
    return x.value, False


def meant_zero(x: Any, beside: Any = 1) -> tuple[Any, bool]:
    """Return 0 for what is nothing beside another value, and whether that is to be said."""
    return (sp.Integer(0), True) if 0 < abs(x) < _NOISE * beside else (x, False)


def _ends_as(x: Number, exact: Any, twelfths: int) -> bool:
    """Whether a decimal is a value, or that in single precision, rounded or cut to its digits."""
    values = [exact]
    if x.digits >= _SINGLE:
        values.append(_single(twelfths))
    return any(_is_cut(x, y) for y in values)


def _is_cut(x: Number, exact: Any) -> bool:
    """Whether a decimal is a value rounded or cut to its digits."""
    size, shifted = abs(x.value) * 10**x.digits, abs(exact) * 10**x.digits
    return x.value * exact > 0 and size in (sp.floor(shifted), sp.floor(shifted + _HALF))


@cache
def _single(twelfths: int) -> Any:
    """Return k pi/12 in single precision."""
    return sp.Rational(struct.unpack("f", struct.pack("f", float(_PI * twelfths / 12)))[0])


# -- directions -----------------------------------------------------------------------------------

#: sines and cosines of k pi/4 and k pi/6
_COSINES = (sp.Integer(0), _HALF, sp.sqrt(2) / 2, sp.sqrt(3) / 2, sp.Integer(1))


def direction(components: Sequence[Number], as_written: bool = False) -> tuple[list[Any], bool]:
    """Return the direction that three decimals mean, of any length, and whether that is to be said.

    Unless ``as_written``, what is below 1e-10 of the largest is 0, and three that are 0, 1/2,
    sqrt(2)/2, sqrt(3)/2 or 1 to their last digits are these, if they make up a unit vector.
    """
    values = [x.value for x in components]
    if as_written:
        return values, False
    largest = max(map(abs, values))
    meant = [meant_zero(x, largest)[0] for x in values]
    cosines = [_cosine(x) for x in components]
    if all(x is not None for x in cosines) and sum(x**2 for x in cosines if x) == 1:
        return cosines, any(_crossed(cosines, values))
    return meant, meant != values


def _cosine(x: Number) -> Any | None:
    """Return which of the ``_COSINES`` a decimal is to its digits."""
    if x.value in (0, 1, -1) or abs(x.value) < _NOISE:
        return sp.Integer(round(x.value))
    for exact in _COSINES[1:4]:
        close = exact if exact.is_Rational else sp.Rational(str(exact.evalf(60)))
        if abs(x.value) == close or (x.digits >= _ENOUGH and _is_cut(x, sp.sign(x.value) * close)):
            return sp.sign(x.value) * exact
    return None


def _crossed(u: Sequence[Any], v: Sequence[Any]) -> list[Any]:
    """Return u x v, which is zero for parallel vectors."""
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]
