"""What the drives add to the torques of the rigid bodies: rotor inertia and friction."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from moro.model import Joint, Model
from moro.spatial.vectors import Scalar


def drive_torques(
    model: Model,
    qd: Sequence[Scalar],
    qdd: Sequence[Scalar],
    sign: Callable[[Scalar], Scalar],
) -> tuple[Scalar, ...]:
    """Return rotor_inertia qdd + viscous qd + coulomb(qd) of every joint [N m or N].

    ``sign`` returns -1, 0 or 1 (``numpy.sign``, a graph's ``sign``, ...).
    """
    return tuple(
        joint.rotor_inertia * acceleration + friction(joint, velocity, sign)
        for joint, velocity, acceleration in zip(model.joints, qd, qdd, strict=True)
    )


def friction(joint: Joint, qd: Scalar, sign: Callable[[Scalar], Scalar]) -> Scalar:
    """Return the friction torque of a joint: viscous, and Coulomb's of either direction.

    With s = sign(qd), (p + n)/2 s + (p - n)/2 s^2 is p for qd > 0, -n for qd < 0, and 0 at rest.
    """
    positive, negative = joint.coulomb
    s = sign(qd)
    coulomb = s * ((positive + negative) / 2 + (positive - negative) / 2 * s)
    return joint.viscous * qd + coulomb
