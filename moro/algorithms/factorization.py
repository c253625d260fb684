"""M = L^T D L and the solution of M x = b, over any scalar.

Featherstone 2008 (sec. 6.5): where elimination goes from the tips to the base, an entry of M that
is zero because two joints are on different branches of the tree stays zero. D_j is the inertia that
joint j feels in the articulated body algorithm. ``+ - *`` are asked of the scalars, and one
division for every row.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from moro.algorithms.coordinates import couplings
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar


class Factors(NamedTuple):
    """M = L^T D L: L is 1 on its diagonal, and 0 but for columns of coordinates further in."""

    L: list[list[Scalar]]
    #: 1 / D_j
    reciprocals: list[Scalar]
    #: those further in that coordinate j is coupled with, the last first
    inner: list[list[int]]


def factorized(M: Sequence[Sequence[Scalar]], arm: Posture) -> Factors:
    """Return the factors of the inertia matrix of an arm."""
    L = [list(row) for row in M]
    reciprocals, inner = [], couplings(arm.links, arm.nv)
    for j in reversed(range(len(L))):
        reciprocals.append(1 / L[j][j])
        for place, i in enumerate(inner[j]):
            factor = L[j][i] * reciprocals[-1]
            for k in inner[j][place:]:
                L[i][k] = L[i][k] - factor * L[j][k]
            L[j][i] = factor
    return Factors(L, reciprocals[::-1], inner)


def solution(factors: Factors, b: Sequence[Scalar]) -> list[Scalar]:
    """Return x with L^T D L x = b."""
    L, reciprocals, inner = factors
    x = list(b)
    for j in reversed(range(len(x))):
        for i in inner[j]:
            x[i] = x[i] - L[j][i] * x[j]
    for j, reciprocal in enumerate(reciprocals):
        x[j] = reciprocal * x[j]
        for i in inner[j]:
            x[j] = x[j] - L[j][i] * x[i]
    return x


def inverse(factors: Factors) -> list[list[Scalar]]:
    """Return M^-1."""
    n = len(factors.L)
    columns = [solution(factors, [int(i == j) for i in range(n)]) for j in range(n)]
    return [[columns[min(i, j)][max(i, j)] for j in range(n)] for i in range(n)]


def inverse_of_symmetric(A: Sequence[Sequence[Scalar]]) -> list[list[Scalar]]:
    """Return the inverse of a symmetric, positive definite matrix, by A = L D L^T."""
    n = len(A)
    L = [list(row) for row in A]
    reciprocals: list[Scalar] = []
    for j in range(n):
        reciprocals.append(1 / L[j][j])
        for i in range(j + 1, n):
            factor = L[i][j] * reciprocals[j]
            for k in range(j + 1, i + 1):
                L[i][k] = L[i][k] - factor * L[k][j]
        for i in range(j + 1, n):
            L[i][j] = L[i][j] * reciprocals[j]
    inverse: list[list[Scalar]] = [[0] * n for _ in range(n)]
    for j in range(n):
        x: list[Scalar] = [0] * n
        x[j] = 1
        for i in range(j + 1, n):
            x[i] = -sum(L[i][k] * x[k] for k in range(j, i))
        for i in reversed(range(j, n)):
            x[i] = reciprocals[i] * x[i] - sum(L[k][i] * x[k] for k in range(i + 1, n))
        for i in range(j, n):
            inverse[i][j] = inverse[j][i] = x[i]
    return inverse
