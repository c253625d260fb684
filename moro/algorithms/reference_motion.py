"""Torques for a reference velocity other than the velocity, recursively, over any scalar.

Slotine & Li 1991 (sec. 9.1) control an arm by M qdd_r + C(q, qd) qd_r + G, which keeps it passive
if dM/dt - 2 C is skew: with the Christoffel symbols' C. Joint j gives the point r of a body the
velocity r'_j per unit of its own, and (``moro.algorithms.coriolis``)

    (C qd_r)_i = integral r'_i . sum_j d r'_j/dt qd_rj dm,

so Newton-Euler stays what it is, with the rate at which the reference velocity sum_j r'_j qd_rj of
each point changes in place of its acceleration (Niemeyer & Slotine 1991). Only ``+ - *`` are asked
of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import joint_rates
from moro.algorithms.newton_euler import backward_torques, body_wrench
from moro.algorithms.posture import Posture, weightless
from moro.spatial.motion import ReferenceMotion
from moro.spatial.vectors import Scalar, Vector


def reference_torques(
    arm: Posture, qd: Sequence[Scalar], qd_r: Sequence[Scalar], qdd_r: Sequence[Scalar]
) -> tuple[Scalar, ...]:
    """Return M(q) qdd_r + C(q, qd) qd_r + G(q) of the rigid bodies [N m or N]."""
    motions = reference_motions(arm, qd, qd_r, qdd_r)
    return backward_torques(
        arm, [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    )


def coriolis_product(arm: Posture, qd: Sequence[Scalar], v: Sequence[Scalar]) -> tuple[Scalar, ...]:
    """Return C(q, qd) v, with the C of the Christoffel symbols [N m or N]."""
    return reference_torques(weightless(arm), qd, v, [0] * arm.nv)


def reference_motions(
    arm: Posture, qd: Sequence[Scalar], qd_r: Sequence[Scalar], qdd_r: Sequence[Scalar]
) -> list[ReferenceMotion]:
    """Return the motion of every link and its reference; the base accelerates with -g."""
    x, y, z = arm.gravity
    zero: Vector = (0, 0, 0)
    base = ReferenceMotion(zero, zero, zero, (zero, zero, zero), (-x, -y, -z))
    rates = [joint_rates(arm.links, x, arm.nv) for x in (qd, qd_r, qdd_r)]
    motions: list[ReferenceMotion] = []
    for link, *rate in zip(arm.links, *rates, strict=True):
        parent = base if link.parent < 0 else motions[link.parent]
        motions.append(link.type.reference_motion(link, parent, *rate))
    return motions
