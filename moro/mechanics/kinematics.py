"""Kinematics: joints, frames, Jacobians, velocities; where masses are."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp

from moro.abc import t
from moro.checks import values as checks
from moro.checks.frame_called import frame_called
from moro.formats.hand_made import central
from moro.mechanics.derivation import Derivation
from moro.model import Central, Frame
from moro.scalars.trig import Trig
from moro.spatial.vectors import Vector, add, product, scaled, times, transpose


class Kinematics(Derivation):
    """Frame i is the model's frame called i, as those of DH rows are, or else that of joint i."""

    # -- joints -----------------------------------------------------------------------------------

    @property
    def joint_names(self) -> list[str]:
        """Name of each joint, in the order of q; "joint1", .. for those without."""
        return [x.name or f"joint{i}" for i, x in enumerate(self._model.coordinates, 1)]

    @property
    def joint_types(self) -> list[str]:
        """Type of each joint, "r" (revolute) or "p" (prismatic)."""
        return [kind.letter for kind in self._source.types]

    def joint_type(self, i: int) -> str:
        """Type of joint i: "r" (revolute) or "p" (prismatic)."""
        return self.joint_types[self._joint(i)]

    def q(self, i: int) -> Any:
        """Joint variable q_i [rad or m]."""
        return self.qs[self._joint(i)]

    def q_dot(self, i: int) -> Any:
        """Joint velocity dq_i/dt [rad/s or m/s]; 0, with a warning, if q_i is a plain symbol."""
        self._warn_if_static("q_dot", [self.q(i)])
        return self.q(i).diff(t)

    # -- frames -----------------------------------------------------------------------------------

    @property
    def frames(self) -> list[str]:
        """Names of the frames beside 0, the base: of links, where they have names; last the tip."""
        return [frame.name for frame in self._model.frames]

    @property
    def Ts(self) -> list[sp.Matrix]:
        """Transforms of neighbours, frame i in frame i - 1, for i = 1..n (4 x 4).

        On a tree, in the frame of the link that joint i hangs on.
        """
        joints = enumerate(self._model.joints, 1)
        return [self.T_ij(i, x.parent + 1) for i, x in joints if not x.type.spins]

    @property
    def T(self) -> sp.Matrix:
        """Forward kinematics T_n0: frame n, or the tip, expressed in frame 0 (4 x 4)."""
        return self._pose(self._model.tip, self._frame(0))

    def T_i0(self, i: int | str) -> sp.Matrix:
        """Frame i expressed in frame 0 (4 x 4)."""
        return self.T_ij(i, 0)

    def T_ij(self, i: int | str, j: int | str) -> sp.Matrix:
        """Frame i expressed in frame j, for any order of i and j (4 x 4)."""
        return self._pose(self._frame(i), self._frame(j))

    def R_i0(self, i: int | str) -> sp.Matrix:
        """Rotation of frame i in frame 0 (3 x 3)."""
        return self.T_i0(i)[:3, :3]

    def r_o(self, i: int | str) -> sp.Matrix:
        """Position of the origin of frame i, in frame 0 (3 x 1) [m]."""
        return self.T_i0(i)[:3, 3]

    def z(self, i: int | str) -> sp.Matrix:
        """Direction of the z axis of frame i, in frame 0 (3 x 1)."""
        return self.T_i0(i)[:3, 2]

    # -- Jacobians --------------------------------------------------------------------------------

    @property
    def J(self) -> sp.Matrix:
        """Geometric Jacobian of frame n, or the tip, in frame 0 (6 x n, linear rows first)."""
        return self._jacobian(self._model.tip, (0, 0, 0))

    def J_i0(self, i: int | str) -> sp.Matrix:
        """Geometric Jacobian of the origin of frame i, in frame 0 (6 x n, linear rows first)."""
        return self._jacobian(self._frame(i), (0, 0, 0))

    def J_point(self, point: Any, i: int | str) -> sp.Matrix:
        """Geometric Jacobian of a point of link i, given in frame i (6 x n, linear rows first)."""
        frame = self._frame(i if isinstance(i, str) else self._link(i) + 1)
        return self._jacobian(frame, checks.vector(point, "point", self.qs))

    def J_cm_i(self, i: int) -> sp.Matrix:
        """Jacobian of the centre of mass of link i, in frame 0 (6 x n, linear rows first)."""
        self._needed("cm_positions")
        body = self._central(self._link(i))
        return self._jacobian(self._axes_of(body, self._link(i)), body.com)

    def Jv_cm_i(self, i: int) -> sp.Matrix:
        """Linear velocity Jacobian of the centre of mass of link i (3 x n): v_Ci = Jv qd."""
        return self.J_cm_i(i)[:3, :]

    def Jw_cm_i(self, i: int) -> sp.Matrix:
        """Angular velocity Jacobian of link i (3 x n): w_i = Jw qd."""
        return self.J_cm_i(i)[3:, :]

    # -- masses in frame 0, velocities ------------------------------------------------------------

    def m(self, i: int) -> Any:
        """Mass m_i of link i [kg]."""
        self._needed("masses")
        return self._source.given("masses")[self._link(i)]

    def I_cm(self, i: int) -> sp.Matrix:
        """Inertia tensor I_Ci of link i about its centre of mass, in axes of frame i [kg m^2]."""
        self._needed("inertia_tensors")
        I: sp.Matrix = self._source.given("inertia_tensors")[self._link(i)]
        return I

    def r_cm(self, i: int) -> sp.Matrix:
        """Centre of mass of link i, in frame 0 (3 x 1) [m]."""
        link = self._link(i)
        self._needed("cm_positions")
        return self._matrix(("r_cm", i), lambda: [[x] for x in self._cm(link)])

    def I_cm0(self, i: int) -> sp.Matrix:
        """Inertia tensor of link i about its centre of mass, in axes of frame 0: R I R^T."""
        link = self._link(i)
        self._needed("inertia_tensors")
        return self._matrix(("I_cm0", i), lambda: self._rotated_tensor(link))

    def v_cm(self, i: int) -> sp.Matrix:
        """Velocity of the centre of mass of link i, in frame 0 (3 x 1): d r_Ci/dt [m/s]."""
        self._warn_if_static("v_cm")
        link = self._link(i)
        self._needed("cm_positions")
        return self._matrix(("v_cm", i), lambda: [[self._rate(x)] for x in self._cm(link)])

    def w(self, i: int) -> sp.Matrix:
        """Angular velocity of link i, in frame 0 (3 x 1) [rad/s]."""
        self._warn_if_static("w")
        link = self._link(i)
        carrying = [*reversed([*self._model.ancestors(link)]), link]
        return self._matrix(("w", i), lambda: self._angular_velocity(carrying))

    def w_rel0(self, i: int) -> sp.Matrix:
        """Angular velocity of link i relative to the link before, in frame 0 (3 x 1) [rad/s]."""
        self._warn_if_static("w_rel0")
        link = self._link(i)
        return self._matrix(("w_rel0", i), lambda: self._angular_velocity([link]))

    # -- elements ---------------------------------------------------------------------------------

    def _frame(self, i: int | str) -> Frame:
        return frame_called(self._model, i)

    def _pose(self, frame: Frame, reference: Frame) -> sp.Matrix:
        def rows() -> list[list[Trig]]:
            R, r = self._form.geometry.relative(frame, reference)
            zero, one = self._ring.zero, self._ring.one
            return [*([*row, x] for row, x in zip(R, r, strict=True)), [zero, zero, zero, one]]

        return self._matrix(("T", frame, reference), rows)

    def _jacobian(self, frame: Frame, point: Vector) -> sp.Matrix:
        def rows() -> list[list[Trig]]:
            columns = self._form.geometry.jacobian(frame, self._in_ring(point))
            return [list(row) for row in zip(*columns, strict=True)]

        return self._matrix(("J", frame, point), rows)

    def _central(self, link: int) -> Central:
        return central(self._model.bodies[link])

    def _axes_of(self, body: Central, link: int) -> Frame:
        return Frame("", link, body.frame)

    def _cm(self, link: int) -> list[Trig]:
        body = self._central(link)
        R, p = self._form.geometry.pose(self._axes_of(body, link))
        return [x + y for x, y in zip(p, times(R, self._in_ring(body.com)), strict=True)]

    def _rotated_tensor(self, link: int) -> Any:
        body = self._central(link)
        x, y, z = map(self._in_ring, body.inertia)
        R, _ = self._form.geometry.pose(self._axes_of(body, link))
        return product(product(R, (x, y, z)), transpose(R))

    def _rate(self, x: Trig) -> Trig:
        """dx/dt by the chain rule."""
        terms = (self._ring.diff(x, q) * qd for q, qd in zip(self.qs, self._rates(), strict=True))
        return sum(terms, self._ring.zero)

    def _angular_velocity(self, joints: Iterable[int]) -> list[list[Trig]]:
        rates, axes = self._form.geometry.joint_rates(self._rates()), self._form.geometry.axes
        omega: Vector = (self._ring.zero,) * 3
        for k in joints:
            _, angular = self._model.joints[k].type.column(axes[k], axes[k])
            omega = add(omega, scaled(rates[k], angular))
        return [[x] for x in omega]
