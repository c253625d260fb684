"""Sines and cosines of plain numbers, as fractions on the unit circle."""

from __future__ import annotations

import math
from fractions import Fraction

#: of the tangent of half an angle
_TOLERANCE = Fraction(1, 10**17)
_QUARTER = Fraction("1.5707963267948966192313216916397514420985846996875529")


def rational_sincos(angle: Fraction | float) -> tuple[Fraction, Fraction]:
    """Return sine and cosine of an angle [rad] to 1e-16, with s^2 + c^2 = 1 exactly.

    With t = tan(angle / 2), s = 2 t / (1 + t^2) and c = (1 - t^2) / (1 + t^2), for a fraction t
    near the tangent. Rotation matrices made of such pairs are orthogonal exactly.
    """
    quarters = round(angle / (math.pi / 2))
    s, c = _near_zero(Fraction(math.tan((Fraction(angle) - quarters * _QUARTER) / 2)))
    for _ in range(quarters % 4):
        s, c = c, -s
    return s, c


def _near_zero(tangent: Fraction) -> tuple[Fraction, Fraction]:
    limit = 10**8
    while abs((t := tangent.limit_denominator(limit)) - tangent) > _TOLERANCE:
        limit *= 8
    p, q = t.numerator, t.denominator
    return Fraction(2 * p * q, p * p + q * q), Fraction(q * q - p * p, p * p + q * q)
