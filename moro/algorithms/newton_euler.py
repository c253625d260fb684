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
from typing import NamedTuple

from moro.algorithms.posture import Link, Posture, posture
from moro.algorithms.vectors import add, cross, product, scaled, times, transpose
from moro.model import Matrix, Model, Scalar, Vector


class Motion(NamedTuple):
    """Motion of a link, in the axes of its frame."""

    #: angular velocity [rad/s]
    omega: Vector
    #: angular acceleration [rad/s^2]
    alpha: Vector
    #: [alpha]x + [omega]x [omega]x
    U: Matrix
    #: linear acceleration of the frame's origin minus gravity [m/s^2]
    a: Vector


class Wrench(NamedTuple):
    """Force and moment about the frame's origin, in the axes of the frame."""

    f: Vector
    n: Vector


def inverse_dynamics(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    qdd: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> tuple[Scalar, ...]:
    """Return the joint torques (forces) of the rigid bodies: M(q) qdd + C(q, qd) qd + G(q).

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. SI units, angles in rad. With arrays for scalars, many samples are computed at
    once. Rotor inertia and friction are a term of their own: ``moro.algorithms.drives``.
    """
    return joint_torques(posture(model, q, sincos), qd, qdd)


def joint_torques(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> tuple[Scalar, ...]:
    """Return the joint torques (forces) of an arm in a posture."""
    motions = forward_motion(arm, qd, qdd)
    wrenches = [body_wrench(*pair) for pair in zip(arm.links, motions, strict=True)]
    return backward_torques(arm, wrenches)


def forward_motion(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[Motion]:
    """Return the motion of every link, from the base, which accelerates with -g, to the tips."""
    x, y, z = arm.gravity
    zero: Vector = (0, 0, 0)
    base = Motion(zero, zero, (zero, zero, zero), (-x, -y, -z))
    motions: list[Motion] = []
    for link, velocity, acceleration in zip(arm.links, qd, qdd, strict=True):
        move = revolute_motion if link.kind == "revolute" else prismatic_motion
        parent = base if link.parent < 0 else motions[link.parent]
        motions.append(move(link, parent, velocity, acceleration))
    return motions


def revolute_motion(link: Link, parent: Motion, qd: Scalar, qdd: Scalar) -> Motion:
    """Return the motion of a link that turns about z, from that of its parent.

    omega = R^T omega_p + qd z,    alpha_z = z . R^T alpha_p + qdd,    a = R^T (a_p + U_p p).

    Points on the axis accelerate as if the link did not turn: U z = R^T U_p R z. This column of U
    holds alpha_x and alpha_y, and spares the products of R^T omega_p with qd.
    """
    a = link.rotate_back(add(parent.a, times(parent.U, link.p)))
    x, y, z = link.rotate_back(parent.omega)
    z = z + qd
    Uxz, Uyz, Uzz = link.rotate_back(times(parent.U, transpose(link.R)[2]))
    alpha = y * z - Uyz, Uxz - x * z, link.rotate_back(parent.alpha)[2] + qdd
    U: Matrix = (
        (Uzz + (x * x - z * z), x * y - alpha[2], Uxz),
        (x * y + alpha[2], -(x * x + z * z), Uyz),
        (x * z - alpha[1], y * z + alpha[0], Uzz),
    )
    return Motion((x, y, z), alpha, U, a)


def prismatic_motion(link: Link, parent: Motion, qd: Scalar, qdd: Scalar) -> Motion:
    """Return the motion of a link that slides along z, from that of its parent.

    omega = R^T omega_p,    U = R^T U_p R,    a = R^T (a_p + U_p p) + 2 qd omega x z + qdd z.
    """
    omega, alpha = link.rotate_back(parent.omega), link.rotate_back(parent.alpha)
    U = product(transpose(link.R), product(parent.U, link.R))
    x, y, z = link.rotate_back(add(parent.a, times(parent.U, link.p)))
    return Motion(omega, alpha, U, (x + 2 * qd * omega[1], y - 2 * qd * omega[0], z + qdd))


def body_wrench(link: Link, motion: Motion) -> Wrench:
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

    f_p += R f,    n_p += R n + p x R f;    tau = n_z (revolute) or f_z (prismatic).
    """
    total = list(wrenches)
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            f, n = link.rotate(total[i].f), link.rotate(total[i].n)
            onto = total[link.parent]
            total[link.parent] = Wrench(add(onto.f, f), add(onto.n, add(n, cross(link.p, f))))
    return tuple(
        wrench.n[2] if link.kind == "revolute" else wrench.f[2]
        for link, wrench in zip(arm.links, total, strict=True)
    )
