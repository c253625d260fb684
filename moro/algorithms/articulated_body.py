"""Forward dynamics by the articulated body algorithm, over any scalar.

Featherstone 2008 (ch. 7). A link with all it carries resists like one body, if the joints further
out are free to yield: its articulated inertia relates acceleration and wrench by

    n = I alpha + H a,    f = H^T alpha + M a.

Velocities and gravity enter once, by Newton-Euler: ``bias`` wrenches with all joint accelerations
zero. What the recursion finds is how the joint accelerations change that. ``+ - *`` are asked of
the scalars, and one division for every joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from moro.algorithms.coordinates import generalized, joint_rates
from moro.algorithms.newton_euler import body_wrench, forward_motion
from moro.algorithms.posture import PosedLink, Posture
from moro.spatial.moments import Moments
from moro.spatial.motion import REST, Velocity, Wrench
from moro.spatial.transform import matrix_in_parent, velocity_in_link, wrench_in_parent
from moro.spatial.vectors import (
    Matrix,
    Scalar,
    add,
    diagonal,
    difference,
    dot,
    dyad,
    product,
    scaled,
    skew,
    sum_of,
    symmetric,
    times,
    transpose,
)


class ArticulatedInertia(NamedTuple):
    """n = I alpha + H a, f = H^T alpha + M a, about the frame's origin; I and M symmetric."""

    I: Matrix
    H: Matrix
    M: Matrix

    @classmethod
    def of(cls, body: Moments) -> ArticulatedInertia:
        """Return the inertia of a rigid body."""
        return cls(body.inertia, skew(body.h), diagonal(body.m))

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:  # type: ignore[override]
        return ArticulatedInertia(*(sum_of(A, B) for A, B in zip(self, other, strict=True)))

    def wrench(self, acceleration: Velocity) -> Wrench:
        """Return the wrench for an acceleration (alpha, a)."""
        alpha, a = acceleration
        f = add(times(transpose(self.H), alpha), times(self.M, a))
        return Wrench(f, add(times(self.I, alpha), times(self.H, a)))

    def in_parent(self, link: PosedLink) -> ArticulatedInertia:
        """Return the inertia of a link as one of its parent, the joint being fixed."""
        I, H, M = (matrix_in_parent(link, A) for A in self)
        M, shift = symmetric(M), skew(link.p)
        moved = sum_of(H, product(shift, M))
        turned = sum_of(product(H, transpose(shift)), product(shift, transpose(moved)))
        return ArticulatedInertia(symmetric(sum_of(I, turned)), moved, M)


class Yielding(NamedTuple):
    """How a joint yields: qdd = torque / inertia - share . acceleration with the joint fixed."""

    #: 1 / (inertia that the joint feels)
    reciprocal: Scalar
    #: the wrench that the joint bears per unit of its torque
    share: Wrench
    #: of the drive, less what the bias wrenches and the joints further out take
    torque: Scalar


def joint_accelerations(
    arm: Posture, rotors: Sequence[Scalar], qd: Sequence[Scalar], tau: Sequence[Scalar]
) -> list[Scalar]:
    """Return the accelerations qdd that the torques (forces) ``tau`` cause, less friction.

    They solve M(q) qdd + C(q, qd) qd + G(q) = tau, with the rotor inertias on M's diagonal. Divides
    by zero where M is singular: where a joint moves neither mass nor rotor.

    Each coordinate must move one joint of its own, by 1 or -1: then A^-1 is A^T.
    """
    links = arm.links
    motions = forward_motion(arm, qd, [0] * arm.nv)
    bias = [body_wrench(*pair) for pair in zip(links, motions, strict=True)]
    of_joints = [rotors[link.terms[0][0]] for link in links]
    joints = yielding_joints(arm, of_joints, bias, joint_rates(links, tau, arm.nv))
    return generalized(links, accelerations(arm, joints), arm.nv)


def yielding_joints(
    arm: Posture, rotors: Sequence[Scalar], bias: Sequence[Wrench], tau: Sequence[Scalar]
) -> list[Yielding]:
    """Return how every joint yields, from the tips to the base."""
    inertias = [ArticulatedInertia.of(link.body) for link in arm.links]
    wrenches, joints = list(bias), []
    for i, link in reversed(list(enumerate(arm.links))):
        joint = yielding(link, inertias[i], rotors[i], tau[i] - link.type.along(wrenches[i]))
        joints.append(joint)
        if (k := link.parent) >= 0:
            inertias[k] = inertias[k] + articulated(link, inertias[i], joint.share).in_parent(link)
            f, n = (scaled(joint.torque, share) for share in joint.share)
            passed = Wrench(add(wrenches[i].f, f), add(wrenches[i].n, n))
            f, n = wrench_in_parent(link, passed)
            wrenches[k] = Wrench(add(wrenches[k].f, f), add(wrenches[k].n, n))
    return joints[::-1]


def yielding(
    link: PosedLink, inertia: ArticulatedInertia, rotor: Scalar, torque: Scalar
) -> Yielding:
    """Return how a joint yields. Of its own component it bears all that the rotor does not."""
    wrench = inertia.wrench(link.type.moved(REST, 1))
    reciprocal = 1 / (link.type.along(wrench) + rotor)
    share = Wrench(scaled(reciprocal, wrench.f), scaled(reciprocal, wrench.n))
    return Yielding(reciprocal, link.type.bearing(share, 1 - rotor * reciprocal), torque)


def articulated(link: PosedLink, inertia: ArticulatedInertia, share: Wrench) -> ArticulatedInertia:
    """Return what of an inertia is felt through the joint: less (wrench along it) (share)^T."""
    I, H, M = inertia
    wrench = inertia.wrench(link.type.moved(REST, 1))
    I, M = difference(I, dyad(wrench.n, share.n)), difference(M, dyad(wrench.f, share.f))
    H = difference(H, link.type.coupling(wrench, share))
    return ArticulatedInertia(symmetric(I), H, symmetric(M))


def accelerations(arm: Posture, joints: Sequence[Yielding]) -> list[Scalar]:
    """Return the joint accelerations, from the base to the tips."""
    found: list[Scalar] = []
    links: list[Velocity] = []
    for link, (reciprocal, share, torque) in zip(arm.links, joints, strict=True):
        carried = velocity_in_link(link, REST if link.parent < 0 else links[link.parent])
        alpha, a = carried
        found.append(reciprocal * torque - (dot(share.n, alpha) + dot(share.f, a)))
        links.append(link.type.moved(carried, found[-1]))
    return found
