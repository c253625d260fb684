"""A random point for the generators of a ``TrigRing``: polynomials become numbers mod a prime.

Evaluation at a point respects + and *, so what is independent there is independent as polynomials:
a rank is proven by linear algebra over whole numbers, without expanding anything. Pairs of sine and
cosine lie on the circle, s = 2 u / (1 + u^2), c = (1 - u^2) / (1 + u^2), square roots of whole
numbers are roots mod the prime, and reciprocals inverses.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Sequence
from functools import cache
from math import prod
from typing import Any

import numpy as np
import sympy as sp

from moro.scalars.trig import Trig, TrigRing

#: sums of a number and a product of two below it fit in 64 bits
LIMIT = 2**31


class RandomPoint:
    """The scalars of an arm at random states; offers what ``TrigRing`` offers.

    A scalar is an array of whole numbers, one a state. Generators that hold one of ``moving`` have
    another value at each state, the others (lengths, twists, gravity) the same at all.
    """

    def __init__(self, ring: TrigRing, moving: Collection[Any], states: int, seed: int = 0):
        self._ring = ring
        self._moving = list(moving)
        self._states = states
        self._random = random.Random(seed)  # noqa: S311 - the same point every time
        roots = (x.base for x in ring.generators if _is_root(x))
        self.prime = _prime(frozenset({2, 3, *map(int, roots)}), seed)
        self.half = pow(2, -1, self.prime)
        self.zero = self._array([0] * states)
        self.one = self._array([1] * states)
        self._values: dict[int, Any] = {}

    def convert(self, expr: Any) -> Any:
        """Return the value of a SymPy expression at the states."""
        return self.evaluate(self._ring.convert(expr))

    def sincos(self, angle: Any) -> tuple[Any, Any]:
        """Return (sin, cos) of an angle at the states."""
        sine, cosine = self._ring.sincos(angle)
        return self.evaluate(sine), self.evaluate(cosine)

    def evaluate(self, p: Trig) -> Any:
        """Return the value of a polynomial at the states."""
        total = self.zero
        for m, c in p.terms.items():
            term = self.one * (c.numerator * pow(c.denominator, -1, self.prime))
            for index, e in self._ring.exponents(m):
                term = term * self._value(index) ** e % self.prime
            total = total + term
        return total % self.prime

    def _value(self, index: int) -> Any:
        if index not in self._values:
            pairs = self._ring.pairs.items()
            pair = next(((x, both) for x, both in pairs if index in both), None)
            meaning = self._ring.generators[index]
            if pair is not None:
                self._choose_on_circle(*pair)
            elif index in self._ring.reciprocals:
                self._values[index] = self._inverse(self.evaluate(self._ring.reciprocals[index]))
            elif _is_root(meaning):
                root = sp.sqrt_mod(int(meaning.base), self.prime)
                self._values[index] = self.one * int(root)
            else:
                self._values[index] = self._choose(meaning)
        return self._values[index]

    def _choose_on_circle(self, angle: Any, pair: tuple[int, int]) -> None:
        u = self._choose(angle)
        scale = self._inverse(1 + u * u)
        sine, cosine = pair
        self._values[sine] = 2 * u * scale % self.prime
        self._values[cosine] = (1 - u * u) * scale % self.prime

    def _inverse(self, numbers: Any) -> Any:
        return self._array([pow(int(x), -1, self.prime) for x in numbers])

    def _choose(self, meaning: Any) -> Any:
        if any(meaning.has(x) for x in self._moving):
            return self._array([self._random.randrange(self.prime) for _ in range(self._states)])
        return self.one * self._random.randrange(self.prime)

    @staticmethod
    def _array(numbers: Sequence[int]) -> Any:
        return np.array(numbers, dtype=object)


def dependences(rows: Sequence[Sequence[int]], prime: int) -> dict[int, list[int]]:
    """Return {dependent row: the independent rows before it that it is a combination of}."""
    reduced: list[tuple[int, Any]] = []  # leading column, row with 1 there
    found = {}
    type_ = np.int64 if prime < LIMIT else object
    for k, row in enumerate(rows):
        x = np.array([*row, *(int(j == k) for j in range(len(rows)))], dtype=type_)
        for column, pivot in reduced:
            if x[column]:
                x = (x - x[column] * pivot) % prime
        leading = np.flatnonzero(x)[0]  # of the combination at the latest
        if leading >= len(row):
            found[k] = [j for j in range(k) if x[len(row) + j]]
        else:
            reduced.append((int(leading), x * pow(int(x[leading]), -1, prime) % prime))
    return found


def _is_root(meaning: Any) -> bool:
    return bool(meaning.is_Pow and meaning.base.is_Integer and meaning.exp == sp.Rational(1, 2))


@cache
def _prime(squares: frozenset[int], seed: int) -> int:
    """Return a prime modulo which these primes are squares, by quadratic reciprocity.

    It is the largest one below ``LIMIT``, the next for the next seed, if ``squares`` leave any.
    """
    step = 8 * prod(squares)
    candidate = max(LIMIT // step, 2**20) * step + 1
    for _ in range(seed + 1):
        candidate -= step
        while not sp.isprime(candidate):
            candidate -= step
    return candidate
