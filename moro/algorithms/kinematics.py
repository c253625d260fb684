"""Pose and Jacobian of the last frame, over any scalar.

The last frame of the convention, frame n, counts as a further link that neither moves nor weighs
anything. Only ``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from moro.algorithms.posture import Link, Moments, Posture, posture
from moro.algorithms.transport import ancestors
from moro.algorithms.vectors import add, cross, product, times, transpose
from moro.model import Model, Placement, Scalar, Vector


def forward_kinematics(
    model: Model, q: Sequence[Scalar], sincos: Sequence[tuple[Scalar, Scalar] | None]
) -> Placement:
    """Return the pose of frame n in frame 0: x_0 = R x_n + p [m].

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. With arrays for scalars, many samples are computed at once.
    """
    return poses(with_tip(posture(model, q, sincos), model.tip))[-1]


def jacobian(
    model: Model, q: Sequence[Scalar], sincos: Sequence[tuple[Scalar, Scalar] | None]
) -> list[list[Scalar]]:
    """Return the rows of J(q) (6 x n): (v, omega) of frame n = J qd, in the axes of frame 0.

    v, in the first three rows, is the velocity of the origin of frame n.
    """
    return tip_jacobian(with_tip(posture(model, q, sincos), model.tip))


def with_tip(arm: Posture, tip: Placement) -> Posture:
    """Return the arm with frame n as a further link, on the last one and at rest there."""
    last = len(arm.links) - 1
    link = Link("prismatic", last, tip.R, tip.p, 0, 1, 0, Moments(0))
    return replace(arm, links=(*arm.links, link))


def poses(arm: Posture) -> list[Placement]:
    """Return the poses of the links' frames in the base."""
    found: list[Placement] = []
    for link in arm.links:
        R, p = link.R, link.p
        if link.parent >= 0:
            parent = found[link.parent]
            R, p = product(parent.R, R), add(parent.p, times(parent.R, p))
        x, y, z = transpose(R)
        turned_x, turned_y = turned(x, y, link)
        found.append(Placement(transpose((turned_x, turned_y, z)), p))
    return found


def turned(x: Vector, y: Vector, link: Link) -> tuple[Vector, Vector]:
    """Return the axes x and y after the joint has turned them: cos x + sin y, cos y - sin x."""
    pairs = list(zip(x, y, strict=True))
    a, b, c = (link.cos * u + link.sin * v for u, v in pairs)
    d, e, f = (link.cos * v - link.sin * u for u, v in pairs)
    return (a, b, c), (d, e, f)


def tip_jacobian(arm: Posture) -> list[list[Scalar]]:
    """Return the rows of the Jacobian of the last link, which is no joint's but the tip.

    The columns are z x (p_n - p_i), z of a revolute joint and z, 0 of a prismatic one.
    """
    links, frames = arm.links, poses(arm)
    tip = len(links) - 1
    columns: list[tuple[Scalar, ...]] = [(0,) * 6] * tip
    for i in ancestors(links, tip):
        z, (x, y, w) = transpose(frames[i].R)[2], frames[i].p
        if links[i].kind == "revolute":
            columns[i] = (*cross(z, add(frames[tip].p, (-x, -y, -w))), *z)
        else:
            columns[i] = (*z, 0, 0, 0)
    return [list(row) for row in zip(*columns, strict=True)]
