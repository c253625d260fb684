"""What is given of a robot arm: rows, masses, inertias, gravity, friction, limits, parameters."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeVar

import sympy as sp

from moro import checks, given
from moro.abc import t
from moro.arm import Arm
from moro.callers import outside
from moro.from_dh import model_from_dh
from moro.meant import elsewhere, meant
from moro.model import Model
from moro.notation import Notation
from moro.plain import natural, prefers_decimals
from moro.plausibility import LinkData, Remark, is_unremarked, remarks, unremarked
from moro.rows import given_rows, read_convention, read_rows
from moro.tables import Table

_Self = TypeVar("_Self", bound="Description")


class Description:
    """The data of an arm, checked as they are set. ``Robot`` says what follows from them."""

    def __init__(
        self,
        *rows: Any,
        convention: Literal["dh", "mdh"] = "dh",
        name: str = "robot",
        **others: Any,
    ):
        if others:
            raise TypeError(_not_taken(next(iter(others))))
        self.name = name
        self._convention = read_convention(convention)
        self._rows_as_given = given_rows(rows)
        self._rows = read_rows(self._rows_as_given)
        #: what was set, as it was given; the fields below hold it in exact values
        self._given: dict[str, Any] = {}
        self._remarked: dict[Remark, None] = {}
        self._masses: tuple[Any, ...] | None = None
        self._cm_positions: tuple[tuple[Any, ...], ...] | None = None
        self._inertia_tensors: tuple[tuple[tuple[Any, ...], ...], ...] | None = None
        self._gravity: tuple[Any, ...] | None = None
        self._rotor_inertias: tuple[Any, ...] | None = None
        self._viscous_friction: tuple[Any, ...] | None = None
        self._coulomb_friction: tuple[tuple[Any, Any], ...] | None = None
        self._joint_limits: tuple[tuple[Any, Any] | None, ...] | None = None
        self._defaults: dict[Any, Any] = {}
        self._declared: set[Any] = set()
        self._assumed: set[str] = set()
        self._with_floats: set[str] = set()
        if checks.has_float(self._rows_as_given):
            self._with_floats.add("rows")
        self._forget()
        self._remark()

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
        return [row.type.letter for row in self._rows]

    def joint_type(self, i: int) -> str:
        """Type of joint i: "r" (revolute) or "p" (prismatic)."""
        return self._rows[self._joint(i)].type.letter

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
        """The rows as they were given, (a, alpha, d, theta); ``joint_types`` has their types."""
        return [tuple(map(sp.sympify, given[:4])) for given in self._rows_as_given]

    @property
    def dh_table(self) -> Table:
        """The rows and types as a table that prints in text, LaTeX and Jupyter."""
        headings = ("i", "a", "alpha", "d", "theta", "type")
        joints = zip(self.dh_parameters, self.joint_types, strict=True)
        rows = [(i, *row, kind) for i, (row, kind) in enumerate(joints, 1)]
        return Table(headings, rows, self._notation)

    @property
    def joint_limits(self) -> list[tuple[Any, Any]]:
        """(lower, upper) of each joint [rad or m]; -pi..pi and 0..1000 are assumed without.

        Set None instead of all pairs, or of one, where there are none.
        """
        assumed = [row.type.assumed_limits for row in self._rows]
        limits = self._given.get("joint_limits") or [None] * self.dof
        return [own or other for own, other in zip(limits, assumed, strict=True)]

    @joint_limits.setter
    def joint_limits(self, limits: Any) -> None:
        if limits is None:
            self._set("joint_limits", None, None)
            return
        limits = checks.groups(limits, self.dof, "joint_limits", of="joint")
        new = tuple(
            None if pair is None else checks.limits(pair, f"limits of joint {i}")
            for i, pair in enumerate(limits, 1)
        )
        self._set("joint_limits", new, given.pairs(limits, checks.sequence))

    @property
    def masses(self) -> list[Any] | None:
        """m_1..m_n [kg]; None if not set. Setting None makes them the symbols m_1..m_n."""
        return self._as_given("masses")

    @masses.setter
    def masses(self, values: Any) -> None:
        if values is None:
            self._assume("masses", tuple(sp.Symbol(f"m_{i}") for i in range(1, self.dof + 1)))
            return
        values = checks.scalars(values, self.dof, "masses")
        new = tuple(
            checks.not_negative(m, f"m_{i} of masses", self.qs) for i, m in enumerate(values, 1)
        )
        self._set("masses", new, given.scalars(values))

    def m(self, i: int) -> Any:
        """Mass m_i of link i [kg]."""
        self._needed("masses")
        return self._given["masses"][self._link(i)]

    @property
    def cm_positions(self) -> list[sp.Matrix] | None:
        """Centres of mass r_Ci, in frame i [m]; None if not set."""
        return self._as_given("cm_positions", sp.Matrix)

    @cm_positions.setter
    def cm_positions(self, values: Any) -> None:
        if values is None:
            raise ValueError("cm_positions are never assumed: give one [x, y, z] for each link")
        values = checks.groups(values, self.dof, "cm_positions")
        new = tuple(
            checks.vector(r, f"cm_positions of link {i}", self.qs) for i, r in enumerate(values, 1)
        )
        self._set("cm_positions", new, given.vectors(values))

    @property
    def inertia_tensors(self) -> list[sp.Matrix] | None:
        """Inertia tensors I_Ci about the centres of mass, in axes of frame i [kg m^2].

        None if not set. Setting None makes them diagonal, diag(I_{x_ix_i}, I_{y_iy_i}, I_{z_iz_i}).
        """
        return self._as_given("inertia_tensors", sp.Matrix)

    @inertia_tensors.setter
    def inertia_tensors(self, values: Any) -> None:
        if values is None:
            self._assume("inertia_tensors", tuple(_diagonal(i) for i in range(1, self.dof + 1)))
            return
        values = checks.groups(values, self.dof, "inertia_tensors")
        new = tuple(
            checks.tensor(I, f"inertia tensor of link {i}", self.qs)
            for i, I in enumerate(values, 1)
        )
        self._set("inertia_tensors", new, tuple(given.tensor(I) for I in values))

    def I_cm(self, i: int) -> sp.Matrix:
        """Inertia tensor I_Ci of link i about its centre of mass, in axes of frame i [kg m^2]."""
        self._needed("inertia_tensors")
        return sp.Matrix(self._given["inertia_tensors"][self._link(i)])

    @property
    def gravity(self) -> sp.Matrix | None:
        """Gravitational acceleration, in frame 0 [m/s^2]; None if not set."""
        return None if self._gravity is None else sp.Matrix(self._given["gravity"])

    @gravity.setter
    def gravity(self, value: Any) -> None:
        if value is None:
            raise ValueError("gravity is never assumed: give [x, y, z] in frame 0, [0, 0, -g] say")
        components = checks.components(value, "gravity")
        new = checks.vector(components, "gravity", self.qs)
        self._set("gravity", new, given.scalars(components))

    @property
    def rotor_inertias(self) -> list[Any] | None:
        """Rotor inertias, link side, on M's diagonal [kg m^2 or kg]; None means none."""
        return self._as_given("rotor_inertias")

    @rotor_inertias.setter
    def rotor_inertias(self, values: Any) -> None:
        self._set_joint_constants("rotor_inertias", values)

    @property
    def viscous_friction(self) -> list[Any] | None:
        """Viscous friction coefficients [N m s/rad or N s/m]; None means none."""
        return self._as_given("viscous_friction")

    @viscous_friction.setter
    def viscous_friction(self, values: Any) -> None:
        self._set_joint_constants("viscous_friction", values)

    @property
    def coulomb_friction(self) -> list[tuple[Any, Any]] | None:
        """Coulomb friction for (qd > 0, qd < 0), as magnitudes [N m or N]; None means none."""
        return self._as_given("coulomb_friction")

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
        self._set("coulomb_friction", new, given.pairs(values, checks.directions))

    @property
    def parameters(self) -> dict[Any, Any]:
        """The symbols left free in the model, with their default values (None: no default).

        Kernels take those that they need at run time, in this order. Set a dictionary of symbols,
        or their names, to give defaults; ValueError for one that the model does not hold. What a
        ``moro_codegen.Function`` has besides, it brings itself.
        """
        free = set().union(*(x.free_symbols for x in self._constants())) - {t, *self.qs}
        free |= self._declared
        checks.distinct_names(free)
        ordered = [s for s in self._defaults if s in free]
        ordered += sorted(free - set(ordered), key=lambda s: natural(s.name))
        return {s: self._defaults.get(s) for s in ordered}

    @parameters.setter
    def parameters(self, defaults: Mapping[Any, Any]) -> None:
        for key, _ in _items(defaults, "parameters"):
            _symbol(key)  # is one, or a name
        self._defaults = {
            symbol: None if value is None else checks.number(value, f"default of {symbol}")
            for symbol, value in self._by_symbol(defaults, "parameters").items()
        }

    def declare(self, defaults: Mapping[Any, Any]) -> None:
        """Add parameters, with their defaults, that the model need not hold.

        Functions of one's own may use them; kernels that do not, do not ask for them. Those that a
        robot.yaml declares are among them.
        """
        new = {
            _symbol(key): None if value is None else checks.number(value, f"default of {key}")
            for key, value in _items(defaults, "parameters")
        }
        self._defaults = {**self._defaults, **new}
        self._declared |= set(new)
        self._forget()

    def with_parameters(self: _Self, values: Mapping[Any, Any]) -> _Self:
        """Return a new robot in which symbols have been given values.

        ``values`` maps symbols, or their names, to numbers or expressions. ValueError for a symbol
        that the model does not hold.
        """
        new = self._by_symbol(values, "values")
        for symbol, value in new.items():
            checks.constant(value, f"value of {symbol}", self.qs)
        return self._substituted({symbol: sp.sympify(value) for symbol, value in new.items()})

    def _by_symbol(self, values: Any, what: str) -> dict[Any, Any]:
        """Return {symbol: value} for symbols of the model, or their names.

        Raises ValueError, with the nearest symbol, for one that it does not hold.
        """
        known = {str(s): s for s in self.parameters}
        found: dict[Any, Any] = {}
        for key, value in _items(values, what):
            symbol = known.get(str(key))
            if symbol is None:
                names = ", ".join(known) or "none"
                near = checks.suggestion(str(key), known)
                raise ValueError(
                    f"{key} is not a symbol of the model; its symbols are {names}{near}"
                )
            if symbol in found:
                raise ValueError(f"{key} is given two values")
            found[symbol] = value
        return found

    def model_summary(self) -> Table:
        """Return what is given, what was assumed by default, and what is not set."""
        rows = [("rows", "given", f"{self.dof}, {self._convention}, {''.join(self.joint_types)}")]
        for name, use in _QUANTITIES.items():
            value = getattr(self, f"_{name}")
            if value is not None:
                state = "assumed" if name in self._assumed else "given"
                rows.append((name, state, _brief(getattr(self, name))))
            elif name == "joint_limits":
                rows.append((name, "assumed", _brief(self.joint_limits)))
            else:
                rows.append((name, "not set", use))
        return Table(("quantity", "state", "value"), rows)

    def model(self) -> Model:
        """Return the arm as all algorithms read it (``moro.model``)."""
        return model_from_dh(self.name, self.arm, self.parameters)

    @property
    def arm(self) -> Arm:
        """The arm's data as ``moro.from_dh`` reads it."""
        return Arm(
            self._rows,
            self._convention,
            self._masses,
            self._cm_positions,
            self._inertia_tensors,
            self._gravity,
            self._rotor_inertias,
            self._viscous_friction,
            self._coulomb_friction,
            self._joint_limits,
        )

    def __repr__(self) -> str:
        kinds = "".join(self.joint_types).upper()
        return f"<Robot {self.name}: {self.dof} joints {kinds}, convention {self._convention}>"

    def _repr_latex_(self) -> str:
        return self.dh_table._repr_latex_()

    def _repr_html_(self) -> str:
        return self.dh_table._repr_html_()

    # -- state -------------------------------------------------------------------------------------

    def _forget(self) -> None:
        """Drop what was derived from older values: called whenever one is set."""

    @property
    def _notation(self) -> Notation:
        decimals = prefers_decimals(self._constants())
        return Notation(self.qs, self.parameters, decimals=decimals)

    def _set(self, name: str, new: Any, given: Any) -> None:
        """Set a quantity, in exact values and as it was given."""
        setattr(self, f"_{name}", new)
        self._given[name] = given
        self._assumed.discard(name)
        self._with_floats.discard(name)
        if name != "joint_limits" and checks.has_float(given):  # no result depends on limits
            self._with_floats.add(name)
        self._forget()
        self._remark()

    def _assume(self, name: str, symbols: Any) -> None:
        self._set(name, symbols, symbols)
        self._assumed.add(name)

    def _as_given(self, name: str, form: Callable[[Any], Any] = lambda x: x) -> list[Any] | None:
        values = self._given.get(name)
        return None if values is None else [form(x) for x in values]

    def _set_joint_constants(self, name: str, values: Any) -> None:
        if values is None:
            self._set(name, None, None)
            return
        values = checks.scalars(values, self.dof, name, of="joint")
        new = tuple(
            checks.not_negative(x, f"{name} of joint {i}", self.qs) for i, x in enumerate(values, 1)
        )
        self._set(name, new, given.scalars(values))

    def _remark(self) -> None:
        """Warn of what is probably not meant, when it comes up."""
        found = dict.fromkeys(remarks(self._link_data(), self._gravity))
        for remark in found:
            if remark not in self._remarked and not is_unremarked():
                text = f"{_place(remark)}: {remark.message}"
                warnings.warn(text, UserWarning, stacklevel=outside())
        self._remarked = found

    def _link_data(self) -> list[LinkData]:
        nothing = (None,) * self.dof
        columns = (
            self._rows,
            self._masses or nothing,
            self._cm_positions or nothing,
            self._inertia_tensors or nothing,
            self._joint_limits or nothing,
        )
        return [
            LinkData(row.type.is_angle, row.a, row.alpha, row.d, row.theta, *rest)
            for row, *rest in zip(*columns, strict=True)
        ]

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

    def _substituted(self: _Self, values: Mapping[Any, Any]) -> _Self:
        def put(x: Any) -> Any:
            if isinstance(x, tuple):
                return type(x)(put(item) for item in x)
            return x.xreplace(values) if isinstance(x, sp.Basic) else x

        with unremarked():
            rows = [
                (*map(put, row[:4]), kind)
                for row, kind in zip(self.dh_parameters, self.joint_types, strict=True)
            ]
            robot = type(self)(*rows, convention=self._convention, name=self.name)
            for name, value in self._given.items():
                if value is not None:
                    setattr(robot, name, put(value))
        robot._remarked = self._remarked
        robot._remark()
        robot._assumed = set(self._assumed)
        robot._defaults = {s: x for s, x in self._defaults.items() if s not in values}
        robot._declared = self._declared - set(values)
        robot._with_floats |= self._with_floats
        return robot

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            there = (x for x in dir(type(self)) if not x.startswith("_"))
            advice = elsewhere(name)
            near = f"; {advice}" if advice else checks.suggestion(name, there)
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


#: where a remark is about, in the words of this class
_PLACES = {
    **{name: f"{name} of row {{link}}" for name in ("a", "alpha", "d", "theta")},
    "mass": "masses",
    "com": "cm_positions of link {link}",
    "inertia": "inertia tensor of link {link}",
    "limits": "limits of joint {link}",
    "gravity": "gravity",
}

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


def _not_taken(name: str) -> str:
    """Say what to do with a keyword that ``Robot`` does not take."""
    found = meant(name, _QUANTITIES)
    hint = f"; set it afterwards: {_QUANTITIES[found].removeprefix('none; ')}" if found else ""
    return f"Robot takes rows, convention= and name=, not {name}={hint}"


def _place(remark: Remark) -> str:
    number = 0 if remark.link is None else remark.link + 1
    return _PLACES[remark.field].format(link=number)


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


def _symbol(key: Any) -> Any:
    if not isinstance(key, (str, sp.Symbol)):
        raise TypeError(f"a parameter must be a symbol or its name, not {checks.brief(key)}")
    return sp.Symbol(key) if isinstance(key, str) else key


def _brief(value: Any) -> str:
    text = str([_listed(x) for x in value])
    return text if len(text) <= 60 else text[:57] + "..."


def _listed(x: Any) -> Any:
    if not isinstance(x, sp.MatrixBase):
        return x
    return list(x) if x.cols == 1 else x.tolist()
