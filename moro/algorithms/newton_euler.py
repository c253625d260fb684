"""Inverse dynamics by the recursive Newton-Euler algorithm, over any scalar.

Luh, Walker & Paul 1980, in the form of Khalil & Dombre (2002, ch. 9): vectors in the frame of the
joint's own body, wrenches about its origin. Rotational motion enters through the one matrix

    U = [alpha]x + [omega]x [omega]x,

which gives a point r of the body the acceleration a + U r, and inertia through the second moments

    Sigma = integral r r^T dm = tr(J)/2 1 - J,

so that with the mass m and the first moment h = m c the wrench that moves a body is

    f = m a + U h,    n = h x a + axial(U Sigma - (U Sigma)^T).

Only ``+ - *`` (and a halving) are asked of the scalars: floats, arrays of samples, SymPy
expressions, graph nodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from moro.algorithms.vectors import add, cross, product, second_moments, times, transpose
from moro.model import Body, Joint, Matrix, Model, Scalar, Vector


class Motion(NamedTuple):
    """Motion of a body, in its own frame; the base accelerates with -g in place of gravity."""

    #: angular velocity [rad/s]
    omega: Vector
    #: angular acceleration [rad/s^2]
    alpha: Vector
    #: [alpha]x + [omega]x [omega]x
    U: Matrix
    #: linear acceleration of the frame's origin, minus gravity [m/s^2]
    a: Vector


class Wrench(NamedTuple):
    """Force and moment about the frame's origin, in the axes of the frame."""

    f: Vector
    n: Vector


class Pose(NamedTuple):
    """Pose of a joint's frame in its parent's: x_parent = R Rz x + p, with Rz by (sin, cos)."""

    R: Matrix
    p: Vector
    sin: Scalar
    cos: Scalar

    def rotate(self, v: Vector) -> Vector:
        """Return the components in the parent's axes of v, given in the joint's."""
        x, y, z = v
        return times(self.R, (self.cos * x - self.sin * y, self.sin * x + self.cos * y, z))

    def rotate_back(self, v: Vector) -> Vector:
        """Return the components in the joint's axes of v, given in the parent's."""
        x, y, z = times(transpose(self.R), v)
        return self.cos * x + self.sin * y, self.cos * y - self.sin * x, z


def inverse_dynamics(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    qdd: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> tuple[Scalar, ...]:
    """Return the n joint torques (forces) of the rigid bodies: M(q) qdd + C(q, qd) qd + G(q).

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint; what it holds for
    a prismatic one does not matter. SI units. Rotor inertia and friction are a term of their own:
    ``moro.algorithms.drives``.
    """
    poses = [joint_pose(*joint) for joint in zip(model.joints, q, sincos, strict=True)]
    motions = forward_motion(model, poses, qd, qdd)
    wrenches = [body_wrench(*body) for body in zip(model.bodies, motions, strict=True)]
    return backward_torques(model, poses, wrenches)


def joint_pose(joint: Joint, q: Scalar, sincos: tuple[Scalar, Scalar] | None) -> Pose:
    """Return the pose of a joint's frame in its parent's, the joint being at q."""
    R, p = joint.placement.R, joint.placement.p
    if joint.kind == "revolute":
        sin, cos = sincos  # type: ignore[misc]
        return Pose(R, p, sin, cos)
    return Pose(R, add(p, times(R, (0, 0, q + joint.offset))), 0, 1)


def forward_motion(
    model: Model, poses: Sequence[Pose], qd: Sequence[Scalar], qdd: Sequence[Scalar]
) -> list[Motion]:
    """Return the motion of every body, from the base to the tips."""
    x, y, z = model.gravity
    rest: Vector = (0, 0, 0)
    base = Motion(rest, rest, (rest, rest, rest), (-x, -y, -z))
    motions: list[Motion] = []
    for i, joint in enumerate(model.joints):
        parent = base if joint.parent < 0 else motions[joint.parent]
        move = revolute_motion if joint.kind == "revolute" else prismatic_motion
        motions.append(move(parent, poses[i], qd[i], qdd[i]))
    return motions


def revolute_motion(parent: Motion, pose: Pose, qd: Scalar, qdd: Scalar) -> Motion:
    """Return the motion of a body that turns about z, with Z = R z and everything in its axes.

    omega = R^T omega_p + qd z,    alpha_z = (R^T alpha_p)_z + qdd,    a = R^T (a_p + U_p p).

    The accelerations of the points of the axis do not know of the turning: U z = R^T U_p Z. This
    column holds alpha_x and alpha_y, without the products of R^T omega_p with qd.
    """
    wx, wy, wz = pose.rotate_back(parent.omega)
    wz = wz + qd
    axis = transpose(pose.R)[2]
    Uxz, Uyz, Uzz = pose.rotate_back(times(parent.U, axis))
    xz, yz = wx * wz, wy * wz
    alpha = (yz - Uyz, Uxz - xz, pose.rotate_back(parent.alpha)[2] + qdd)
    xy, xx, zz = wx * wy, wx * wx, wz * wz
    U: Matrix = (
        ((Uzz + xx) - zz, xy - alpha[2], Uxz),
        (xy + alpha[2], -(xx + zz), Uyz),
        (xz - alpha[1], yz + alpha[0], Uzz),
    )
    return Motion((wx, wy, wz), alpha, U, pose.rotate_back(add(parent.a, times(parent.U, pose.p))))


def prismatic_motion(parent: Motion, pose: Pose, qd: Scalar, qdd: Scalar) -> Motion:
    """Return the motion of a body that slides along z.

    omega = R^T omega_p,    U = R^T U_p R,    a = R^T (a_p + U_p p) + 2 qd omega x z + qdd z.
    """
    omega = pose.rotate_back(parent.omega)
    alpha = pose.rotate_back(parent.alpha)
    U = product(transpose(pose.R), product(parent.U, pose.R))
    x, y, z = pose.rotate_back(add(parent.a, times(parent.U, pose.p)))
    twice = 2 * qd
    return Motion(omega, alpha, U, (x + twice * omega[1], y - twice * omega[0], z + qdd))


def body_wrench(body: Body, motion: Motion) -> Wrench:
    """Return the wrench that moves a body: f = m a + U h, n = h x a + axial(U Sigma - ...)."""
    m, h, S = body.mass, body.first_moment, second_moments(body.inertia)
    a, U = motion.a, motion.U
    f = add((m * a[0], m * a[1], m * a[2]), times(U, h))
    n = (
        U[2][0] * S[0][1] + U[2][1] * S[1][1] - U[1][0] * S[0][2] - U[1][2] * S[2][2]
        + (U[2][2] - U[1][1]) * S[1][2],
        U[0][1] * S[1][2] + U[0][2] * S[2][2] - U[2][0] * S[0][0] - U[2][1] * S[0][1]
        + (U[0][0] - U[2][2]) * S[0][2],
        U[1][0] * S[0][0] + U[1][2] * S[0][2] - U[0][1] * S[1][1] - U[0][2] * S[1][2]
        + (U[1][1] - U[0][0]) * S[0][1],
    )  # fmt: skip
    return Wrench(f, add(cross(h, a), n))


def backward_torques(
    model: Model, poses: Sequence[Pose], wrenches: Sequence[Wrench]
) -> tuple[Scalar, ...]:
    """Return the torques: tips to base, each joint passes on what its body and children need.

    f_p += R f,    n_p += R n + p x R f,    tau = n_z (revolute) or f_z (prismatic).
    """
    total = list(wrenches)
    for i in reversed(range(model.dof)):
        parent, pose = model.joints[i].parent, poses[i]
        if parent >= 0:
            f, n = pose.rotate(total[i].f), pose.rotate(total[i].n)
            onto = total[parent]
            total[parent] = Wrench(add(onto.f, f), add(onto.n, add(n, cross(pose.p, f))))
    return tuple(
        wrench.n[2] if joint.kind == "revolute" else wrench.f[2]
        for joint, wrench in zip(model.joints, total, strict=True)
    )
