"""Between the frame of a link and that of its parent: wrenches inwards, velocities outwards.

Vectors are in the axes of the frame they belong to, wrenches about its origin.
"""

from __future__ import annotations

from dataclasses import dataclass

from moro.spatial.moments import Moments
from moro.spatial.motion import Velocity, Wrench
from moro.spatial.vectors import Matrix, Scalar, Vector, add, cross, product, times, transpose


@dataclass(frozen=True)
class Transform:
    """Where a frame is in its parent's: x_parent = R Rz x + p, where Rz turns about z."""

    R: Matrix
    p: Vector
    #: of the angle of Rz
    sin: Scalar
    cos: Scalar

    def rotate(self, v: Vector) -> Vector:
        """Return the components of v in the axes of the parent, given those in the frame's."""
        x, y, z = v
        return times(self.R, (self.cos * x - self.sin * y, self.sin * x + self.cos * y, z))

    def rotate_back(self, v: Vector) -> Vector:
        """Return the components of v in the axes of the frame, given those in the parent's."""
        x, y, z = times(transpose(self.R), v)
        return self.cos * x + self.sin * y, self.cos * y - self.sin * x, z


def velocity_in_link(frame: Transform, parent: Velocity) -> Velocity:
    """Return the velocity of a link whose joint does not move: R^T omega, R^T (v + omega x p)."""
    v = add(parent.v, cross(parent.omega, frame.p))
    return Velocity(frame.rotate_back(parent.omega), frame.rotate_back(v))


def wrench_in_parent(frame: Transform, wrench: Wrench) -> Wrench:
    """Return a wrench on a link as one on its parent: R f, R n + p x R f."""
    f = frame.rotate(wrench.f)
    return Wrench(f, add(frame.rotate(wrench.n), cross(frame.p, f)))


def matrix_in_parent(frame: Transform, A: Matrix) -> Matrix:
    """Return R Rz A Rz^T R^T: a matrix in the axes of a link, in those of its parent."""
    return product(product(frame.R, about_z(A, frame.sin, frame.cos)), transpose(frame.R))


def moments_in_parent(frame: Transform, body: Moments) -> Moments:
    """Return the moments of a body in the frame of a link, in the frame of its parent."""
    return Moments(body.m, frame.rotate(body.h), matrix_in_parent(frame, body.S)).displaced(frame.p)


def about_z(A: Matrix, sin: Scalar, cos: Scalar) -> Matrix:
    """Return Rz A Rz^T: a matrix after turning about z.

    That leaves A_zz, A_xx + A_yy and A_xy - A_yx alone. With a = A_xx - A_yy, b = A_xy + A_yx,
    u = a sin + b cos, v = a cos - b sin, A_xx falls and A_yy rises by u sin, A_xy and A_yx rise by
    v sin.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = A
    a, b = xx - yy, xy + yx
    u, v = sin * (a * sin + b * cos), sin * (a * cos - b * sin)
    return (
        (xx - u, xy + v, cos * xz - sin * yz),
        (yx + v, yy + u, sin * xz + cos * yz),
        (cos * zx - sin * zy, sin * zx + cos * zy, zz),
    )
