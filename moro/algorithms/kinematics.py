"""Pose, Jacobian, velocity and acceleration of a frame, over any scalar.

The frame counts as a further link, the last, that neither moves nor weighs anything
(``posture.with_frame``). Only ``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import generalized
from moro.algorithms.newton_euler import forward_motion
from moro.algorithms.posture import PosedLink, Posture, ancestors, velocities, weightless
from moro.model import Placement
from moro.spatial.motion import Velocity
from moro.spatial.vectors import Scalar, Vector, add, product, times, transpose


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


def turned(x: Vector, y: Vector, link: PosedLink) -> tuple[Vector, Vector]:
    """Return the axes x and y after the joint has turned them: cos x + sin y, cos y - sin x."""
    pairs = list(zip(x, y, strict=True))
    a, b, c = (link.cos * u + link.sin * v for u, v in pairs)
    d, e, f = (link.cos * v - link.sin * u for u, v in pairs)
    return (a, b, c), (d, e, f)


def frame_jacobian(arm: Posture) -> list[list[Scalar]]:
    """Return the rows of J (6 x n), (v, omega) = J qd, of the last link, which is a frame's.

    v is the velocity of the frame's origin; in the axes of frame 0. The columns are
    z x (p - p_i), z of a revolute joint and z, 0 of a prismatic one.
    """
    links, frames = arm.links, poses(arm)
    tip = len(links) - 1
    columns: list[tuple[Scalar, ...]] = [(0,) * 6] * len(links)
    for i in ancestors(links, tip):
        z, (x, y, w) = transpose(frames[i].R)[2], frames[i].p
        linear, angular = links[i].type.column(z, add(frames[tip].p, (-x, -y, -w)))
        columns[i] = (*linear, *angular)
    return [generalized(links, row, arm.nv) for row in zip(*columns, strict=True)]


def frame_velocity(arm: Posture, qd: Sequence[Scalar]) -> Velocity:
    """Return (omega, v) = J qd of the last link, which is a frame's, in the axes of the base."""
    omega, v = velocities(arm, qd)[-1]
    return Velocity(in_base(arm, omega), in_base(arm, v))


def frame_acceleration(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> Velocity:
    """Return (alpha, a) = J qdd + dJ/dt qd of the last link, which is a frame's.

    a is the acceleration of the frame's origin, without gravity; in the axes of the base.
    """
    motion = forward_motion(weightless(arm), qd, qdd)[-1]
    return Velocity(in_base(arm, motion.alpha), in_base(arm, motion.a))


def in_base(arm: Posture, v: Vector) -> Vector:
    """Return the components of v in the axes of the base, given those in the last link's."""
    tip = len(arm.links) - 1
    for i in [tip, *ancestors(arm.links, tip)]:
        v = arm.links[i].rotate(v)
    return v
