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

from moro.algorithms.newton_euler import Wrench, body_wrench, forward_motion
from moro.algorithms.posture import Link, Moments, Posture, posture
from moro.algorithms.transport import (
    REST,
    Velocity,
    along_joint,
    inertia_tensor,
    matrix_in_parent,
    moved,
    velocity_in_link,
    wrench_in_parent,
)
from moro.algorithms.vectors import (
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
    transpose,
)
from moro.model import Matrix, Model, Scalar


class ArticulatedInertia(NamedTuple):
    """n = I alpha + H a, f = H^T alpha + M a, about the frame's origin; I and M symmetric."""

    I: Matrix
    H: Matrix
    M: Matrix

    @classmethod
    def of(cls, body: Moments) -> ArticulatedInertia:
        """Return the inertia of a rigid body."""
        return cls(inertia_tensor(body), skew(body.h), diagonal(body.m))

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:  # type: ignore[override]
        return ArticulatedInertia(*(sum_of(A, B) for A, B in zip(self, other, strict=True)))

    def along(self, link: Link) -> Wrench:
        """Return the wrench per unit of acceleration about z (revolute) or along z."""
        if link.kind == "revolute":
            return Wrench(self.H[2], self.I[2])
        return Wrench(self.M[2], transpose(self.H)[2])

    def in_parent(self, link: Link) -> ArticulatedInertia:
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


def forward_dynamics(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    tau: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> list[Scalar]:
    """Return the joint accelerations that the torques (forces) ``tau`` cause, less friction.

    They solve M(q) qdd + C(q, qd) qd + G(q) = tau, with the rotor inertias on M's diagonal.
    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. Divides by zero where M is singular: where a joint moves neither mass nor rotor.
    """
    rotors = [joint.rotor_inertia for joint in model.joints]
    return joint_accelerations(posture(model, q, sincos), rotors, qd, tau)


def joint_accelerations(
    arm: Posture, rotors: Sequence[Scalar], qd: Sequence[Scalar], tau: Sequence[Scalar]
) -> list[Scalar]:
    """Return the joint accelerations of an arm in a posture."""
    motions = forward_motion(arm, qd, [0] * len(arm.links))
    bias = [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    return accelerations(arm, yielding_joints(arm, rotors, bias, tau))


def yielding_joints(
    arm: Posture, rotors: Sequence[Scalar], bias: Sequence[Wrench], tau: Sequence[Scalar]
) -> list[Yielding]:
    """Return how every joint yields, from the tips to the base."""
    inertias = [ArticulatedInertia.of(link.body) for link in arm.links]
    wrenches, joints = list(bias), []
    for i, link in reversed(list(enumerate(arm.links))):
        joint = yielding(link, inertias[i], rotors[i], tau[i] - along_joint(link, wrenches[i]))
        joints.append(joint)
        if (k := link.parent) >= 0:
            inertias[k] = inertias[k] + articulated(link, inertias[i], joint.share).in_parent(link)
            f, n = (scaled(joint.torque, share) for share in joint.share)
            passed = Wrench(add(wrenches[i].f, f), add(wrenches[i].n, n))
            f, n = wrench_in_parent(link, passed)
            wrenches[k] = Wrench(add(wrenches[k].f, f), add(wrenches[k].n, n))
    return joints[::-1]


def yielding(link: Link, inertia: ArticulatedInertia, rotor: Scalar, torque: Scalar) -> Yielding:
    """Return how a joint yields. Of its own component it bears all that the rotor does not."""
    wrench = inertia.along(link)
    reciprocal = 1 / (along_joint(link, wrench) + rotor)
    (fx, fy, fz), (nx, ny, nz) = (scaled(reciprocal, part) for part in wrench)
    if link.kind == "revolute":
        nz = 1 - rotor * reciprocal
    else:
        fz = 1 - rotor * reciprocal
    return Yielding(reciprocal, Wrench((fx, fy, fz), (nx, ny, nz)), torque)


def articulated(link: Link, inertia: ArticulatedInertia, share: Wrench) -> ArticulatedInertia:
    """Return what of an inertia is felt through the joint: less (wrench along it) (share)^T."""
    I, H, M = inertia
    f, n = inertia.along(link)
    mixed = dyad(share.n, f) if link.kind == "revolute" else dyad(n, share.f)
    I, M = difference(I, dyad(n, share.n)), difference(M, dyad(f, share.f))
    return ArticulatedInertia(symmetric(I), difference(H, mixed), symmetric(M))


def accelerations(arm: Posture, joints: Sequence[Yielding]) -> list[Scalar]:
    """Return the joint accelerations, from the base to the tips."""
    found: list[Scalar] = []
    links: list[Velocity] = []
    for link, (reciprocal, share, torque) in zip(arm.links, joints, strict=True):
        carried = velocity_in_link(link, REST if link.parent < 0 else links[link.parent])
        alpha, a = carried
        found.append(reciprocal * torque - (dot(share.n, alpha) + dot(share.f, a)))
        links.append(moved(link, carried, found[-1]))
    return found
