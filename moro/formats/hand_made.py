"""A ``Model`` made by hand, as what a robot is given by: checked, and in exact values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from moro.abc import t
from moro.checks import values as checks
from moro.formats.source import Source
from moro.model import (
    Body,
    Central,
    Coordinate,
    Drive,
    Joint,
    JointType,
    Model,
    Parameter,
    Placement,
    Rotation,
    Shift,
    Turn,
)
from moro.model.placement import Step
from moro.printing.tables import Table
from moro.spatial.moments import Moments
from moro.spatial.vectors import Matrix, Vector


class HandMade(Source):
    """A model as it is given. Its quantities are those of its bodies and joints.

    Raises TypeError or ValueError that names the joint, body or frame in which something is wrong.
    """

    def __init__(self, model: Model):
        if not isinstance(model, Model):
            raise TypeError(f"a robot is made of a Model, not {checks.brief(model)}")
        self._hold(*_exact(model))

    def _hold(self, model: Model, decimal: bool) -> None:
        """Hold a model in exact values that are checked."""
        super().__init__(model.name)
        self._model, self._decimal = model, decimal
        self._declared = frozenset(model.defaults)
        self._defaults = {s: x for s, x in model.defaults.items() if x is not None}

    @property
    def convention(self) -> str:
        """Convention of the rows that the model was made of; "" if of none."""
        return self._model.convention

    @property
    def types(self) -> list[JointType]:
        """The type of each coordinate."""
        return self._model.types

    @property
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""
        return self._model.qs

    @property
    def decimal(self) -> bool:
        """Whether a float was given: results are printed in decimals then."""
        return self._decimal

    @property
    def assumed(self) -> frozenset[str]:
        """Limits, where no coordinate has any."""
        limited = any(x.limits is not None for x in self._model.coordinates)
        return frozenset() if limited else frozenset({"joint_limits"})

    def given(self, name: str) -> Any:
        """Return one of ``QUANTITIES``; None if the model says that it is not set.

        What is about a centre of mass is in the frame in which the body was given so, or else in
        that of its joint.
        """
        if name == "joint_limits":
            return self._model.ranges
        if name in self._model.not_set:
            return None
        if name == "gravity":
            return sp.Matrix(self._model.gravity)
        if name in _OF_BODIES:
            return [_OF_BODIES[name](body) for body in self._model.bodies]
        return [getattr(x.drive, _OF_DRIVES[name]) for x in self._model.coordinates]

    @property
    def table(self) -> Table:
        """The joints: which hangs on which (0: the base), type, displacement."""
        rows = [
            (i, joint.parent + 1, joint.type.letter, self._model.displacement(joint))
            for i, joint in enumerate(self._model.joints, 1)
        ]
        return Table(("i", "parent", "type", "x"), rows, self.notation)

    def model(self) -> Model:
        """Return the model, with all its parameters."""
        where = {x.symbol: x.meaning for x in self._model.parameters}
        parameters = (Parameter(s, x, where.get(s, "")) for s, x in self.parameters.items())
        return replace(self._model, name=self.name, parameters=tuple(parameters))

    def how_to_set(self, name: str) -> str:
        """Say that it is the model that knows."""
        return f"{self.name} is made of a Model, whose not_set says so"

    def _headline(self) -> tuple[str, str, str]:
        kinds = "".join(joint.type.letter for joint in self._model.joints)
        parents = " ".join(str(joint.parent + 1) for joint in self._model.joints)
        return "joints", "given", f"{len(self._model.joints)}, {kinds}, on {parents}"

    def _constants(self) -> Iterator[Any]:
        placements = [joint.placement for joint in self._model.joints]
        placements += [frame.placement for frame in self._model.frames]
        for joint in self._model.joints:
            yield from (joint.offset, *(ratio for _, ratio in joint.terms))
        for x in self._model.coordinates:
            yield from x.drive.scalars
        for body in self._model.bodies:
            yield from (body.mass, *body.first_moment, *_entries(body.inertia))
            if body.central is not None:
                placements.append(body.central.frame)
                yield from (*body.central.com, *_entries(body.central.inertia))
        yield from self._model.gravity
        for step in (step for placement in placements for step in placement.steps):
            if isinstance(step, Turn):
                yield step.angle
            else:
                yield from step.p if isinstance(step, Shift) else _entries(step.R)

    def _substituted(self, values: Mapping[Any, Any]) -> HandMade:
        new = copy(self)
        new._model, with_floats = _exact(self._model, values)
        new._decimal = self._decimal or with_floats
        return new


def central(body: Body) -> Central:
    """Return a body about its centre of mass: as it was given, or h/m and J - m (c.c 1 - c c^T).

    Where mass and first moment are zero, the centre is the origin of the joint's frame.
    """
    if body.central is not None:
        return body.central
    m, h = body.mass, body.first_moment
    if m == 0:
        return Central(h, body.inertia)
    x, y, z = (sp.cancel(component / m) for component in h)
    moved = Moments.of(m, h, body.inertia).displaced((-x, -y, -z)).inertia
    a, b, c = ([sp.cancel(entry) for entry in row] for row in moved)
    return Central((x, y, z), ((a[0], a[1], a[2]), (b[0], b[1], b[2]), (c[0], c[1], c[2])))


_OF_BODIES: dict[str, Callable[[Body], Any]] = {
    "masses": lambda body: body.mass,
    "cm_positions": lambda body: sp.Matrix(central(body).com),
    "inertia_tensors": lambda body: sp.Matrix(central(body).inertia),
}
_OF_DRIVES = {
    "rotor_inertias": "rotor_inertia",
    "viscous_friction": "viscous",
    "coulomb_friction": "coulomb",
}


def _entries(rows: Sequence[Sequence[Any]]) -> Iterator[Any]:
    for row in rows:
        yield from row


def _exact(model: Model, values: Mapping[Any, Any] | None = None) -> tuple[Model, bool]:
    """Return a model in exact SymPy values, and whether a float was in it.

    ``values`` are put in for symbols.
    """
    _check_tree(model)
    read = _Reader(model.qs, values or {})
    exact = replace(
        model,
        joints=tuple(read.joint(x, i) for i, x in enumerate(model.joints, 1)),
        bodies=tuple(read.body(x, i) for i, x in enumerate(model.bodies, 1)),
        gravity=read.vector(model.gravity, "gravity"),
        coordinates=tuple(read.coordinate(x, j) for j, x in enumerate(model.coordinates, 1)),
        frames=tuple(
            replace(x, placement=read.placement(x.placement, f"frame {x.name}"))
            for x in model.frames
        ),
    )
    _check_rotors(exact)
    return exact, read.with_floats


def _check_tree(model: Model) -> None:
    n = len(model.joints)
    if not n:
        raise ValueError("a model needs at least one joint")
    if len(model.bodies) != n:
        raise ValueError(f"a model has a body for each joint: {n}, not {len(model.bodies)}")
    for i, joint in enumerate(model.joints, 1):
        if not isinstance(joint, Joint) or not isinstance(joint.type, JointType):
            raise TypeError(f"joint {i} must be a Joint of a JointType, not {checks.brief(joint)}")
        if joint.parent not in range(-1, i - 1):
            expected = "-1, the base" if i == 1 else f"-1..{i - 2}"
            raise ValueError(
                f"parent of joint {i} must be {expected}, counted from 0, not {joint.parent}"
            )
        if joint.parent >= 0 and model.joints[joint.parent].type.spins:
            raise ValueError(
                f"parent of joint {i} must carry its frame, and joint {joint.parent + 1} is a rotor"
            )
    _check_coordinates(model)
    owner: dict[Any, int] = {}
    for i, q in enumerate(model.qs, 1):
        if not (isinstance(q, sp.Symbol) and q != t) and not (
            isinstance(q, AppliedUndef) and q.args == (t,)
        ):
            raise ValueError(f"variable of joint {i} must be q1 of moro.abc, say, not {q}")
        if owner.setdefault(q, i) != i:
            raise ValueError(f"joints {owner[q]} and {i} have the same variable {q}")
    names: set[str] = set()
    for frame in model.frames:
        checks.name(frame.name, "name of a frame")
        if frame.name in names:
            raise ValueError(f"two frames are called {frame.name}")
        names.add(frame.name)
        if frame.link not in range(-1, n):
            raise ValueError(f"link of frame {frame.name} must be -1..{n - 1}, not {frame.link}")


def _check_rotors(model: Model) -> None:
    """Raise ValueError for a body that spins about an axis about which it is not symmetric."""
    for i, (joint, body) in enumerate(zip(model.joints, model.bodies, strict=True), 1):
        if not joint.type.spins:
            continue
        (x, y, _), J = body.first_moment, body.inertia
        off = {"first moment": (x, y), "inertia": (J[0][1], J[0][2], J[1][2], J[0][0] - J[1][1])}
        for what, values in off.items():
            if any(sp.expand(value) != 0 for value in values):
                raise ValueError(
                    f"body {i}{f' ({joint.name})' if joint.name else ''} must be symmetric about "
                    f"the z axis of its joint, about which it spins as a rotor; its {what} is not"
                )


def _check_coordinates(model: Model) -> None:
    moved = set[int]()
    for i, joint in enumerate(model.joints, 1):
        for j, _ in joint.terms:
            if j not in range(model.nv):
                raise ValueError(
                    f"joint {i} is moved by coordinate {j}: expected 0..{model.nv - 1}, counted "
                    "from 0"
                )
            if [k for k, _ in joint.terms].count(j) > 1:
                raise ValueError(f"joint {i} is moved twice by coordinate {j}")
            moved.add(j)
    for j, x in enumerate(model.coordinates):
        if not isinstance(x, Coordinate) or not isinstance(x.drive, Drive):
            raise TypeError(f"coordinate {j} must be a Coordinate, not {checks.brief(x)}")
        if j not in moved:
            raise ValueError(f"coordinate {j} moves no joint")


class _Reader:
    """Reads scalars as constants, with values put in for symbols."""

    def __init__(self, variables: Sequence[Any], values: Mapping[Any, Any]):
        self.with_floats = checks.has_float(tuple(values.values()))
        self._variables = variables
        self._values = values

    def scalar(self, x: Any, what: str) -> Any:
        self.with_floats = self.with_floats or checks.has_float(x)
        return checks.constant(self._put(x), what, self._variables)

    def vector(self, v: Any, what: str) -> Vector:
        x, y, z = checks.components(v, what)
        return self.scalar(x, what), self.scalar(y, what), self.scalar(z, what)

    def matrix(self, rows: Any, what: str) -> Matrix:
        x, y, z = checks.components(rows, what)
        return self.vector(x, what), self.vector(y, what), self.vector(z, what)

    def tensor(self, rows: Any, what: str) -> Matrix:
        I = self.matrix(rows, what)
        if found := checks.asymmetry(I):
            raise ValueError(f"{what} must be symmetric: {found}")
        return I

    def placement(self, placement: Placement, what: str) -> Placement:
        if placement.given:
            return Placement.by(*(self._step(step, what) for step in placement.given))
        return Placement(self.matrix(placement.R, what), self.vector(placement.p, what))

    def joint(self, joint: Joint, i: int) -> Joint:
        return replace(
            joint,
            placement=self.placement(joint.placement, f"placement of joint {i}"),
            offset=self.scalar(joint.offset, f"offset of joint {i}"),
            terms=tuple((j, self._ratio(ratio, i)) for j, ratio in joint.terms),
        )

    def coordinate(self, x: Coordinate, j: int) -> Coordinate:
        limits = x.limits and checks.limits(x.limits, f"limits of joint {j}")
        return replace(x, limits=limits, drive=self._drive(x.drive, j))

    def _drive(self, drive: Drive, j: int) -> Drive:
        of = f"of joint {j}"
        size, (forward, backward) = self._size, drive.coulomb
        static = drive.static
        if static is not None:
            break_away = f"static friction {of}"
            static = size(static[0], break_away), size(static[1], break_away)
        return Drive(
            size(drive.rotor_inertia, f"rotor inertia {of}"),
            size(drive.viscous, f"viscous friction {of}"),
            (size(forward, f"Coulomb friction {of}"), size(backward, f"Coulomb friction {of}")),
            static,
            self._divisor(drive.stribeck_velocity, f"Stribeck velocity {of}"),
            None if drive.width is None else self._divisor(drive.width, f"width of friction {of}"),
            size(drive.stiffness, f"stiffness {of}"),
            self.scalar(drive.rest, f"rest of the spring {of}"),
        )

    def _divisor(self, x: Any, what: str) -> Any:
        value = self._size(x, what)
        if value == 0:
            raise ValueError(f"{what} must not be 0")
        return value

    def _ratio(self, ratio: Any, i: int) -> Any:
        value = self.scalar(ratio, f"ratio of joint {i}")
        if value == 0:
            raise ValueError(f"ratio of joint {i} must not be 0: leave that coordinate out")
        return value

    def body(self, body: Body, i: int) -> Body:
        given = body.central
        if given is not None:
            given = Central(
                self.vector(given.com, f"centre of mass of body {i}"),
                self.tensor(given.inertia, f"central inertia of body {i}"),
                self.placement(given.frame, f"frame of body {i}"),
            )
        return replace(
            body,
            mass=self._size(body.mass, f"mass of body {i}"),
            first_moment=self.vector(body.first_moment, f"first moment of body {i}"),
            inertia=self.tensor(body.inertia, f"inertia of body {i}"),
            central=given,
        )

    def _size(self, x: Any, what: str) -> Any:
        return checks.not_negative(self.scalar(x, what), what, self._variables)

    def _step(self, step: Step, what: str) -> Step:
        if isinstance(step, Turn):
            self.with_floats = self.with_floats or checks.has_float(step.angle)
            return Turn(step.axis, checks.angle(self._put(step.angle), what))
        if isinstance(step, Shift):
            return Shift(self.vector(step.p, what))
        return Rotation(self.matrix(step.R, what))

    def _put(self, x: Any) -> Any:
        return x.xreplace(self._values) if isinstance(x, sp.Basic) else x
