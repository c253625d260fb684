"""Squares of sums among the terms of a sum: a^2 + 2 a b + b^2 + c is (a + b)^2 + c."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from math import gcd, isqrt, lcm
from typing import NamedTuple

from moro.scalars.relations import Coefficient, Monomial

Terms = dict[Monomial, Coefficient]

#: terms of a sum, and squares of monomials in it, that are looked at
_MOST_TERMS, _MOST = 60, 12


class Square(NamedTuple):
    """``scale`` times the square of a sum."""

    scale: Coefficient
    root: Terms


def squares_in(terms: Terms, even: Sequence[Monomial]) -> tuple[list[Square], Terms]:
    """Return squares of sums that are among the terms, and the terms that are left.

    A square of a, b, .. takes a^2, b^2, .. and all 2 a b. The first that are found are taken, as
    long as they can be made. ``even`` are the monomials without odd exponents, in order.
    """
    found: list[Square] = []
    if len(terms) > _MOST_TERMS or len(even) > _MOST:
        return found, terms
    left = dict(terms)
    for a, b in itertools.combinations(even, 2):
        square = _of_two(left, a, b)
        if square is not None:
            for c in even:
                square = _extended(left, square, c)
            for m in _products(square.root):
                del left[m]
            found.append(square)
    return found, left


def _of_two(terms: Terms, a: Monomial, b: Monomial) -> Square | None:
    """Return the square of a sum of two, if its three terms are there."""
    if a not in terms or b not in terms:
        return None
    x, y, both = terms[a], terms[b], terms.get((a >> 1) + (b >> 1))
    if both is None or both * both != 4 * x * y:
        return None
    divisor = lcm(x.denominator, y.denominator)
    content = Fraction(gcd(int(x * divisor), int(y * divisor)), divisor)
    scale = content if x > 0 else -content
    first, second = _root(x / scale), _root(y / scale)
    if first is None or second is None:
        return None
    sign = 1 if both * scale > 0 else -1
    return Square(_whole(scale), {a >> 1: first, b >> 1: sign * second})


def _extended(terms: Terms, square: Square, c: Monomial) -> Square:
    """Return a square with one more in its sum, if all terms of that are there, or as it is."""
    scale, root = square
    half = c >> 1
    if c not in terms or half in root:
        return square
    size = _root(terms[c] / Fraction(scale))
    if size is None:
        return square
    for z in (size, -size):
        crosses = {half + m: 2 * scale * z * x for m, x in root.items()}
        if all(terms.get(m) == x for m, x in crosses.items()):
            longer = {**root, half: z}
            if len(_products(longer)) == len(longer) * (len(longer) + 1) // 2:
                return Square(scale, longer)
    return square


def _products(root: Terms) -> set[Monomial]:
    return {a + b for a, b in itertools.combinations_with_replacement(root, 2)}


def _root(x: Coefficient) -> Coefficient | None:
    """Return the square root of a number, if it is rational."""
    if x <= 0:
        return None
    above, below = isqrt(x.numerator), isqrt(x.denominator)
    if above * above != x.numerator or below * below != x.denominator:
        return None
    return _whole(Fraction(above, below))


def _whole(x: Fraction) -> Coefficient:
    return x.numerator if x.denominator == 1 else x
