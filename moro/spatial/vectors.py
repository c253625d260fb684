"""Three-vectors and 3x3 matrices of any scalar, as tuples."""

from __future__ import annotations

from typing import Any, TypeAlias

Scalar: TypeAlias = Any
Vector: TypeAlias = tuple[Scalar, Scalar, Scalar]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]


def add(u: Vector, v: Vector) -> Vector:
    """Return u + v."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


def difference_of(u: Vector, v: Vector) -> Vector:
    """Return u - v."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


def scaled(factor: Scalar, v: Vector) -> Vector:
    """Return factor v."""
    return factor * v[0], factor * v[1], factor * v[2]


def dot(u: Vector, v: Vector) -> Scalar:
    """Return u . v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Vector, v: Vector) -> Vector:
    """Return u x v."""
    return (
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    )


def transpose(A: Matrix) -> Matrix:
    """Return A^T."""
    return (
        (A[0][0], A[1][0], A[2][0]),
        (A[0][1], A[1][1], A[2][1]),
        (A[0][2], A[1][2], A[2][2]),
    )


def times(A: Matrix, v: Vector) -> Vector:
    """Return A v."""
    return dot(A[0], v), dot(A[1], v), dot(A[2], v)


def product(A: Matrix, B: Matrix) -> Matrix:
    """Return A B."""
    columns = transpose(B)
    return transpose((times(A, columns[0]), times(A, columns[1]), times(A, columns[2])))


def dyad(u: Vector, v: Vector) -> Matrix:
    """Return u v^T."""
    return scaled(u[0], v), scaled(u[1], v), scaled(u[2], v)


def sum_of(A: Matrix, B: Matrix) -> Matrix:
    """Return A + B."""
    return add(A[0], B[0]), add(A[1], B[1]), add(A[2], B[2])


def difference(A: Matrix, B: Matrix) -> Matrix:
    """Return A - B."""
    a, b, c = (tuple(x - y for x, y in zip(u, v, strict=True)) for u, v in zip(A, B, strict=True))
    return a, b, c


def skew(u: Vector) -> Matrix:
    """Return [u]x, the matrix of the cross product: [u]x v = u x v."""
    return (0, -u[2], u[1]), (u[2], 0, -u[0]), (-u[1], u[0], 0)


def diagonal(x: Scalar) -> Matrix:
    """Return x 1."""
    return (x, 0, 0), (0, x, 0), (0, 0, x)


def symmetric(A: Matrix) -> Matrix:
    """Return the symmetric matrix with the diagonal of A and what is above it."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = A
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
