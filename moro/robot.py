"""``Robot``: rows of DH parameters in, every symbolic quantity of its mechanics out."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import sympy as sp

from moro import checks
from moro.abc import t
from moro.base_parameters import BaseParameter, BaseParameters, base_parameters
from moro.chain import Chain
from moro.closed_form import Arm, ClosedForm
from moro.collect import Collector
from moro.display import Display
from moro.from_dh import model_from_dh
from moro.model import Model
from moro.notation import MAX_DENOMINATOR, Notation
from moro.regressor import Regressor, regressor_columns
from moro.rows import given_rows, read_convention, read_rows
from moro.standard_parameters import BODY, Standard
from moro.tables import Table
from moro.trig import Trig, TrigRing

_REVOLUTE_LIMITS = (-sp.pi, sp.pi)
_PRISMATIC_LIMITS = (sp.Integer(0), sp.Integer(1000))


class Robot:
    """A serial robot arm given by rows of DH parameters.

    A row is ``(a, alpha, d, theta)`` or ``(a, alpha, d, theta, "r" | "p")``: link length [m], link
    twist [rad], link offset [m], joint angle [rad]. The joint variable stands in ``theta`` of a
    revolute joint and in ``d`` of a prismatic one, possibly plus a constant: ``q1 + pi/2``. Entries
    are numbers or SymPy expressions, in any mixture. ``convention`` is "dh" (standard or distal,
    T_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)) or "mdh" (modified or proximal, Rx(alpha) Tx(a) Rz(theta)
    Tz(d), with a and alpha of the link before).

    Joints and links are counted from 1, frames from 0 (the base). A subscript i0 means: frame i
    expressed in frame 0. Results are exact SymPy objects in their shortest common form; a float
    counts as the decimal it prints as, and makes results print decimals.

    >>> from moro import Robot
    >>> from moro.abc import *
    >>> Robot((l1, 0, 0, q1), (l2, 0, 0, q2)).T[0, 3]
    l_1*cos(q_1(t)) + l_2*cos(q_1(t) + q_2(t))

    Raises ValueError, TypeError or IndexError that names the row or link, what was expected and
    what was found.
    """

    def __init__(self, *rows: Any, convention: Literal["dh", "mdh"] = "dh", name: str = "robot"):
        self.name = name
        self._convention = read_convention(convention)
        self._rows_as_given = given_rows(rows)
        self._rows = read_rows(self._rows_as_given)
        self._masses: tuple[Any, ...] | None = None
        self._cm_positions: tuple[tuple[Any, ...], ...] | None = None
        self._inertia_tensors: tuple[tuple[tuple[Any, ...], ...], ...] | None = None
        self._gravity: tuple[Any, ...] | None = None
        self._rotor_inertias: tuple[Any, ...] | None = None
        self._viscous_friction: tuple[Any, ...] | None = None
        self._coulomb_friction: tuple[tuple[Any, Any], ...] | None = None
        self._joint_limits: tuple[tuple[Any, Any], ...] | None = None
        self._defaults: dict[Any, Any] = {}
        self._assumed: set[str] = set()
        self._with_floats: set[str] = set()
        if checks.has_float(self._rows_as_given):
            self._with_floats.add("rows")
        self._closed_form: ClosedForm | None = None
        self._display: Display | None = None
        self._results: dict[Any, Any] = {}

    @classmethod
    def load(cls, source: str | os.PathLike[str]) -> Robot:
        """Return the robot of a robot.yaml (a path) or of a packaged arm (its name)."""
        from moro.io import load

        return load(source)

    # -- what is given ----------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Name of the robot, a text."""
        return self._name

    @name.setter
    def name(self, text: Any) -> None:
        self._name = checks.name(text, "name")

    @property
    def convention(self) -> str:
        """Convention of the rows: "dh" (standard) or "mdh" (modified)."""
        return self._convention

    @property
    def dof(self) -> int:
        """Number of joints, n."""
        return len(self._rows)

    @property
    def joint_types(self) -> list[str]:
        """Type of each joint, "r" (revolute) or "p" (prismatic)."""
        return [row.kind for row in self._rows]

    def joint_type(self, i: int) -> str:
        """Type of joint i: "r" (revolute) or "p" (prismatic)."""
        return self._rows[self._joint(i)].kind

    @property
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""
        return [row.variable for row in self._rows]

    def q(self, i: int) -> Any:
        """Joint variable q_i [rad or m]."""
        return self._rows[self._joint(i)].variable

    def q_dot(self, i: int) -> Any:
        """Joint velocity dq_i/dt [rad/s or m/s]; 0, with a warning, if q_i is a plain symbol."""
        self._warn_if_static("q_dot", [self.q(i)])
        return self.q(i).diff(t)

    @property
    def dh_parameters(self) -> list[tuple[Any, ...]]:
        """The rows as they were given, (a, alpha, d, theta, type)."""
        return [
            (*map(sp.sympify, given[:4]), row.kind)
            for given, row in zip(self._rows_as_given, self._rows, strict=True)
        ]

    @property
    def dh_table(self) -> Table:
        """The rows as a table that prints in text, LaTeX and Jupyter."""
        headings = ("i", "a", "alpha", "d", "theta", "type")
        rows = [(i, *row) for i, row in enumerate(self.dh_parameters, 1)]
        return Table(headings, rows, self._notation)

    @property
    def joint_limits(self) -> list[tuple[Any, Any]]:
        """(lower, upper) of each joint [rad or m]; by default -pi..pi and 0..1000."""
        if self._joint_limits is not None:
            return list(self._joint_limits)
        return [_REVOLUTE_LIMITS if row.kind == "r" else _PRISMATIC_LIMITS for row in self._rows]

    @joint_limits.setter
    def joint_limits(self, limits: Any) -> None:
        if limits is None:
            self._joint_limits = None
            return
        pairs = checks.groups(limits, self.dof, "joint_limits", of="joint")
        self._joint_limits = tuple(
            checks.limits(pair, f"limits of joint {i}") for i, pair in enumerate(pairs, 1)
        )

    @property
    def masses(self) -> list[Any] | None:
        """m_1..m_n [kg]; None if not set. Setting None makes them the symbols m_1..m_n."""
        return None if self._masses is None else list(self._masses)

    @masses.setter
    def masses(self, values: Any) -> None:
        if values is None:
            new = tuple(sp.Symbol(f"m_{i}") for i in range(1, self.dof + 1))
        else:
            values = checks.scalars(values, self.dof, "masses")
            new = tuple(
                checks.not_negative(m, f"m_{i} of masses", self.qs) for i, m in enumerate(values, 1)
            )
        self._set("masses", new, values)

    def m(self, i: int) -> Any:
        """Mass m_i of link i [kg]."""
        return self._needed("masses")[self._link(i)]

    @property
    def cm_positions(self) -> list[sp.Matrix] | None:
        """Centres of mass r_Ci, in frame i [m]; None if not set."""
        if self._cm_positions is None:
            return None
        return [sp.Matrix(r) for r in self._cm_positions]

    @cm_positions.setter
    def cm_positions(self, values: Any) -> None:
        if values is None:
            raise ValueError("cm_positions are never assumed: give one [x, y, z] for each link")
        values = checks.groups(values, self.dof, "cm_positions")
        new = tuple(
            checks.vector(r, f"cm_positions of link {i}", self.qs) for i, r in enumerate(values, 1)
        )
        self._set("cm_positions", new, values)

    @property
    def inertia_tensors(self) -> list[sp.Matrix] | None:
        """Inertia tensors I_Ci about the centres of mass, in axes of frame i [kg m^2].

        None if not set. Setting None makes them diagonal, diag(I_{x_ix_i}, I_{y_iy_i}, I_{z_iz_i}).
        """
        if self._inertia_tensors is None:
            return None
        return [sp.Matrix(I) for I in self._inertia_tensors]

    @inertia_tensors.setter
    def inertia_tensors(self, values: Any) -> None:
        if values is None:
            new = tuple(_diagonal(i) for i in range(1, self.dof + 1))
        else:
            values = checks.groups(values, self.dof, "inertia_tensors")
            new = tuple(
                checks.tensor(I, f"inertia tensor of link {i}", self.qs)
                for i, I in enumerate(values, 1)
            )
        self._set("inertia_tensors", new, values)

    def I_cm(self, i: int) -> sp.Matrix:
        """Inertia tensor I_Ci of link i about its centre of mass, in axes of frame i [kg m^2]."""
        return sp.Matrix(self._needed("inertia_tensors")[self._link(i)])

    @property
    def gravity(self) -> sp.Matrix | None:
        """Gravitational acceleration, in frame 0 [m/s^2]; None if not set."""
        return None if self._gravity is None else sp.Matrix(self._gravity)

    @gravity.setter
    def gravity(self, value: Any) -> None:
        if value is None:
            raise ValueError("gravity is never assumed: give [x, y, z] in frame 0, [0, 0, -g] say")
        self._set("gravity", checks.vector(value, "gravity", self.qs), value)

    @property
    def rotor_inertias(self) -> list[Any] | None:
        """Rotor inertias, link side, on M's diagonal [kg m^2 or kg]; None means none."""
        return None if self._rotor_inertias is None else list(self._rotor_inertias)

    @rotor_inertias.setter
    def rotor_inertias(self, values: Any) -> None:
        self._set_joint_constants("rotor_inertias", values)

    @property
    def viscous_friction(self) -> list[Any] | None:
        """Viscous friction coefficients [N m s/rad or N s/m]; None means none."""
        return None if self._viscous_friction is None else list(self._viscous_friction)

    @viscous_friction.setter
    def viscous_friction(self, values: Any) -> None:
        self._set_joint_constants("viscous_friction", values)

    @property
    def coulomb_friction(self) -> list[tuple[Any, Any]] | None:
        """Coulomb friction for (qd > 0, qd < 0), as magnitudes [N m or N]; None means none."""
        return None if self._coulomb_friction is None else list(self._coulomb_friction)

    @coulomb_friction.setter
    def coulomb_friction(self, values: Any) -> None:
        if values is None:
            self._set("coulomb_friction", None, None)
            return
        values = checks.pairs(values, self.dof, "coulomb_friction")
        new = tuple(
            checks.both_directions(x, f"coulomb_friction of joint {i}", self.qs)
            for i, x in enumerate(values, 1)
        )
        self._set("coulomb_friction", new, values)

    @property
    def parameters(self) -> dict[Any, Any]:
        """The symbols left free in the model, with their default values (None: no default).

        Kernels take them at run time, in this order. Set a dictionary to give defaults.
        """
        free = set().union(*(x.free_symbols for x in self._constants())) - {t, *self.qs}
        _unlike_names(free)
        ordered = [s for s in self._defaults if s in free]
        ordered += sorted(free - set(ordered), key=lambda s: sp.default_sort_key(s))
        return {s: self._defaults.get(s) for s in ordered}

    @parameters.setter
    def parameters(self, defaults: Mapping[Any, Any]) -> None:
        self._defaults = {
            _symbol(key): None if value is None else checks.number(value, f"default of {key}")
            for key, value in _items(defaults, "parameters")
        }

    def with_parameters(self, values: Mapping[Any, Any]) -> Robot:
        """Return a new robot in which symbols have been given values.

        ``values`` maps symbols, or their names, to numbers or expressions. ValueError for a symbol
        that the model does not hold.
        """
        known = {str(s): s for s in self.parameters}
        new: dict[Any, Any] = {}
        for key, value in _items(values, "values"):
            symbol = known.get(str(key))
            if symbol is None:
                names = ", ".join(known) or "none"
                near = checks.suggestion(str(key), known)
                raise ValueError(
                    f"{key} is not a symbol of the model; its symbols are {names}{near}"
                )
            if symbol in new:
                raise ValueError(f"{key} is given two values")
            checks.constant(value, f"value of {key}", self.qs)
            new[symbol] = sp.sympify(value)
        return self._substituted(new)

    # -- frames -----------------------------------------------------------------------------------

    @property
    def Ts(self) -> list[sp.Matrix]:
        """Transforms of neighbours, frame i in frame i - 1, for i = 1..n (4 x 4)."""
        return [self.T_ij(i, i - 1) for i in range(1, self.dof + 1)]

    @property
    def T(self) -> sp.Matrix:
        """Forward kinematics T_n0: frame n expressed in frame 0 (4 x 4)."""
        return self.T_i0(self.dof)

    def T_i0(self, i: int) -> sp.Matrix:
        """Frame i expressed in frame 0 (4 x 4)."""
        return self.T_ij(i, 0)

    def T_ij(self, i: int, j: int) -> sp.Matrix:
        """Frame i expressed in frame j, for any order of i and j (4 x 4)."""
        i, j = self._frame(i), self._frame(j)
        return self._matrix(("T", i, j), lambda: self._transform(i, j))

    def R_i0(self, i: int) -> sp.Matrix:
        """Rotation of frame i in frame 0 (3 x 3)."""
        return self.T_i0(i)[:3, :3]

    def r_o(self, i: int) -> sp.Matrix:
        """Position of the origin of frame i, in frame 0 (3 x 1) [m]."""
        return self.T_i0(i)[:3, 3]

    def z(self, i: int) -> sp.Matrix:
        """Direction of the z axis of frame i, in frame 0 (3 x 1)."""
        return self.T_i0(i)[:3, 2]

    # -- Jacobians --------------------------------------------------------------------------------

    @property
    def J(self) -> sp.Matrix:
        """Geometric Jacobian of frame n, in frame 0 (6 x n, linear rows first)."""
        return self.J_point([0, 0, 0], self.dof)

    def J_point(self, point: Any, i: int) -> sp.Matrix:
        """Geometric Jacobian of a point of link i, given in frame i (6 x n, linear rows first)."""
        link = self._link(i)
        r = checks.vector(point, "point", self.qs)
        return self._matrix(("J", i, r), lambda: self._jacobian(link, r))

    def J_cm_i(self, i: int) -> sp.Matrix:
        """Jacobian of the centre of mass of link i, in frame 0 (6 x n, linear rows first)."""
        return self.J_point(self._needed("cm_positions")[self._link(i)], i)

    def Jv_cm_i(self, i: int) -> sp.Matrix:
        """Linear velocity Jacobian of the centre of mass of link i (3 x n): v_Ci = Jv qd."""
        return self.J_cm_i(i)[:3, :]

    def Jw_cm_i(self, i: int) -> sp.Matrix:
        """Angular velocity Jacobian of link i (3 x n): w_i = Jw qd."""
        return self.J_cm_i(i)[3:, :]

    # -- masses in frame 0, velocities ------------------------------------------------------------

    def r_cm(self, i: int) -> sp.Matrix:
        """Centre of mass of link i, in frame 0 (3 x 1) [m]."""
        link = self._link(i)
        self._needed("cm_positions")
        return self._matrix(("r_cm", i), lambda: [[x] for x in self._cm(link)])

    def I_cm0(self, i: int) -> sp.Matrix:
        """Inertia tensor of link i about its centre of mass, in axes of frame 0: R I R^T."""
        link = self._link(i)
        I = self._needed("inertia_tensors")[link]
        return self._matrix(("I_cm0", i), lambda: self._rotated_tensor(link, I))

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
        return self._matrix(("w", i), lambda: self._angular_velocity(range(link + 1)))

    def w_rel0(self, i: int) -> sp.Matrix:
        """Angular velocity of link i relative to link i - 1, in frame 0 (3 x 1) [rad/s]."""
        self._warn_if_static("w_rel0")
        link = self._link(i)
        return self._matrix(("w_rel0", i), lambda: self._angular_velocity([link]))

    # -- energies ---------------------------------------------------------------------------------

    def link_kinetic_energy(self, i: int) -> Any:
        """K_i = 1/2 m_i v_Ci . v_Ci + 1/2 w_i . (R I R^T) w_i [J]."""
        self._warn_if_static("link_kinetic_energy")
        link = self._link(i)
        self._needed("masses", "cm_positions", "inertia_tensors")
        return self._scalar(("K", i), lambda: self._kinetic_energies()[link])

    def link_potential_energy(self, i: int) -> Any:
        """P_i = -m_i g . r_Ci, zero at the origin of frame 0 [J]."""
        link = self._link(i)
        self._needed("masses", "cm_positions", "gravity")
        return self._scalar(("P", i), lambda: self._form.potential_energies[link])

    def kinetic_energy(self) -> Any:
        """K, the sum of all K_i, and 1/2 I_r qd^2 of the rotors if they are set [J]."""
        self._warn_if_static("kinetic_energy")
        self._needed("masses", "cm_positions", "inertia_tensors")
        return self._scalar("K", self._total_kinetic_energy)

    def potential_energy(self) -> Any:
        """P, the sum of all P_i [J]."""
        self._needed("masses", "cm_positions", "gravity")
        return self._scalar("P", lambda: sum(self._form.potential_energies, self._ring.zero))

    def lagrangian(self) -> Any:
        """L = K - P [J]."""
        self._warn_if_static("lagrangian")
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")
        return self._scalar("K", self._total_kinetic_energy) - self.potential_energy()

    # -- equations of motion ----------------------------------------------------------------------

    def inertia_matrix(self, collect: bool = False) -> Any:
        """M = sum of m Jv^T Jv + Jw^T R I R^T Jw, rotor inertias on the diagonal (n x n).

        By Jacobians, as in Spong, Hutchinson & Vidyasagar, Robot Modeling and Control, section 7.2,
        and Siciliano et al., Robotics, section 7.1. ``collect=True`` names the combinations of
        masses, lengths and inertias in it and returns a ``Collected``.
        """
        self._needed("masses", "cm_positions", "inertia_tensors")
        if collect:
            return self._collector.inertia_matrix()
        return self._matrix("M", lambda: self._form.inertia_matrix)

    def christoffel_symbols(self, i: int, j: int, k: int, M: Any) -> Any:
        """c_ijk = 1/2 (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i), for any n x n matrix M.

        Christoffel symbols of the first kind: Spong et al., section 7.3.
        """
        i, j, k = (self._joint(x) for x in (i, j, k))
        M = checks.matrix(M, "M")
        if M.shape != (self.dof, self.dof):
            raise ValueError(f"M must be {self.dof} x {self.dof}, not {M.shape[0]} x {M.shape[1]}")
        entry, diff, qs = self._ring.convert, self._ring.diff, self.qs
        total = (
            diff(entry(M[i, j]), qs[k]) + diff(entry(M[i, k]), qs[j]) - diff(entry(M[j, k]), qs[i])
        )
        return self._show(total * self._ring.half)

    def coriolis_matrix(self, collect: bool = False) -> Any:
        """C with C_ij = sum_k c_ijk qd_k (n x n): dM/dt - 2 C is skew-symmetric.

        ``collect=True`` writes it in the constants that it has in common with M.
        """
        self._warn_if_static("coriolis_matrix")
        self._needed("masses", "cm_positions", "inertia_tensors")
        if collect:
            return self._collector.coriolis_matrix()
        return self._coriolis_matrix()

    def gravity_vector(self, collect: bool = False) -> Any:
        """G = grad P (n x 1); ``collect=True`` names its constants."""
        self._needed("masses", "cm_positions", "gravity")
        if collect:
            return self._collector.gravity_vector()
        return self._matrix("G", lambda: [[x] for x in self._form.gravity_vector])

    def friction_vector(self) -> sp.Matrix:
        """Friction torques (n x 1), viscous * qd + Coulomb; zero where neither is set.

        Coulomb friction is (p - n)/2 sign(qd)^2 + (p + n)/2 sign(qd), that is p for qd > 0, -n for
        qd < 0 and 0 at rest.
        """
        self._warn_if_static("friction_vector")
        return sp.Matrix([self._friction(i) for i in range(self.dof)])

    def dynamic_model(self, collect: bool = False) -> Any:
        """Euler-Lagrange equations d/dt dL/dqd_i - dL/dq_i = tau_i, friction on the left if set.

        ``collect=True`` writes them in the constants of M and G: ``Collected.equations``.
        """
        self._warn_if_static("dynamic_model")
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")
        if collect:
            friction = [self._friction(i) for i in range(self.dof)]
            return self._collector.equations(friction, self._taus())
        left = self._matrix("EL", lambda: [[x] for x in self._euler_lagrange()])
        friction = [self._friction(i) for i in range(self.dof)]
        taus = self._taus()
        return [
            sp.Eq(x + f, tau, evaluate=False)
            for x, f, tau in zip(left, friction, taus, strict=True)
        ]

    def dynamic_model_matrix_form(self) -> Any:
        """M qdd + C qd + G = tau as an ``Eq`` of unevaluated blocks, friction beside G if set."""
        self._warn_if_static("dynamic_model_matrix_form")
        qd = sp.ImmutableMatrix([q.diff(t) for q in self.qs])
        qdd = sp.ImmutableMatrix([q.diff(t, 2) for q in self.qs])
        M, C, G = map(
            sp.ImmutableMatrix,
            (self.inertia_matrix(), self._coriolis_matrix(), self.gravity_vector()),
        )
        blocks = [sp.MatMul(M, qdd, evaluate=False), sp.MatMul(C, qd, evaluate=False), G]
        if self._viscous_friction or self._coulomb_friction:
            blocks.append(sp.ImmutableMatrix([self._friction(i) for i in range(self.dof)]))
        left = sp.MatAdd(*blocks, evaluate=False)
        return sp.Eq(left, sp.ImmutableMatrix(self._taus()), evaluate=False)

    # -- inertial parameters ----------------------------------------------------------------------

    def base_parameters(self, zeros: bool | None = None) -> BaseParameters:
        """Return the minimal inertial parameters: those that the torques can tell apart.

        Each is a combination of the links' inertial parameters XX_1, .., MX_1, .., M_1 (tensor,
        first moments and mass about the origin of Khalil's frame: z along joint i, x along the
        common normal to joint i + 1) with lengths and twists, and has a value in the symbols of
        the model. XXR_2 is XX_2 with others that act alike. Rotor inertias (IA) and friction (FV
        viscous; FC and FD Coulomb, half the sum of both directions and half the difference) are
        parameters too, if they are set. No smaller set gives the same torques; theory and sources
        are in ``moro.base_parameters``.

        Geometry and gravity decide which there are. A parameter whose value is zero is left out
        where zero is an assumption of the model (of a link given in symbols, of friction and
        rotors), and stands where it is a number among numbers; ``zeros`` True or False keeps or
        leaves out all of them.
        """
        self._needed("gravity")
        return BaseParameters(x for x in self._all_base_parameters() if self._counts(x, zeros))

    def regressor(self, zeros: bool | None = None) -> Regressor:
        """Return (Y, p) with M qdd + C qd + G + friction = Y(q, qd, qdd) p identically.

        Y is n x b, p the b values of ``base_parameters(zeros)``, in that order. The columns of Y
        are linearly independent.
        """
        self._warn_if_static("regressor")
        parameters = self.base_parameters(zeros)
        leaders = tuple(x.leader for x in parameters)
        columns = self._matrix(("Y", leaders), lambda: self._regressor_columns(leaders)).T
        return Regressor(columns.reshape(self.dof, len(leaders)), parameters.values)

    # -- as a whole -------------------------------------------------------------------------------

    def simplify(self, expr: Any) -> Any:
        """Return an expression (or matrix) in the joint variables in canonical, shortest form.

        Exact: two expressions that are equal as trigonometric polynomials become identical, and
        zero becomes 0.
        """
        if isinstance(expr, sp.MatrixBase):
            return expr.applyfunc(self.simplify)
        return self._show(self._ring.convert(expr))

    def model_summary(self) -> Table:
        """Return what is given, what was assumed by default, and what is not set."""
        rows = [("rows", "given", f"{self.dof}, {self._convention}, {''.join(self.joint_types)}")]
        for name, use in _QUANTITIES.items():
            value = getattr(self, f"_{name}")
            if name in self._assumed:
                rows.append((name, "assumed", _brief(getattr(self, name))))
            elif value is not None:
                rows.append((name, "given", _brief(getattr(self, name))))
            elif name == "joint_limits":
                rows.append((name, "assumed", _brief(self.joint_limits)))
            else:
                rows.append((name, "not set", use))
        return Table(("quantity", "state", "value"), rows)

    def latex(self, expr: Any) -> str:
        r"""Return an expression, or matrix, in LaTeX as the texts write it: s_{23}, \dot{q}_1."""
        return self._notation.latex(expr)

    def report(
        self, kind: Literal["tex", "html"], path: str | os.PathLike[str] | None = None
    ) -> str:
        """Return the derivation of the arm's equations, for LaTeX or a browser.

        Rows, frames, Jacobians, energies, M, C, G and the equations of motion, in the notation of
        the texts, long sub-expressions named, no line wider than the page. ``path``: written there
        too. The LaTeX needs amsmath and geometry, the HTML nothing else.
        """
        from moro.report import report

        page = report(self, kind)
        if path is not None:
            Path(path).write_text(page, encoding="utf-8")
        return page

    def model(self) -> Model:
        """Return the arm as the recursive algorithms read it (``moro.model``)."""
        return model_from_dh(self.name, self.arm, self._viscous_friction, self._coulomb_friction)

    @property
    def arm(self) -> Arm:
        """The arm's data as ``moro.closed_form.ClosedForm`` reads it."""
        return Arm(
            self._rows,
            self._convention,
            self._masses,
            self._cm_positions,
            self._inertia_tensors,
            self._gravity,
            self._rotor_inertias,
        )

    def __repr__(self) -> str:
        kinds = "".join(self.joint_types).upper()
        return f"<Robot {self.name}: {self.dof} joints {kinds}, convention {self._convention}>"

    def _repr_latex_(self) -> str:
        return self.dh_table._repr_latex_()

    # -- closed forms -----------------------------------------------------------------------------

    @property
    def _form(self) -> ClosedForm:
        if self._closed_form is None:
            self._closed_form = ClosedForm(self.arm, TrigRing())
            # one order of generators, whatever is asked for first: equal results are identical
            for symbol in (*self.qs, *self._velocities(), *self.parameters):
                self._closed_form.ring.generator(symbol)
        return self._closed_form

    @property
    def _ring(self) -> TrigRing:
        ring: TrigRing = self._form.ring
        return ring

    def _show(self, p: Trig) -> Any:
        return self._shown_by(p)

    @property
    def _shown_by(self) -> Display:
        if self._display is None:
            tensors = self._inertia_tensors or ()
            constants = [*(self._masses or ()), *(x for I in tensors for row in I for x in row)]
            self._display = Display(
                self._ring,
                inertial=set().union(*(x.free_symbols for x in constants)),
                velocities=self._velocities(),
                decimal=bool(self._with_floats),
            )
        return self._display

    @property
    def _notation(self) -> Notation:
        fractions = {x for values in self._constants() for x in values.atoms(sp.Rational)}
        decimals = any(x.q in (5, 10) or x.q > MAX_DENOMINATOR for x in fractions)
        return Notation(self.qs, self.parameters, decimals=decimals)

    @property
    def _collector(self) -> Collector:
        if "collector" not in self._results:
            self._results["collector"] = Collector(
                self._form, self._shown_by, self._notation, self.parameters
            )
        collector: Collector = self._results["collector"]
        return collector

    def _matrix(self, key: Any, entries: Callable[[], Sequence[Sequence[Trig]]]) -> sp.Matrix:
        if key not in self._results:
            rows = [[self._show(x) for x in row] for row in entries()]
            self._results[key] = sp.ImmutableMatrix(rows)
        return sp.Matrix(self._results[key])

    def _scalar(self, key: Any, value: Callable[[], Trig]) -> Any:
        if key not in self._results:
            self._results[key] = self._show(value())
        return self._results[key]

    def _transform(self, i: int, j: int) -> list[list[Trig]]:
        ring, low, high = self._ring, min(i, j), max(i, j)
        one, zero = ring.one, ring.zero
        R = [[one if a == b else zero for b in range(3)] for a in range(3)]
        r = [zero] * 3
        if high > low:
            chain = self._form.chain
            if low > 0:
                chain = Chain(self._rows[low:high], self._convention, ring, declare=False)
            R, r = chain.R(high - low - 1), chain.origins[high - low - 1]
        if i < j:
            R = [list(column) for column in zip(*R, strict=True)]
            r = [-(a * r[0] + b * r[1] + c * r[2]) for a, b, c in R]
        return [*([*row, x] for row, x in zip(R, r, strict=True)), [zero, zero, zero, one]]

    def _jacobian(self, link: int, point: Sequence[Any]) -> list[list[Trig]]:
        zero = self._ring.zero
        columns = self._form.chain.jacobian_in_base(link, [self._ring.convert(x) for x in point])
        columns += [[zero] * 6] * (self.dof - len(columns))
        return [list(row) for row in zip(*columns, strict=True)]

    def _cm(self, link: int) -> list[Trig]:
        chain, r = self._form.chain, self._needed("cm_positions")[link]
        return chain.point_in_base(link, [self._ring.convert(x) for x in r])

    def _rotated_tensor(self, link: int, I: Any) -> list[list[Trig]]:
        tensor = [[self._ring.convert(x) for x in row] for row in I]
        return self._form.chain.tensor_in_base(link, tensor)

    def _velocities(self) -> list[Any]:
        """Joint velocities and accelerations, but of joint variables that are plain symbols."""
        return [q.diff(t, k) for k in (1, 2) for q in self.qs if not q.is_Symbol]

    def _rates(self) -> list[Trig]:
        return [self._ring.convert(q.diff(t)) for q in self.qs]

    def _rate(self, x: Trig) -> Trig:
        """dx/dt by the chain rule."""
        terms = (self._ring.diff(x, q) * qd for q, qd in zip(self.qs, self._rates(), strict=True))
        return sum(terms, self._ring.zero)

    def _angular_velocity(self, joints: Iterable[int]) -> list[list[Trig]]:
        rates, axes = self._rates(), self._form.chain.axes
        turning = [k for k in joints if self._rows[k].kind == "r"]
        return [[sum((axes[k][a] * rates[k] for k in turning), self._ring.zero)] for a in range(3)]

    def _coriolis_matrix(self) -> sp.Matrix:
        return self._matrix("C", lambda: self._form.coriolis_matrix(self._rates()))

    def _kinetic_energies(self) -> list[Trig]:
        if "K_i" not in self._results:
            self._results["K_i"] = self._form.kinetic_energies(self._rates())
        energies: list[Trig] = self._results["K_i"]
        return energies

    def _total_kinetic_energy(self) -> Trig:
        links = sum(self._kinetic_energies(), self._ring.zero)
        rotors: Trig = self._form.rotor_energy(self._rates())
        return links + rotors

    def _euler_lagrange(self) -> list[Trig]:
        return self._at_rest(self._form.euler_lagrange(*self._motion))

    @property
    def _motion(self) -> tuple[list[Any], list[Any]]:
        """Symbols of the joint velocities and accelerations, also of joint variables at rest."""
        if "motion" not in self._results:
            orders = ([q.diff(t, k) or sp.Dummy() for q in self.qs] for k in (1, 2))
            self._results["motion"] = tuple(orders)
        rates, accelerations = self._results["motion"]
        return rates, accelerations

    def _at_rest(self, polynomials: Sequence[Trig]) -> list[Trig]:
        """Put in zero for the velocities of joint variables that are plain symbols."""
        still = [x for order in self._motion for x in order if x.is_Symbol]
        still += [sp.sign(x) for x in still]
        return [self._ring.coefficients(p, still).get(0, self._ring.zero) for p in polynomials]

    def _all_base_parameters(self) -> BaseParameters:
        if "base parameters" not in self._results:
            friction = {
                Standard(i, name): value
                for i in range(self.dof)
                for name, value in self._friction_coefficients(i).items()
            }
            rates, _ = self._motion
            self._results["base parameters"] = base_parameters(
                self.arm, friction, self._ring, rates, self._shown_by
            )
        found: BaseParameters = self._results["base parameters"]
        return found

    def _regressor_columns(self, leaders: Sequence[Standard]) -> list[list[Trig]]:
        columns = regressor_columns(leaders, self.arm, self._ring, *self._motion)
        return [self._at_rest(column) for column in columns]

    def _counts(self, parameter: BaseParameter, zeros: bool | None) -> bool:
        if zeros or parameter.value != 0:
            return True
        return zeros is None and parameter.leader.name in BODY and self._in_numbers(parameter.link)

    def _in_numbers(self, link: int) -> bool:
        """Whether a link's mass, centre of mass and tensor are given as numbers."""
        given = (self._masses, self._cm_positions, self._inertia_tensors)
        return all(x and not sp.Tuple(x[link - 1]).free_symbols for x in given)

    def _friction(self, i: int) -> Any:
        qd = self.qs[i].diff(t)
        speed = {"FV": qd, "FC": sp.sign(qd), "FD": sp.sign(qd) ** 2}
        terms = (x * speed[name] for name, x in self._friction_coefficients(i).items())
        return sum(terms, sp.Integer(0))

    def _friction_coefficients(self, i: int) -> dict[str, Any]:
        """Viscous (FV); Coulomb, half the sum of both directions (FC) and the difference (FD)."""
        coefficients = {}
        if self._viscous_friction is not None:
            coefficients["FV"] = self._viscous_friction[i]
        if self._coulomb_friction is not None:
            forward, backward = self._coulomb_friction[i]
            coefficients |= {"FC": (forward + backward) / 2, "FD": (forward - backward) / 2}
        return coefficients

    def _taus(self) -> list[Any]:
        return [sp.Symbol(f"tau_{i}") for i in range(1, self.dof + 1)]

    # -- state ------------------------------------------------------------------------------------

    def _forget(self) -> None:
        """Drop what was derived from older values."""
        self._closed_form = None
        self._display = None
        self._results = {}

    def _set(self, name: str, new: Any, given: Any) -> None:
        setattr(self, f"_{name}", new)
        self._assumed.discard(name)
        self._with_floats.discard(name)
        if given is None and new is not None:
            self._assumed.add(name)
        elif checks.has_float(given):
            self._with_floats.add(name)
        self._forget()

    def _set_joint_constants(self, name: str, values: Any) -> None:
        new = None
        if values is not None:
            values = checks.scalars(values, self.dof, name, of="joint")
            new = tuple(
                checks.not_negative(x, f"{name} of joint {i}", self.qs)
                for i, x in enumerate(values, 1)
            )
        self._set(name, new, values)

    def _needed(self, *names: str) -> Any:
        """Return the last of these quantities; ValueError says how to set one that is missing."""
        for name in names:
            if getattr(self, f"_{name}") is None:
                raise ValueError(f"{name} not set: {_QUANTITIES[name]}")
        return getattr(self, f"_{names[-1]}")

    def _constants(self) -> Iterable[Any]:
        for row in self._rows:
            yield from (row.a, row.alpha, row.d, row.theta)
        yield from self._masses or ()
        for vector in self._cm_positions or ():
            yield from vector
        for tensor in self._inertia_tensors or ():
            for line in tensor:
                yield from line
        yield from self._gravity or ()
        yield from self._rotor_inertias or ()
        yield from self._viscous_friction or ()
        for pair in self._coulomb_friction or ():
            yield from pair

    def _substituted(self, values: Mapping[Any, Any]) -> Robot:
        def put(x: Any) -> Any:
            if isinstance(x, tuple):
                return tuple(put(item) for item in x)
            return x.xreplace(values) if isinstance(x, sp.Basic) else x

        rows = []
        for row in self._rows:
            a, alpha, d, theta = map(put, (row.a, row.alpha, row.d, row.theta))
            turning = row.kind == "r"
            theta, d = (theta + row.variable, d) if turning else (theta, d + row.variable)
            rows.append((a, alpha, d, theta, row.kind))
        robot = Robot(*rows, convention=self._convention, name=self.name)
        for name in _QUANTITIES:
            value = getattr(self, f"_{name}")
            if value is not None:
                setattr(robot, name, put(value))
        robot._assumed = set(self._assumed)
        robot._defaults = {s: x for s, x in self._defaults.items() if s not in values}
        robot._with_floats |= self._with_floats
        return robot

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            near = checks.suggestion(name, (x for x in dir(type(self)) if not x.startswith("_")))
            raise AttributeError(f"a Robot has no {name}{near}")
        super().__setattr__(name, value)

    def _warn_if_static(self, method: str, variables: Sequence[Any] | None = None) -> None:
        static = [q for q in variables or self.qs if q.is_Symbol]
        if static:
            names = ", ".join(map(str, static))
            warnings.warn(
                f"{method}: velocities are zero, for {names} is no function of time; use q1 of "
                "moro.abc, or sympy.Function('q1')(t), as joint variable",
                UserWarning,
                stacklevel=3,
            )

    def _joint(self, i: int) -> int:
        return checks.index(i, 1, self.dof, "joint") - 1

    def _link(self, i: int) -> int:
        return checks.index(i, 1, self.dof, "link") - 1

    def _frame(self, i: int) -> int:
        return checks.index(i, 0, self.dof, "frame")


#: what can be set, and how
_QUANTITIES = {
    "masses": "robot.masses = [m1, ...], or None for symbols m_1, m_2, ...",
    "cm_positions": "robot.cm_positions = [[x, y, z], ...], in frame i",
    "inertia_tensors": "robot.inertia_tensors = [3 x 3 matrix, ...], or None for diagonal symbols",
    "gravity": "robot.gravity = [x, y, z], in frame 0",
    "rotor_inertias": "none; robot.rotor_inertias = [value, ...]",
    "viscous_friction": "none; robot.viscous_friction = [value, ...]",
    "coulomb_friction": "none; robot.coulomb_friction = [value or (forward, backward), ...]",
    "joint_limits": "robot.joint_limits = [(lower, upper), ...]",
}


def _diagonal(i: int) -> tuple[tuple[Any, ...], ...]:
    symbols = [sp.Symbol(f"I_{{{x}_{i}{x}_{i}}}") for x in "xyz"]
    zero = sp.Integer(0)
    return tuple(tuple(symbols[j] if j == k else zero for k in range(3)) for j in range(3))


def _items(values: Any, what: str) -> Iterable[tuple[Any, Any]]:
    if not isinstance(values, Mapping):
        raise TypeError(
            f"{what} must be a dictionary {{symbol: value}}, not {checks.brief(values)}"
        )
    return values.items()


def _unlike_names(symbols: Iterable[Any]) -> None:
    """Raise ValueError if two different symbols have one name."""
    names = [str(s) for s in symbols]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(
                f"two different symbols are called {name}: Symbol({name!r}) and one with "
                "assumptions, real=True say; use one of them throughout"
            )


def _symbol(key: Any) -> Any:
    if not isinstance(key, (str, sp.Symbol)):
        raise TypeError(f"a parameter must be a symbol or its name, not {checks.brief(key)}")
    return sp.Symbol(key) if isinstance(key, str) else key


def _brief(value: Any) -> str:
    text = str([x.tolist() if isinstance(x, sp.MatrixBase) else x for x in value])
    return text if len(text) <= 60 else text[:57] + "..."
