"""Every symbolic quantity of the mechanics of a model."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from copy import copy
from typing import Any

import sympy as sp

from moro.abc import t
from moro.checks import values as checks
from moro.checks.callers import outside
from moro.closed_form import ClosedForm
from moro.formats.hand_made import central
from moro.formats.source import Source
from moro.identification.base_parameters import (
    BaseParameters,
    base_parameters,
    friction_coefficients,
    inertial_symbols,
)
from moro.identification.regressor import Regressor, regressor_columns
from moro.identification.standard_parameters import Standard
from moro.model import Central, Frame, Model, Placement
from moro.printing.collect import Collector
from moro.printing.display import Display
from moro.printing.matrix_form import matrix_form
from moro.printing.notation import Notation
from moro.printing.notebook import Equations
from moro.scalars.trig import Trig, TrigRing
from moro.spatial.vectors import Vector, add, product, scaled, times, transpose

_BASE = Frame("0", -1, Placement())
#: what is forgotten
_DERIVED = ("_made", "_closed_form", "_display", "_results")


class Mechanics:
    """What follows from the model that a source makes. Results are kept until ``_forget``.

    Joints and links are counted from 1, frames from 0 (the base). Frame i is the model's frame
    called i, as those of DH rows are, or else that of joint i; any other is known by its name.
    """

    def __init__(self, source: Source):
        self._source = source
        self._forget()

    def __getstate__(self) -> dict[str, Any]:
        return {k: x for k, x in self.__dict__.items() if k not in _DERIVED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Hold a source of its own; copies derive anew what they are asked for."""
        self.__dict__.update(state, _source=copy(state["_source"]))
        self._forget()

    # -- joints -----------------------------------------------------------------------------------

    @property
    def dof(self) -> int:
        """Number of joints, n."""
        return self._source.dof

    @property
    def joint_types(self) -> list[str]:
        """Type of each joint, "r" (revolute) or "p" (prismatic)."""
        return [kind.letter for kind in self._source.types]

    def joint_type(self, i: int) -> str:
        """Type of joint i: "r" (revolute) or "p" (prismatic)."""
        return self.joint_types[self._joint(i)]

    @property
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""
        return self._source.qs

    def q(self, i: int) -> Any:
        """Joint variable q_i [rad or m]."""
        return self.qs[self._joint(i)]

    def q_dot(self, i: int) -> Any:
        """Joint velocity dq_i/dt [rad/s or m/s]; 0, with a warning, if q_i is a plain symbol."""
        self._warn_if_static("q_dot", [self.q(i)])
        return self.q(i).diff(t)

    # -- frames -----------------------------------------------------------------------------------

    @property
    def Ts(self) -> list[sp.Matrix]:
        """Transforms of neighbours, frame i in frame i - 1, for i = 1..n (4 x 4).

        On a tree, in the frame of the link that joint i hangs on.
        """
        return [self.T_ij(i, joint.parent + 1) for i, joint in enumerate(self._model.joints, 1)]

    @property
    def T(self) -> sp.Matrix:
        """Forward kinematics T_n0: frame n, or the tip, expressed in frame 0 (4 x 4)."""
        return self._pose(self._model.tip, _BASE)

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

    def J_point(self, point: Any, i: int | str) -> sp.Matrix:
        """Geometric Jacobian of a point of link i, given in frame i (6 x n, linear rows first)."""
        named = isinstance(i, str) and not i.isdigit()
        frame = self._frame(i if named else self._link(i) + 1)
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
        return self._scalar(
            "L", lambda: self._total_kinetic_energy() - sum(self._form.potential_energies)
        )

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
        rows = zip(left, friction, self._taus(), strict=True)
        return Equations((sp.Eq(x + f, tau, evaluate=False) for x, f, tau in rows), self._notation)

    #: the same, by the name that says what they are
    euler_lagrange_equations = dynamic_model

    def dynamic_model_matrix_form(self) -> Any:
        """M qdd + C qd + G = tau as an ``Eq`` of unevaluated blocks, friction beside G if set."""
        self._warn_if_static("dynamic_model_matrix_form")
        qd, qdd = ([q.diff(t, k) for q in self.qs] for k in (1, 2))
        terms = [(self.inertia_matrix(), qdd), (self._coriolis_matrix(), qd)]
        rest = [self.gravity_vector()]
        if not {"viscous_friction", "coulomb_friction"} <= self._model.not_set:
            rest.append(sp.Matrix([self._friction(i) for i in range(self.dof)]))
        return matrix_form(terms, rest, self._taus())

    # -- inertial parameters ----------------------------------------------------------------------

    def base_parameters(self, zeros: bool | None = None) -> BaseParameters:
        """Return the minimal inertial parameters: those that the torques can tell apart.

        Each is a combination of the links' inertial parameters XX_1, .., MX_1, .., M_1 (tensor,
        first moments and mass about the origin of Khalil's frame: z along joint i, x along the
        common normal to joint i + 1) with lengths and twists, and has a value in the symbols of
        the model. XXR_2 is XX_2 with others that act alike. Rotor inertias (IA) and friction (FV
        viscous; FC and FD Coulomb, half the sum of both directions and half the difference) are
        parameters too, if they are set. No smaller set gives the same torques; theory and sources
        are in ``moro.identification.base_parameters``.

        Geometry and gravity decide which there are. A parameter whose value is zero is left out
        where zero is an assumption of the model (of a link given in symbols, of friction and
        rotors), and stands where it is a number among numbers, also if a payload is added to them;
        ``zeros`` True or False keeps or leaves out all of them.
        """
        self._needed("gravity")
        return self._all_base_parameters().counted(self._model, zeros)

    def regressor(self, zeros: bool | None = None) -> Regressor:
        """Return (Y, p) with M qdd + C qd + G + friction = Y(q, qd, qdd) p identically.

        Y is n x b, p the b values of ``base_parameters(zeros)``, in that order. The columns of Y
        are linearly independent.
        """
        self._warn_if_static("regressor")
        parameters = self.base_parameters(zeros)
        leaders = tuple(x.leader for x in parameters)
        columns = self._matrix(("Y", leaders), lambda: self._regressor_columns(leaders)).T
        Y = columns.reshape(self.dof, len(leaders))
        return Regressor(Y, parameters.values, self._notation)

    # -- as a whole -------------------------------------------------------------------------------

    def simplify(self, expr: Any) -> Any:
        """Return an expression (or matrix) in the joint variables in canonical, shortest form.

        Exact: two expressions that are equal as trigonometric polynomials become identical, and
        zero becomes 0. A denominator that is a polynomial of symbols cancels wherever it is a
        factor, m1/(m1 + m2) + m2/(m1 + m2) is 1; sums over different denominators that share
        symbols are not brought to a common one.
        """
        if isinstance(expr, sp.MatrixBase):
            return expr.applyfunc(self.simplify)
        return self._show(self._ring.convert(expr))

    def latex(self, expr: Any) -> str:
        r"""Return an expression, matrix or equation in LaTeX as texts do: s_{23}, \dot{q}_1."""
        return self._notation.latex(expr)

    # -- closed forms -----------------------------------------------------------------------------

    def _forget(self, results: bool = True) -> None:
        """Drop the model, and what was derived from it, if something else is given now."""
        self._made: Model | None = None
        if results:
            self._closed_form: ClosedForm | None = None
            self._display: Display | None = None
            self._results: dict[Any, Any] = {}

    @property
    def _model(self) -> Model:
        if self._made is None:
            self._made = self._source.model()
        return self._made

    @property
    def _notation(self) -> Notation:
        return self._source.notation

    @property
    def _form(self) -> ClosedForm:
        if self._closed_form is None:
            self._closed_form = ClosedForm(self._model, TrigRing())
            # one order of generators, whatever is asked for first: equal results are identical
            for symbol in (*self.qs, *self._velocities(), *self._model.defaults):
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
            self._display = Display(
                self._ring,
                inertial=inertial_symbols(self._model),
                velocities=self._velocities(),
                decimal=self._source.decimal,
            )
        return self._display

    @property
    def _collector(self) -> Collector:
        if "collector" not in self._results:
            self._results["collector"] = Collector(
                self._form, self._shown_by, self._notation, self._model.defaults
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

    def _in_ring(self, v: Sequence[Any]) -> Vector:
        x, y, z = map(self._ring.convert, v)
        return x, y, z

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
        rates, axes = self._rates(), self._form.geometry.axes
        omega: Vector = (self._ring.zero,) * 3
        for k in joints:
            _, angular = self._model.joints[k].type.column(axes[k], axes[k])
            omega = add(omega, scaled(rates[k], angular))
        return [[x] for x in omega]

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
            rates, _ = self._motion
            self._results["base parameters"] = base_parameters(
                self._model, self._ring, rates, self._shown_by
            )
        found: BaseParameters = self._results["base parameters"]
        return found

    def _regressor_columns(self, leaders: Sequence[Standard]) -> list[list[Trig]]:
        columns = regressor_columns(leaders, self._model, self._ring, *self._motion)
        return [self._at_rest(column) for column in columns]

    def _friction(self, i: int) -> Any:
        qd = self.qs[i].diff(t)
        speed = {"FV": qd, "FC": sp.sign(qd), "FD": sp.sign(qd) ** 2}
        found = friction_coefficients(self._model, i)
        terms = (x * speed[name] for name, x in found.items())
        return sum(terms, sp.Integer(0))

    def _taus(self) -> list[Any]:
        return [sp.Symbol(f"tau_{i}") for i in range(1, self.dof + 1)]

    # -- what was asked for -----------------------------------------------------------------------

    def _needed(self, *names: str) -> None:
        """Raise ValueError that says how to set one of these quantities that is missing."""
        for name in names:
            if name in self._model.not_set:
                raise ValueError(f"{name} not set: {self._source.how_to_set(name)}")

    def _warn_if_static(self, method: str, variables: Sequence[Any] | None = None) -> None:
        static = [q for q in variables or self.qs if q.is_Symbol]
        if static:
            names = ", ".join(map(str, static))
            warnings.warn(
                f"{method}: velocities are zero, for {names} is no function of time; use q1 of "
                "moro.abc, or sympy.Function('q1')(t), as joint variable",
                UserWarning,
                stacklevel=outside(),
            )

    def _joint(self, i: int) -> int:
        return checks.index(i, 1, self.dof, "joint") - 1

    def _link(self, i: Any) -> int:
        return checks.index(i, 1, self.dof, "link") - 1

    def _frame(self, i: int | str) -> Frame:
        named = {frame.name: frame for frame in self._model.frames}
        if not isinstance(i, str) or i.isdigit():  # numbers are no names
            i = checks.index(i, 0, self.dof, "frame")
            joints = Frame(str(i), i - 1, Placement())
            return named.get(str(i), joints) if i else _BASE
        if i not in named:
            near = checks.suggestion(i, named)
            raise ValueError(f"no frame is called {i}; frames are {', '.join(named) or 0}{near}")
        return named[i]
