"""Inverse dynamics of an arm whose last link something outside pushes, over any scalar."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.newton_euler import backward_torques, body_wrench, forward_motion
from moro.algorithms.posture import Posture, ancestors
from moro.spatial.motion import Wrench
from moro.spatial.vectors import Scalar, scaled


def joint_torques_in_contact(
    arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar], wrench: Sequence[Scalar]
) -> tuple[Scalar, ...]:
    """Return M(q) qdd + C(q, qd) qd + G(q) - J(q)^T w, of an arm whose last link is a frame.

    w = ``wrench`` is what the environment exerts on the link of the frame: force [N] and moment
    [N m] about the frame's origin, in the axes of frame 0, as the Jacobian has them.
    """
    motions = forward_motion(arm, qd, qdd)
    wrenches = [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    f, n = in_tip(arm, wrench)
    wrenches[-1] = Wrench(scaled(-1, f), scaled(-1, n))
    return backward_torques(arm, wrenches)


def in_tip(arm: Posture, wrench: Sequence[Scalar]) -> Wrench:
    """Return a wrench in the axes of the base as one in the axes of the tip."""
    fx, fy, fz, nx, ny, nz = wrench
    f, n = (fx, fy, fz), (nx, ny, nz)
    tip = len(arm.links) - 1
    for i in [*reversed(list(ancestors(arm.links, tip))), tip]:
        f, n = arm.links[i].rotate_back(f), arm.links[i].rotate_back(n)
    return Wrench(f, n)
