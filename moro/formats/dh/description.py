"""A robot arm given by rows of DH parameters: masses, inertias, friction, limits, all checked."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

import sympy as sp

from moro.checks import given
from moro.checks import values as checks
from moro.checks.callers import outside
from moro.checks.meant import meant
from moro.checks.plausibility import LinkData, Remark, is_unremarked, remarks, unremarked
from moro.formats.dh.arm import Arm
from moro.formats.dh.rows import given_rows, read_convention, read_rows
from moro.formats.dh.to_model import model_from_dh
from moro.formats.source import QUANTITIES, Source
from moro.model import JointType, Model
from moro.printing.tables import Table


class Description(Source):
    """The data of an arm, checked as they are set; they come back as they were given."""

    def __init__(
        self,
        *rows: Any,
        convention: Literal["dh", "mdh"] = "dh",
        name: str = "robot",
        **others: Any,
    ):
        if others:
            raise TypeError(_not_taken(next(iter(others))))
        super().__init__(name)
        self._convention = read_convention(convention)
        self._rows_as_given = given_rows(rows)
        self._rows = read_rows(self._rows_as_given)
        #: what was set, as it was given; the fields below hold it in exact values
        self._as_set: dict[str, Any] = {}
        #: of links and of joints, if any
        self._names: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())
        self._remarked: dict[Remark, None] = {}
        self._masses: tuple[Any, ...] | None = None
        self._cm_positions: tuple[tuple[Any, ...], ...] | None = None
        self._inertia_tensors: tuple[tuple[tuple[Any, ...], ...], ...] | None = None
        self._gravity: tuple[Any, ...] | None = None
        self._rotor_inertias: tuple[Any, ...] | None = None
        self._rotors: tuple[tuple[Any, Any] | None, ...] | None = None
        self._viscous_friction: tuple[Any, ...] | None = None
        self._coulomb_friction: tuple[tuple[Any, Any], ...] | None = None
        self._joint_limits: tuple[tuple[Any, Any] | None, ...] | None = None
        #: quantities that are symbols of moro's own, and those in which a float was given
        self._assumed: frozenset[str] = frozenset()
        self._with_floats: frozenset[str] = frozenset()
        if checks.has_float(self._rows_as_given):
            self._with_floats |= {"rows"}
        self._remark()

    @classmethod
    def of(cls, arm: Arm, name: str, defaults: Mapping[Any, Any]) -> Description:
        """Return what a reader has checked, whose remarks are its own: exact values throughout.

        ``defaults`` are those of parameters that it declares.
        """
        rows = [(row.a, row.alpha, *row.moved, row.type.letter) for row in arm.rows]
        with unremarked():
            new = cls(*rows, convention=read_convention(arm.convention), name=name)
            for name in QUANTITIES:
                if (values := getattr(arm, name)) is not None:
                    new._set(name, values, values)
        new._names = arm.link_names, arm.joint_names
        new.declare(defaults)
        return new

    @property
    def convention(self) -> str:
        """Convention of the rows: "dh" (standard) or "mdh" (modified)."""
        return self._convention

    @property
    def types(self) -> list[JointType]:
        """The type of each joint variable: of the first joint that it moves."""
        return [self._rows[i].type for i in Arm(self._rows, "").variables.values()]

    @property
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""
        return [*Arm(self._rows, "").variables]

    @property
    def decimal(self) -> bool:
        """Whether a float was given: results are printed in decimals then."""
        return bool(self._with_floats)

    @property
    def assumed(self) -> frozenset[str]:
        """Those of ``QUANTITIES`` that stand for what was not given."""
        return self._assumed | ({"joint_limits"} if self._joint_limits is None else set())

    @property
    def dh_parameters(self) -> list[tuple[Any, ...]]:
        """The rows as they were given, (a, alpha, d, theta); ``joint_types`` has their types."""
        return [tuple(map(sp.sympify, given[:4])) for given in self._rows_as_given]

    @property
    def dh_table(self) -> Table:
        """The rows and types as a table that prints in text, LaTeX and Jupyter."""
        headings = ("i", "a", "alpha", "d", "theta", "type")
        joints = zip(self.dh_parameters, self._rows, strict=True)
        rows = [(i, *given, row.type.letter) for i, (given, row) in enumerate(joints, 1)]
        return Table(headings, rows, self.notation)

    table = dh_table

    @property
    def joint_limits(self) -> list[tuple[Any, Any]]:
        """(lower, upper) of each joint [rad or m]; -pi..pi and 0..1000 are assumed without.

        Set None instead of all pairs, or of one, where there are none.
        """
        assumed = [kind.assumed_limits for kind in self.types]
        limits = self._as_set.get("joint_limits") or [None] * self.dof
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
            self._assume("masses", tuple(sp.Symbol(f"m_{i}") for i in self._numbers))
            return
        values = checks.scalars(values, self._count, "masses")
        new = tuple(
            checks.not_negative(m, f"m_{i} of masses", self.qs) for i, m in enumerate(values, 1)
        )
        self._set("masses", new, given.scalars(values))

    @property
    def cm_positions(self) -> list[sp.Matrix] | None:
        """Centres of mass r_Ci, in frame i [m]; None if not set."""
        return self._as_given("cm_positions", sp.Matrix)

    @cm_positions.setter
    def cm_positions(self, values: Any) -> None:
        if values is None:
            raise ValueError("cm_positions are never assumed: give one [x, y, z] for each link")
        values = checks.groups(values, self._count, "cm_positions")
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
            self._assume("inertia_tensors", tuple(_diagonal(i) for i in self._numbers))
            return
        values = checks.groups(values, self._count, "inertia_tensors")
        new = tuple(
            checks.tensor(I, f"inertia tensor of link {i}", self.qs)
            for i, I in enumerate(values, 1)
        )
        self._set("inertia_tensors", new, tuple(given.tensor(I) for I in values))

    @property
    def gravity(self) -> sp.Matrix | None:
        """Gravitational acceleration, in frame 0 [m/s^2]; None if not set."""
        return None if self._gravity is None else sp.Matrix(self._as_set["gravity"])

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
    def rotors(self) -> list[tuple[Any, Any] | None] | None:
        """Rotors that couple: (inertia about its axis [kg m^2], turns for one of the joint) each.

        The rotor of joint i's motor is on link i - 1 and spins about the axis of the joint, beside
        the turning of link i - 1. None: of a joint without one, and for none at all. Masses and
        other moments of motors are those of the links that carry them. ``rotor_inertias`` are the
        approximation by the diagonal: set one or the other.
        """
        return self._as_given("rotors")

    @rotors.setter
    def rotors(self, values: Any) -> None:
        if values is None:
            self._set("rotors", None, None)
            return
        items = checks.groups(values, self._count, "rotors")
        new = []
        for i, item in enumerate(items, 1):
            what = f"rotors of joint {i}"
            pair = None if item is None else checks.sequence(item, what)
            if pair is not None and len(pair) != 2:
                raise ValueError(f"{what} must be (inertia, ratio), not {checks.brief(item)}")
            new.append(
                pair
                and (
                    checks.not_negative(pair[0], f"inertia in {what}", self.qs),
                    checks.not_zero(pair[1], f"ratio in {what}"),
                )
            )
        self._set("rotors", tuple(new), tuple(x if x is None else tuple(x) for x in items))

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

    def model(self) -> Model:
        """Return the arm as all algorithms read it (``moro.model``)."""
        return model_from_dh(self.name, self.arm, self.parameters)

    @property
    def arm(self) -> Arm:
        """The arm's data as ``moro.formats.dh.to_model`` reads it."""
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
            *self._names,
            self._rotors,
        )

    def given(self, name: str) -> Any:
        """Return one of ``QUANTITIES`` as it was given; None if it is not set."""
        return getattr(self, name)

    def how_to_set(self, name: str) -> str:
        """Say how one of ``QUANTITIES`` is set."""
        return QUANTITIES[name]

    def summary(self) -> Table:
        """Return what is given, rotors that couple where there are, and what is not set."""
        table = super().summary()
        if self._rotors is None:
            return table
        return Table(table.headings, [*table, ("rotors", "given", self._brief(self.rotors))])

    def _headline(self) -> tuple[str, str, str]:
        kinds = "".join(row.type.letter for row in self._rows)
        return "rows", "given", f"{self._count}, {self._convention}, {kinds}"

    @property
    def _count(self) -> int:
        """Number of links; joint variables may be fewer."""
        return len(self._rows)

    @property
    def _numbers(self) -> range:
        return range(1, self._count + 1)

    # -- state -------------------------------------------------------------------------------------

    def _set(self, name: str, new: Any, given: Any) -> None:
        """Set a quantity, in exact values and as it was given."""
        setattr(self, f"_{name}", new)
        self._as_set = {**self._as_set, name: given}
        self._assumed -= {name}
        self._with_floats -= {name}
        if name != "joint_limits" and checks.has_float(given):  # no result depends on limits
            self._with_floats |= {name}
        self._remark()

    def _assume(self, name: str, symbols: Any) -> None:
        self._set(name, symbols, symbols)
        self._assumed |= {name}

    def _as_given(self, name: str, form: Callable[[Any], Any] = lambda x: x) -> list[Any] | None:
        values = self._as_set.get(name)
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
        nothing = (None,) * self._count
        limits = dict(zip(self.qs, self._joint_limits or (), strict=False))
        columns = (
            self._rows,
            self._masses or nothing,
            self._cm_positions or nothing,
            self._inertia_tensors or nothing,
            [limits.get(row.terms[0][0]) if row.terms[0][1] == 1 else None for row in self._rows],
        )
        return [
            LinkData(row.type.is_angle, row.a, row.alpha, row.d, row.theta, *rest)
            for row, *rest in zip(*columns, strict=True)
        ]

    def _constants(self) -> Iterable[Any]:
        for row in self._rows:
            yield from (row.a, row.alpha, row.d, row.theta, *(ratio for _, ratio in row.terms))
        yield from self._masses or ()
        for vector in self._cm_positions or ():
            yield from vector
        for tensor in self._inertia_tensors or ():
            for line in tensor:
                yield from line
        yield from self._gravity or ()
        yield from self._rotor_inertias or ()
        for rotor in self._rotors or ():
            yield from rotor or ()
        yield from self._viscous_friction or ()
        for pair in self._coulomb_friction or ():
            yield from pair

    def _substituted(self, values: Mapping[Any, Any]) -> Description:
        def put(x: Any) -> Any:
            if isinstance(x, tuple):
                return type(x)(put(item) for item in x)
            return x.xreplace(values) if isinstance(x, sp.Basic) else x

        with unremarked():
            rows = [
                (*map(put, given), row.type.letter)
                for given, row in zip(self.dh_parameters, self._rows, strict=True)
            ]
            new = Description(*rows, convention=self._convention, name=self.name)
            for name, value in self._as_set.items():
                if value is not None:
                    setattr(new, name, put(value))
        new._names = self._names
        new._remarked = self._remarked
        new._remark()
        new._assumed = self._assumed
        new._with_floats |= self._with_floats
        return new


#: where a remark is about, in the words of this class
_PLACES = {
    **{name: f"{name} of row {{link}}" for name in ("a", "alpha", "d", "theta")},
    "mass": "masses",
    "com": "cm_positions of link {link}",
    "inertia": "inertia tensor of link {link}",
    "limits": "limits of joint {link}",
    "gravity": "gravity",
}


def _not_taken(name: str) -> str:
    """Say what to do with a keyword that ``Robot`` does not take."""
    found = meant(name, QUANTITIES)
    hint = f"; set it afterwards: {QUANTITIES[found].removeprefix('none; ')}" if found else ""
    return f"Robot takes rows, convention= and name=, not {name}={hint}"


def _place(remark: Remark) -> str:
    number = 0 if remark.link is None else remark.link + 1
    return _PLACES[remark.field].format(link=number)


def _diagonal(i: int) -> tuple[tuple[Any, ...], ...]:
    symbols = [sp.Symbol(f"I_{{{x}_{i}{x}_{i}}}") for x in "xyz"]
    zero = sp.Integer(0)
    return tuple(tuple(symbols[j] if j == k else zero for k in range(3)) for j in range(3))
