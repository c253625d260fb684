"""The types of joints, one class each: what a joint does to a posture, a velocity, a wrench.

A joint moves its link about or along the z axis of its frame. The algorithms ask a type for what
depends on it and know nothing else of it: a new type is one more class here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from moro.spatial.moments import Moments
from moro.spatial.motion import Motion, ReferenceMotion, Velocity, Wrench
from moro.spatial.transform import Transform
from moro.spatial.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    dyad,
    product,
    scaled,
    times,
    transpose,
)

#: (sin, cos) of one angle
Pair: TypeAlias = tuple[Scalar, Scalar]


class JointType(ABC):
    """How the displacement x of a joint, its rate and its acceleration move a link."""

    name: ClassVar[str]
    #: short for the name
    letter: ClassVar[str]
    #: of x, and of the torque or force
    unit: ClassVar[str]
    effort: ClassVar[str]
    #: inertial parameters of the link that do not change when the joint moves, as if they were
    #: fixed to the parent; of a link that turns they belong to a rod on the axis
    carried: ClassVar[tuple[str, ...]]
    #: those that are zero for every link that it may move
    absent: ClassVar[tuple[str, ...]] = ()
    #: whether the points of the axis stay where they are
    fixes_axis: ClassVar[bool] = False
    #: whether the link's frame stays where it is, and carries nothing
    spins: ClassVar[bool] = False

    @property
    def is_angle(self) -> bool:
        """Whether x is an angle, the same after a whole turn."""
        return self.unit == "rad"

    @property
    @abstractmethod
    def assumed_limits(self) -> tuple[Scalar, Scalar]:
        """(lower, upper) of x where none are given."""

    @abstractmethod
    def displacement(self, x: Scalar) -> tuple[Scalar, Scalar]:
        """Return (angle about z, way along z) of the link at x."""

    @abstractmethod
    def transform(self, R: Matrix, p: Vector, x: Scalar, sincos: Pair) -> Transform:
        """Return where the link is at x, the joint being placed at R, p; sincos are those of x."""

    @abstractmethod
    def moved(self, velocity: Velocity, rate: Scalar) -> Velocity:
        """Return the velocity of the link, given that with the joint at rest."""

    @abstractmethod
    def motion(self, frame: Transform, parent: Motion, qd: Scalar, qdd: Scalar) -> Motion:
        """Return the motion of the link from that of its parent."""

    @abstractmethod
    def reference_motion(
        self, frame: Transform, parent: ReferenceMotion, qd: Scalar, qd_r: Scalar, qdd_r: Scalar
    ) -> ReferenceMotion:
        """Return the motion of the link, and of its reference, from those of its parent."""

    @abstractmethod
    def along(self, wrench: Wrench) -> Scalar:
        """Return what the joint bears of a wrench on the link."""

    @abstractmethod
    def bearing(self, wrench: Wrench, share: Scalar) -> Wrench:
        """Return the wrench of which the joint bears ``share`` instead."""

    @abstractmethod
    def coupling(self, wrench: Wrench, share: Wrench) -> Matrix:
        """Return n f^T / D for wrench = (f, n) and share = wrench / D: what the joint bears is one.

        n share_f^T and share_n f^T are the same; that of the two where ones cancel exactly.
        """

    @abstractmethod
    def momentum(self, body: Moments) -> Wrench:
        """Return the linear and angular momentum of a body per unit of the joint's rate."""

    @abstractmethod
    def carried_moments(self, body: Moments) -> Moments:
        """Return what of a body's moments does not change when the joint moves."""

    @abstractmethod
    def column(self, z: Vector, arm: Vector) -> tuple[Vector, Vector]:
        """Return (linear, angular) velocity per unit of rate of a point, ``arm`` from axis z."""

    @abstractmethod
    def turning(
        self, velocity: Velocity, body: Moments, p: Vector, W: Matrix
    ) -> tuple[Wrench, Vector]:
        """Return the integrals of dr'/dt and of dr/dt x r' over a body.

        r' is the velocity of the point r per unit of the joint's rate; p = integral dr/dt dm,
        W = integral dr/dt r^T dm, ``velocity`` that of the link.
        """

    @abstractmethod
    def against(self, velocity: Velocity, momentum: Wrench, swirl: Vector) -> Scalar:
        """Return the integral of r'_j . dr'/dt.

        ``momentum`` is the integral of r'_j, ``swirl`` that of dr/dt x r'_j, ``velocity`` that of
        the link.
        """


@dataclass(frozen=True)
class Revolute(JointType):
    """Turns its link about z by x [rad]."""

    name = "revolute"
    letter = "r"
    unit = "rad"
    effort = "N m"
    carried: ClassVar[tuple[str, ...]] = ("YY", "MZ", "M")
    fixes_axis = True

    @property
    def assumed_limits(self) -> tuple[Scalar, Scalar]:
        """Half a turn either way."""
        from sympy import pi  # takes long, and help needs joint types and no numbers

        return -pi, pi

    def displacement(self, x: Scalar) -> tuple[Scalar, Scalar]:
        """Return (x, 0)."""
        return x, 0

    def transform(self, R: Matrix, p: Vector, x: Scalar, sincos: Pair) -> Transform:
        """Return R Rz(x), p."""
        return Transform(R, p, *sincos)

    def moved(self, velocity: Velocity, rate: Scalar) -> Velocity:
        """Return (omega + rate z, v)."""
        (x, y, z), v = velocity
        return Velocity((x, y, z + rate), v)

    def motion(self, frame: Transform, parent: Motion, qd: Scalar, qdd: Scalar) -> Motion:
        """Return the motion of a link that turns about z.

        omega = R^T omega_p + qd z,    alpha_z = z . R^T alpha_p + qdd,    a = R^T (a_p + U_p p).

        Points on the axis accelerate as if the link did not turn: U z = R^T U_p R z. This column of
        U holds alpha_x and alpha_y, and spares the products of R^T omega_p with qd.
        """
        a = frame.rotate_back(add(parent.a, times(parent.U, frame.p)))
        x, y, z = frame.rotate_back(parent.omega)
        z = z + qd
        Uxz, Uyz, Uzz = frame.rotate_back(times(parent.U, transpose(frame.R)[2]))
        alpha = y * z - Uyz, Uxz - x * z, frame.rotate_back(parent.alpha)[2] + qdd
        U: Matrix = (
            (Uzz + (x * x - z * z), x * y - alpha[2], Uxz),
            (x * y + alpha[2], -(x * x + z * z), Uyz),
            (x * z - alpha[1], y * z + alpha[0], Uzz),
        )
        return Motion((x, y, z), alpha, U, a)

    def reference_motion(
        self, frame: Transform, parent: ReferenceMotion, qd: Scalar, qd_r: Scalar, qdd_r: Scalar
    ) -> ReferenceMotion:
        """Return those of a link that turns about z.

        omega_r = R^T omega_rp + qd_r z and so on as in ``motion``, which this is for qd_r = qd:
        U z = R^T U_p R z here too.
        """
        a = frame.rotate_back(add(parent.a, times(parent.U, frame.p)))
        x, y, z = frame.rotate_back(parent.omega)
        xr, yr, zr = frame.rotate_back(parent.reference)
        z, zr = z + qd, zr + qd_r
        Uxz, Uyz, Uzz = frame.rotate_back(times(parent.U, transpose(frame.R)[2]))
        turned = frame.rotate_back(parent.alpha)[2]
        # z . (omega x z) = 0: what turning adds to alpha is not along z
        alpha = y * zr - Uyz, Uxz - x * zr, turned + qdd_r
        U: Matrix = (
            (Uzz + (x * xr - z * zr), x * yr - alpha[2], Uxz),
            (y * xr + alpha[2], -(x * xr + z * zr), Uyz),
            (z * xr - alpha[1], z * yr + alpha[0], Uzz),
        )
        return ReferenceMotion((x, y, z), (xr, yr, zr), alpha, U, a)

    def along(self, wrench: Wrench) -> Scalar:
        """Return n_z."""
        return wrench.n[2]

    def bearing(self, wrench: Wrench, share: Scalar) -> Wrench:
        """Return the wrench with n_z = share."""
        return Wrench(wrench.f, (*wrench.n[:2], share))

    def coupling(self, wrench: Wrench, share: Wrench) -> Matrix:
        """Return share_n f^T."""
        return dyad(share.n, wrench.f)

    def momentum(self, body: Moments) -> Wrench:
        """Return f = z x h, n = J z, with J z = (-S_xz, -S_yz, S_xx + S_yy)."""
        (x, y, _), S = body.h, body.S
        return Wrench((-y, x, 0), (-S[0][2], -S[1][2], S[0][0] + S[1][1]))

    def carried_moments(self, body: Moments) -> Moments:
        """Return a rod on the axis: m, h_z and S_zz."""
        return Moments(body.m, (0, 0, body.h[2]), ((0, 0, 0), (0, 0, 0), (0, 0, body.S[2][2])))

    def column(self, z: Vector, arm: Vector) -> tuple[Vector, Vector]:
        """Return z x arm, z."""
        return cross(z, arm), z

    def turning(
        self, velocity: Velocity, body: Moments, p: Vector, W: Matrix
    ) -> tuple[Wrench, Vector]:
        """Return the integrals of zeta x r + lambda + z x dr/dt, and of dr/dt x (z x r).

        integral of r x (z x dr/dt) = tr(W) z - W z; of dr/dt x (z x r) = tr(W) z - W^T z.
        """
        zeta, lamda = _swing(velocity)
        (px, py, _), h, xx_yy = p, body.h, W[0][0] + W[1][1]
        f = add(add(cross(zeta, h), scaled(body.m, lamda)), (-py, px, 0))
        n = add(add(times(body.inertia, zeta), cross(h, lamda)), (-W[0][2], -W[1][2], xx_yy))
        return Wrench(f, n), (-W[2][0], -W[2][1], xx_yy)

    def against(self, velocity: Velocity, momentum: Wrench, swirl: Vector) -> Scalar:
        """Return zeta . n + lambda . f + z . swirl."""
        (wx, wy, _), (vx, vy, _) = velocity
        (fx, fy, _), (nx, ny, _) = momentum
        return wy * nx - wx * ny + vy * fx - vx * fy + swirl[2]


@dataclass(frozen=True)
class Prismatic(JointType):
    """Slides its link along z by x [m]."""

    name = "prismatic"
    letter = "p"
    unit = "m"
    effort = "N"
    carried = ("XX", "XY", "XZ", "YY", "YZ", "ZZ")

    @property
    def assumed_limits(self) -> tuple[Scalar, Scalar]:
        """From 0 to more than any arm has."""
        from sympy import Integer

        return Integer(0), Integer(1000)

    def displacement(self, x: Scalar) -> tuple[Scalar, Scalar]:
        """Return (0, x)."""
        return 0, x

    def transform(self, R: Matrix, p: Vector, x: Scalar, sincos: Pair) -> Transform:
        """Return R, p + R z x."""
        return Transform(R, add(p, times(R, (0, 0, x))), 0, 1)

    def moved(self, velocity: Velocity, rate: Scalar) -> Velocity:
        """Return (omega, v + rate z)."""
        omega, (x, y, z) = velocity
        return Velocity(omega, (x, y, z + rate))

    def motion(self, frame: Transform, parent: Motion, qd: Scalar, qdd: Scalar) -> Motion:
        """Return the motion of a link that slides along z.

        omega = R^T omega_p,    U = R^T U_p R,    a = R^T (a_p + U_p p) + 2 qd omega x z + qdd z.
        """
        omega, alpha = frame.rotate_back(parent.omega), frame.rotate_back(parent.alpha)
        U = product(transpose(frame.R), product(parent.U, frame.R))
        x, y, z = frame.rotate_back(add(parent.a, times(parent.U, frame.p)))
        return Motion(omega, alpha, U, (x + 2 * qd * omega[1], y - 2 * qd * omega[0], z + qdd))

    def reference_motion(
        self, frame: Transform, parent: ReferenceMotion, qd: Scalar, qd_r: Scalar, qdd_r: Scalar
    ) -> ReferenceMotion:
        """Return those of a link that slides along z.

        a = R^T (a_p + U_p p) + (qd omega_r + qd_r omega) x z + qdd_r z; the rest as in ``motion``.
        """
        omega, reference = frame.rotate_back(parent.omega), frame.rotate_back(parent.reference)
        U = product(transpose(frame.R), product(parent.U, frame.R))
        x, y, z = frame.rotate_back(add(parent.a, times(parent.U, frame.p)))
        wx, wy, _ = add(scaled(qd, reference), scaled(qd_r, omega))
        alpha = frame.rotate_back(parent.alpha)
        return ReferenceMotion(omega, reference, alpha, U, (x + wy, y - wx, z + qdd_r))

    def along(self, wrench: Wrench) -> Scalar:
        """Return f_z."""
        return wrench.f[2]

    def bearing(self, wrench: Wrench, share: Scalar) -> Wrench:
        """Return the wrench with f_z = share."""
        return Wrench((*wrench.f[:2], share), wrench.n)

    def coupling(self, wrench: Wrench, share: Wrench) -> Matrix:
        """Return n share_f^T."""
        return dyad(wrench.n, share.f)

    def momentum(self, body: Moments) -> Wrench:
        """Return f = m z, n = h x z."""
        x, y, _ = body.h
        return Wrench((0, 0, body.m), (y, -x, 0))

    def carried_moments(self, body: Moments) -> Moments:
        """Return all of S."""
        return Moments(0, S=body.S)

    def column(self, z: Vector, arm: Vector) -> tuple[Vector, Vector]:
        """Return z, 0."""
        return z, scaled(0, z)

    def turning(
        self, velocity: Velocity, body: Moments, p: Vector, W: Matrix
    ) -> tuple[Wrench, Vector]:
        """Return the integrals of zeta, and of dr/dt x z."""
        zeta, _ = _swing(velocity)
        return Wrench(scaled(body.m, zeta), cross(body.h, zeta)), (p[1], -p[0], 0)

    def against(self, velocity: Velocity, momentum: Wrench, swirl: Vector) -> Scalar:
        """Return zeta . f."""
        (wx, wy, _), (fx, fy, _) = velocity.omega, momentum.f
        return wy * fx - wx * fy


@dataclass(frozen=True)
class Rotor(Revolute):
    """Spins a body about z, its axis of symmetry, by x [rad]: the rotor of a motor, a flywheel.

    Nothing shows the angle of such a body, so its frame does not turn with it: positions do not
    depend on x, and a rotor behind a gear, x = 100 q, needs no sine. Its angular velocity is that
    of what carries it and dx/dt about z: so it couples with the joints before.
    """

    name = "rotor"
    letter = "m"
    carried = ("XX", "YY", "MZ", "M")
    absent = ("XY", "XZ", "YZ", "MX", "MY")
    spins = True

    def displacement(self, x: Scalar) -> tuple[Scalar, Scalar]:
        """Return (0, 0)."""
        return 0, 0

    def transform(self, R: Matrix, p: Vector, x: Scalar, sincos: Pair) -> Transform:
        """Return R, p."""
        return Transform(R, p, 0, 1)


def _swing(velocity: Velocity) -> tuple[Vector, Vector]:
    """Return zeta = omega x z and lambda = v x z: how a joint's axis changes as its link moves."""
    (wx, wy, _), (vx, vy, _) = velocity
    return (wy, -wx, 0), (vy, -vx, 0)


REVOLUTE, PRISMATIC, ROTOR = Revolute(), Prismatic(), Rotor()

#: by name
JOINT_TYPES: dict[str, JointType] = {kind.name: kind for kind in (REVOLUTE, PRISMATIC, ROTOR)}
