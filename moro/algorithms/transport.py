"""Between a link and its parent: wrenches, matrices and moments inwards, velocities outwards.

Vectors are in the axes of the link they belong to, wrenches about the origin of its frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from moro.algorithms.newton_euler import Wrench
from moro.algorithms.posture import Link, Moments, Posture
from moro.algorithms.vectors import add, cross, product, transpose
from moro.model import Matrix, Scalar, Vector


class Velocity(NamedTuple):
    """Velocity of a link; or its acceleration, or either per unit of a joint's."""

    #: angular, of the link
    omega: Vector
    #: linear, of the origin of its frame
    v: Vector


REST = Velocity((0, 0, 0), (0, 0, 0))


def velocity_in_link(link: Link, parent: Velocity) -> Velocity:
    """Return the velocity of a link whose joint does not move: R^T omega, R^T (v + omega x p)."""
    v = add(parent.v, cross(parent.omega, link.p))
    return Velocity(link.rotate_back(parent.omega), link.rotate_back(v))


def moved(link: Link, velocity: Velocity, rate: Scalar) -> Velocity:
    """Return the velocity when the link's joint moves too: about z (revolute) or along z."""
    (wx, wy, wz), (vx, vy, vz) = velocity
    if link.kind == "revolute":
        return Velocity((wx, wy, wz + rate), (vx, vy, vz))
    return Velocity((wx, wy, wz), (vx, vy, vz + rate))


def velocities(arm: Posture, qd: Sequence[Scalar]) -> list[Velocity]:
    """Return the velocity of every link."""
    found: list[Velocity] = []
    for link, rate in zip(arm.links, qd, strict=True):
        parent = REST if link.parent < 0 else found[link.parent]
        found.append(moved(link, velocity_in_link(link, parent), rate))
    return found


def along_joint(link: Link, wrench: Wrench) -> Scalar:
    """Return what the joint of a link bears of a wrench: n_z (revolute) or f_z (prismatic)."""
    return wrench.n[2] if link.kind == "revolute" else wrench.f[2]


def wrench_in_parent(link: Link, wrench: Wrench) -> Wrench:
    """Return a wrench on a link as one on its parent: R f, R n + p x R f."""
    f = link.rotate(wrench.f)
    return Wrench(f, add(link.rotate(wrench.n), cross(link.p, f)))


def matrix_in_parent(link: Link, A: Matrix) -> Matrix:
    """Return R Rz A Rz^T R^T: a matrix in the axes of a link, in those of its parent."""
    return product(product(link.R, about_z(A, link.sin, link.cos)), transpose(link.R))


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


def moments_in_parent(link: Link, body: Moments) -> Moments:
    """Return the moments of a body in the frame of a link, in the frame of its parent."""
    return Moments(body.m, link.rotate(body.h), matrix_in_parent(link, body.S)).displaced(link.p)


def momentum(kind: str, body: Moments) -> Wrench:
    """Return the momentum of a body per unit of velocity about z (revolute) or along z.

    f = z x h, n = J z, with J z = (-S_xz, -S_yz, S_xx + S_yy); or f = m z, n = h x z.
    """
    (x, y, _), S = body.h, body.S
    if kind == "revolute":
        return Wrench((-y, x, 0), (-S[0][2], -S[1][2], S[0][0] + S[1][1]))
    return Wrench((0, 0, body.m), (y, -x, 0))


def inertia_tensor(body: Moments) -> Matrix:
    """Return J = tr(S) 1 - S, about the frame's origin."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.S
    return (yy + zz, -xy, -xz), (-xy, xx + zz, -yz), (-xz, -yz, xx + yy)


def ancestors(links: Sequence[Link], i: int) -> Iterator[int]:
    """Yield the links that carry link i, from its parent to the base."""
    while (i := links[i].parent) >= 0:
        yield i


def composites(arm: Posture) -> list[Moments]:
    """Return for every link the moments of it and all it carries, as one rigid body."""
    total = [link.body for link in arm.links]
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            total[link.parent] = total[link.parent] + moments_in_parent(link, total[i])
    return total
