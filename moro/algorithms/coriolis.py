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

from moro.algorithms.coordinates import in_coordinates
from moro.algorithms.posture import PosedLink, Posture, ancestors, composites, velocities
from moro.spatial.moments import Moments
from moro.spatial.motion import Velocity, Wrench
from moro.spatial.transform import matrix_in_parent, wrench_in_parent
from moro.spatial.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    dyad,
    product,
    scaled,
    skew,
    sum_of,
)


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


def joint_coriolis(arm: Posture, qd: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of C(q, qd) (n x n), C_ij = sum_k c_ijk qd_k with Christoffel's c_ijk."""
    links, motion = arm.links, velocities(arm, qd)
    C: list[list[Scalar]] = [[0] * len(links) for _ in links]
    bodies = zip(composites(arm), composite_flows(arm, motion), strict=True)
    for j, (body, flow) in enumerate(bodies):
        column = own_column(links[j], motion[j], body, flow)
        C[j][j] = links[j].type.along(column.change)
        inner = links[j]
        for i in ancestors(links, j):
            change, inertia, swirl = column
            column = Column(
                wrench_in_parent(inner, change),
                wrench_in_parent(inner, inertia),
                inner.rotate(swirl),
            )
            inner = links[i]
            C[i][j] = inner.type.along(column.change)
            C[j][i] = inner.type.against(motion[i], column.momentum, column.swirl)
    return in_coordinates(links, C, arm.nv)


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


def own_column(link: PosedLink, velocity: Velocity, body: Moments, flow: Flow) -> Column:
    """Return the column of a link's own joint, in its frame."""
    change, swirl = link.type.turning(velocity, body, flow.p, flow.W)
    return Column(change, link.type.momentum(body), swirl)
