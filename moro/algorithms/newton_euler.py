"""Inverse dynamics by the recursive Newton-Euler algorithm, over any scalar.

Luh, Walker & Paul 1980, in the form of Khalil & Dombre (2002, ch. 9): vectors in the frame of the
link they belong to, wrenches about its origin; X_p is the parent's X, R the rotation that takes
components from the link's axes to the parent's. Angular motion enters through the one matrix

    U = [alpha]x + [omega]x [omega]x,

which gives the point r of the body the acceleration a + U r, and inertia through mass m, first
moment h = m c and second moments S = integral r r^T dm, so that the wrench that moves a body is

    f = m a + U h,    n = h x a + axial(U S),    axial(A) = (A_zy - A_yz, A_xz - A_zx, A_yx - A_xy).

Only ``+ - *`` (and halves, in S) are asked of the scalars: floats, arrays of samples, SymPy
expressions, graph nodes.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import generalized, joint_rates
from moro.algorithms.posture import PosedLink, Posture
from moro.spatial.motion import Motion, ReferenceMotion, Wrench
from moro.spatial.transform import wrench_in_parent
from moro.spatial.vectors import Scalar, Vector, add, cross, scaled, times


def joint_torques(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> tuple[Scalar, ...]:
    """Return the torques (forces) of the rigid bodies at the coordinates: M qdd + C qd + G.

    SI units, angles in rad. Rotor inertia and friction are a term of their own:
    ``moro.algorithms.drives``.
    """
    motions = forward_motion(arm, qd, qdd)
    wrenches = [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    return backward_torques(arm, wrenches)


def forward_motion(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Motion]:
    """Return the motion of every link, from the base, which accelerates with -g, to the tips."""
    x, y, z = arm.gravity
    zero: Vector = (0, 0, 0)
    base = Motion(zero, zero, (zero, zero, zero), (-x, -y, -z))
    motions: list[Motion] = []
    rates, accelerations = joint_rates(arm.links, qd, arm.nv), joint_rates(arm.links, qdd, arm.nv)
    for link, velocity, acceleration in zip(arm.links, rates, accelerations, strict=True):
        parent = base if link.parent < 0 else motions[link.parent]
        motions.append(link.type.motion(link, parent, velocity, acceleration))
    return motions


def body_wrench(link: PosedLink, motion: Motion | ReferenceMotion) -> Wrench:
    """Return the wrench that moves a body: f = m a + U h, n = h x a + axial(U S)."""
    m, h, a = link.body.m, link.body.h, motion.a
    (Uxx, Uxy, Uxz), (Uyx, Uyy, Uyz), (Uzx, Uzy, Uzz) = motion.U
    (Sxx, Sxy, Sxz), (_, Syy, Syz), (_, _, Szz) = link.body.S
    axial = (
        Uzx * Sxy + Uzy * Syy - Uyx * Sxz - Uyz * Szz + (Uzz - Uyy) * Syz,
        Uxy * Syz + Uxz * Szz - Uzx * Sxx - Uzy * Sxy + (Uxx - Uzz) * Sxz,
        Uyx * Sxx + Uyz * Sxz - Uxy * Syy - Uxz * Syz + (Uyy - Uxx) * Sxy,
    )
    f = add(scaled(m, a), times(motion.U, h))
    return Wrench(f, add(cross(h, a), axial))


def backward_torques(arm: Posture, wrenches: Sequence[Wrench]) -> tuple[Scalar, ...]:
    """Return the torques from the wrenches on the bodies, from the tips to the base.

    f_p += R f,    n_p += R n + p x R f;    tau = A^T (what the joints bear of their f, n).
    """
    total = list(wrenches)
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            (f, n), onto = wrench_in_parent(link, total[i]), total[link.parent]
            total[link.parent] = Wrench(add(onto.f, f), add(onto.n, n))
    borne = (link.type.along(x) for link, x in zip(arm.links, total, strict=True))
    return tuple(generalized(arm.links, borne, arm.nv))
