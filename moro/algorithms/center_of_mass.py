"""The centre of mass of an arm, and its Jacobian, over any scalar.

Joint i moves all that it carries as one rigid body, with mass m and first moment h about the axis:
the centre of mass gets (z x h) / M from a revolute joint and (m / M) z from a prismatic one, per
unit of its rate, M being the mass of the whole (Orin, Goswami & Lee 2013). ``+ - *`` are asked of
the scalars, and one division.
"""

from __future__ import annotations

from moro.algorithms.coordinates import generalized
from moro.algorithms.kinematics import poses
from moro.algorithms.posture import Posture, composites
from moro.spatial.vectors import Scalar, Vector, add, scaled, times


def center_of_mass(arm: Posture) -> Vector:
    """Return the centre of mass in the base [m]. Divides by the mass of the arm."""
    first: Vector = (0, 0, 0)
    for link, body in zip(arm.links, composites(arm), strict=True):
        if link.parent < 0:
            first = add(first, add(link.rotate(body.h), scaled(body.m, link.p)))
    return scaled(1 / mass(arm), first)


def center_of_mass_jacobian(arm: Posture) -> list[list[Scalar]]:
    """Return the rows of J (3 x n), the velocity of the centre of mass = J qd; in the base."""
    columns = []
    for link, pose, body in zip(arm.links, poses(arm), composites(arm), strict=True):
        momentum = link.type.momentum(body)
        columns.append(times(pose.R, momentum.f))
    reciprocal = 1 / mass(arm)
    rows = (generalized(arm.links, row, arm.nv) for row in zip(*columns, strict=True))
    return [[reciprocal * x for x in row] for row in rows]


def mass(arm: Posture) -> Scalar:
    """Return the mass of the arm [kg]."""
    return sum(link.body.m for link in arm.links)
