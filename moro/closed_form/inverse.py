"""The inverse of a symmetric matrix over a ring, without a division: adjugates and determinants.

Rows that hold nothing in common are blocks of their own, with determinants of their own. What is
longer than ``LIMIT`` terms on the way is given up: nobody reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

from moro.scalars.trig import Trig, TrigRing

#: of a determinant
LIMIT = 400

Rows = Sequence[Sequence[Trig]]


class TooLongError(ValueError):
    """A determinant has more terms than ``LIMIT``."""


class Inverse(NamedTuple):
    """M^-1_ij = numerators[i][j] / denominators[i]."""

    numerators: list[list[Trig]]
    denominators: list[Trig]

    def times(self, column: Sequence[Trig]) -> list[Trig]:
        """Return the numerators of M^-1 times a column."""
        return [
            sum((x * y for x, y in zip(row, column, strict=True) if x and y), row[0].ring.zero)
            for row in self.numerators
        ]


def inverse(M: Rows, ring: TrigRing) -> Inverse:
    """Return the inverse of a symmetric matrix, block by block, by cofactors.

    Raises ``TooLongError``, or ZeroDivisionError for a matrix that is singular identically.
    """
    n = len(M)
    numerators = [[ring.zero] * n for _ in range(n)]
    denominators = [ring.one] * n
    for block in _blocks(M):
        minor = _minors(M, ring)
        determinant = minor(block, block)
        if not determinant:
            raise ZeroDivisionError("the matrix is singular")
        for a, i in enumerate(block):
            denominators[i] = determinant
            for b, j in enumerate(block[: a + 1]):
                rows, columns = _without(block, i), _without(block, j)
                cofactor = minor(rows, columns) * (-1) ** (a + b)
                numerators[i][j] = numerators[j][i] = cofactor
    return Inverse(numerators, denominators)


def _minors(M: Rows, ring: TrigRing) -> Callable[[tuple[int, ...], tuple[int, ...]], Trig]:
    """Return what gives the determinant of some rows and columns, expanded by the first row."""

    @cache
    def minor(rows: tuple[int, ...], columns: tuple[int, ...]) -> Trig:
        if not rows:
            return ring.one
        first, rest = M[rows[0]], rows[1:]
        total: Trig = ring.zero
        for k, j in enumerate(columns):
            if first[j]:
                part = first[j] * minor(rest, _without(columns, j))
                total = total - part if k % 2 else total + part
        if len(total) > LIMIT:
            raise TooLongError(f"a determinant has more than {LIMIT} terms")
        return total

    return minor


def _without(indices: tuple[int, ...], i: int) -> tuple[int, ...]:
    return tuple(k for k in indices if k != i)


def _blocks(M: Rows) -> list[tuple[int, ...]]:
    """Return the indices of rows that hang together."""
    found: list[tuple[int, ...]] = []
    left = set(range(len(M)))
    while left:
        block, new = set[int](), {min(left)}
        while new:
            block |= new
            new = {j for i in new for j in left if M[i][j]} - block
        left -= block
        found.append(tuple(sorted(block)))
    return found
