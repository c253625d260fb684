"""Inverse dynamics of an arm whose last link something outside pushes, over any scalar."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.kinematics import with_tip
from moro.algorithms.newton_euler import Wrench, backward_torques, body_wrench, forward_motion
from moro.algorithms.posture import Posture, posture
from moro.algorithms.transport import ancestors
from moro.algorithms.vectors import scaled
from moro.model import Model, Scalar


def inverse_dynamics_in_contact(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    qdd: Sequence[Scalar],
    wrench: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> tuple[Scalar, ...]:
    """Return M(q) qdd + C(q, qd) qd + G(q) - J(q)^T w.

    w = ``wrench`` is what the environment exerts on the last link: force [N] and moment [N m] about
    the origin of frame n, in the axes of frame 0, as the Jacobian has them. ``sincos`` and what is
    left out as in ``newton_euler.inverse_dynamics``.
    """
    arm = with_tip(posture(model, q, sincos), model.tip)
    return joint_torques_in_contact(arm, qd, qdd, wrench)


def joint_torques_in_contact(
    arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar], wrench: Sequence[Scalar]
) -> tuple[Scalar, ...]:
    """Return the joint torques of an arm in a posture, whose last link is the tip."""
    motions = forward_motion(arm, [*qd, 0], [*qdd, 0])
    wrenches = [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    f, n = in_tip(arm, wrench)
    wrenches[-1] = Wrench(scaled(-1, f), scaled(-1, n))
    return backward_torques(arm, wrenches)[:-1]


def in_tip(arm: Posture, wrench: Sequence[Scalar]) -> Wrench:
    """Return a wrench in the axes of the base as one in the axes of the tip."""
    fx, fy, fz, nx, ny, nz = wrench
    f, n = (fx, fy, fz), (nx, ny, nz)
    tip = len(arm.links) - 1
    for i in [*reversed(list(ancestors(arm.links, tip))), tip]:
        f, n = arm.links[i].rotate_back(f), arm.links[i].rotate_back(n)
    return Wrench(f, n)
