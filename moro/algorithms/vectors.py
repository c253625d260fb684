"""Three-vectors and 3x3 matrices of any scalar, as tuples."""

from __future__ import annotations

from moro.model import Matrix, Scalar, Vector


def add(u: Vector, v: Vector) -> Vector:
    """Return u + v."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


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


def second_moments(J: Matrix) -> Matrix:
    """Return the second moments integral r r^T dm = tr(J)/2 1 - J of the inertia tensor J."""
    half = (J[0][0] + J[1][1] + J[2][2]) / 2
    return (
        (half - J[0][0], -J[0][1], -J[0][2]),
        (-J[1][0], half - J[1][1], -J[1][2]),
        (-J[2][0], -J[2][1], half - J[2][2]),
    )


def inertia_tensor(S: Matrix) -> Matrix:
    """Return the inertia tensor J = tr(S) 1 - S of the second moments S."""
    return (
        (S[1][1] + S[2][2], -S[0][1], -S[0][2]),
        (-S[1][0], S[0][0] + S[2][2], -S[1][2]),
        (-S[2][0], -S[2][1], S[0][0] + S[1][1]),
    )
