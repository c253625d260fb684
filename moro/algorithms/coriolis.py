"""The Coriolis matrix of the Christoffel symbols, recursively, over any scalar.

Joint j gives the point r of a body the velocity r'_j per unit of its own, where r'_j is z x (r - o)
or z. A holonomic system has c_ijk = integral r'_i . d r'_j/dq_k dm, hence

    C_ij = sum over k of c_ijk qd_k = integral r'_i . d r'_j/dt dm,

and dM/dt - 2 C is skew. In axes at rest that agree with a link's at the moment, omega and v its
velocity, z changes at the rate zeta = omega x z, and z x (r - o) at zeta x r + lambda + z x dr/dt
with lambda = v x z. What the integrals need of dr/dt are the momentum p = integral dr/dt dm and the
matrix W = integral dr/dt r^T dm; like the moments, they add up from the tips to the base.

This is the factorization of Niemeyer & Slotine 1991, in the O(n^2) scheme of Echeandia & Wensing
2021, on second moments. Only ``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from moro.algorithms.newton_euler import Wrench
from moro.algorithms.posture import Link, Moments, Posture, posture
from moro.algorithms.transport import (
    Velocity,
    along_joint,
    ancestors,
    composites,
    inertia_tensor,
    matrix_in_parent,
    momentum,
    velocities,
    wrench_in_parent,
)
from moro.algorithms.vectors import add, cross, dyad, product, scaled, skew, sum_of, times
from moro.model import Matrix, Model, Scalar, Vector


class Flow(NamedTuple):
    """The first moments of dr/dt over the mass, r from the frame's origin."""

    #: integral of dr/dt dm
    p: Vector
    #: integral of dr/dt r^T dm
    W: Matrix


class Column(NamedTuple):
    """What the joints further in need of joint j: integrals over all that it moves."""

    #: of dr'_j/dt: force, and moment about the frame's origin
    change: Wrench
    #: of r'_j: linear and angular momentum
    momentum: Wrench
    #: of dr/dt x r'_j
    swirl: Vector


def coriolis_matrix(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> list[list[Scalar]]:
    """Return the rows of C(q, qd) (n x n), C_ij = sum_k c_ijk qd_k with Christoffel's c_ijk.

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. With arrays for scalars, many samples are computed at once.
    """
    return joint_coriolis(posture(model, q, sincos), qd)


def joint_coriolis(arm: Posture, qd: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of the Coriolis matrix of an arm in a posture."""
    links, motion = arm.links, velocities(arm, qd)
    C: list[list[Scalar]] = [[0] * len(links) for _ in links]
    bodies = zip(composites(arm), composite_flows(arm, motion), strict=True)
    for j, (body, flow) in enumerate(bodies):
        column = own_column(links[j], motion[j], body, flow)
        C[j][j] = along_joint(links[j], column.change)
        inner = links[j]
        for i in ancestors(links, j):
            change, inertia, swirl = column
            column = Column(
                wrench_in_parent(inner, change),
                wrench_in_parent(inner, inertia),
                inner.rotate(swirl),
            )
            inner = links[i]
            C[i][j] = along_joint(inner, column.change)
            C[j][i] = change_against(inner, motion[i], column)
    return C


def composite_flows(arm: Posture, motion: Sequence[Velocity]) -> list[Flow]:
    """Return for every link the flow of it and all it carries."""
    total = [body_flow(link.body, v) for link, v in zip(arm.links, motion, strict=True)]
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            p, W = link.rotate(total[i].p), matrix_in_parent(link, total[i].W)
            onto = total[link.parent]
            W = sum_of(W, dyad(p, link.p))
            total[link.parent] = Flow(add(onto.p, p), sum_of(onto.W, W))
    return total


def body_flow(body: Moments, velocity: Velocity) -> Flow:
    """Return the flow of a rigid body, dr/dt = v + omega x r."""
    (omega, v), h = velocity, body.h
    p = add(scaled(body.m, v), cross(omega, h))
    return Flow(p, sum_of(dyad(v, h), product(skew(omega), body.S)))


def own_column(link: Link, velocity: Velocity, body: Moments, flow: Flow) -> Column:
    """Return the column of a link's own joint, in its frame."""
    (wx, wy, _), (vx, vy, _) = velocity
    zeta: Vector = (wy, -wx, 0)
    (px, py, _), W, h = flow.p, flow.W, body.h
    if link.kind == "prismatic":
        change = Wrench(scaled(body.m, zeta), cross(h, zeta))
        return Column(change, momentum(link.kind, body), (py, -px, 0))
    # integral of r x (z x dr/dt) = tr(W) z - W z; of dr/dt x (z x r) = tr(W) z - W^T z
    lamda: Vector = (vy, -vx, 0)
    xx_yy = W[0][0] + W[1][1]
    f = add(add(cross(zeta, h), scaled(body.m, lamda)), (-py, px, 0))
    n = add(add(times(inertia_tensor(body), zeta), cross(h, lamda)), (-W[0][2], -W[1][2], xx_yy))
    swirl = -W[2][0], -W[2][1], xx_yy
    return Column(Wrench(f, n), momentum(link.kind, body), swirl)


def change_against(link: Link, velocity: Velocity, column: Column) -> Scalar:
    """Return integral r'_j . d r'_i/dt dm, i being this link's joint and j the column's."""
    (wx, wy, _), (vx, vy, _) = velocity
    (fx, fy, _), (nx, ny, _) = column.momentum
    if link.kind == "prismatic":
        return wy * fx - wx * fy
    return wy * nx - wx * ny + vy * fx - vx * fy + column.swirl[2]
