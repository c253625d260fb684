"""Links and joints of a file, validated, in exact SymPy values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from moro.checks.plausibility import unphysical
from moro.formats.errors import nearest
from moro.formats.urdf.reading import Reading, short
from moro.formats.xml import Element
from moro.model import PRISMATIC, REVOLUTE, Drive, JointType
from moro.spatial.vectors import Matrix, Vector

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
_X: Vector = (_ONE, _ZERO, _ZERO)
_NOWHERE: Vector = (_ZERO, _ZERO, _ZERO)
_FREE = Drive()
#: the square of a radius of gyration that is none, a micrometre [m^2]
_SPECK = sp.Rational("1e-12")

#: the types of joints that move by one coordinate
MOTIONS: dict[str, JointType] = {
    "revolute": REVOLUTE,
    "continuous": REVOLUTE,
    "prismatic": PRISMATIC,
}
_TYPES = (*MOTIONS, "planar", "fixed")
_FLOATING = (
    "a floating base is a matter of its own, yet to come: make the joint fixed, where the robot"
    " stands, or load what is on its child with root="
)

_OF_ROBOT = ("link", "joint")
_OF_LINK = ("inertial",)
_OF_INERTIAL = ("origin", "mass", "inertia")
_OF_JOINT = ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic")
#: known, passed over, and near to what is read
_OTHERS = ("collision", "visual", "calibration", "material", "transmission", "safety_controller")
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True)
class Origin:
    """A placement: a shift, and angles of roll, pitch and yaw."""

    xyz: Vector = _NOWHERE
    rpy: Vector = _NOWHERE


@dataclass(frozen=True)
class Inertial:
    """A body about its centre of mass, in a frame at this."""

    mass: Any
    inertia: Matrix
    origin: Origin


@dataclass(frozen=True)
class Link:
    """A link as the file has it."""

    name: str
    line: int
    inertial: Inertial | None


@dataclass(frozen=True)
class Mimic:
    """x = multiplier x of the other joint + offset."""

    joint: str
    multiplier: Any
    offset: Any
    line: int


@dataclass(frozen=True)
class Joint:
    """A joint as the file has it."""

    name: str
    line: int
    type: str
    parent: str
    child: str
    origin: Origin = Origin()
    #: its direction, of any length
    axis: Vector = _X
    limits: tuple[Any, Any] | None = None
    drive: Drive = _FREE
    mimic: Mimic | None = None


def links_of(robot: Element, reading: Reading) -> list[Link]:
    """Return the links of a file that have names."""
    reading.passes_over(robot, "", _OF_ROBOT, _OTHERS)
    return [
        Link(name, element.line, _inertial(element, f"link {name}", reading))
        for element in robot.all("link")
        if (name := reading.text(element, "name", ""))
    ]


def joints_of(robot: Element, reading: Reading) -> list[Joint]:
    """Return the joints of a file of which it is known what they connect, and how."""
    joints = (
        _joint(element, name, reading)
        for element in robot.all("joint")
        if (name := reading.text(element, "name", ""))
    )
    return [joint for joint in joints if joint is not None]


# -- links ----------------------------------------------------------------------------------------


def _inertial(link: Element, of: str, reading: Reading) -> Inertial | None:
    reading.passes_over(link, of, _OF_LINK, _OTHERS)
    element = reading.only(link, "inertial", of)
    if element is None:
        return None
    reading.passes_over(element, of, _OF_INERTIAL)
    origin = _origin(element, of, reading)
    mass = _mass(element, of, reading)
    inertia = _inertia(element, of, reading, (mass or _ZERO) * _SPECK)
    if mass is None or inertia is None:
        return None
    return Inertial(mass, inertia, origin)


def _mass(inertial: Element, of: str, reading: Reading) -> Any | None:
    element = reading.needed(inertial, "mass", of)
    return None if element is None else reading.number(element, "value", of, least=_ZERO)


def _inertia(inertial: Element, of: str, reading: Reading, none: Any) -> Matrix | None:
    """Return the tensor; moments up to ``none`` may be negative, as CAD programs round zeros."""
    element = reading.needed(inertial, "inertia", of)
    if element is None:
        return None
    entries: list[Any] = []
    for key in _TENSOR:
        least = -none if key[1] == key[2] else None
        entries.append(reading.number(element, key, of, least=least))
    if any(x is None for x in entries):
        return None
    xx, xy, xz, yy, yz, zz = reading.entries(entries)
    I: Matrix = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    if max(map(abs, entries)) > none and (found := unphysical(I)):
        reading.remark(element, "", of, found)
    return I


# -- joints ---------------------------------------------------------------------------------------


def _joint(element: Element, name: str, reading: Reading) -> Joint | None:
    of = f"joint {name}"
    reading.passes_over(element, of, _OF_JOINT, _OTHERS)
    kind = _type(element, of, reading)
    parent, child = (_end(element, tag, of, reading) for tag in ("parent", "child"))
    origin = _origin(element, of, reading)
    if kind is None or parent is None or child is None:
        return None
    if kind == "fixed":
        return Joint(name, element.line, kind, parent, child, origin)
    axis = _axis(element, of, reading) or _X
    limits = None if kind in ("continuous", "planar") else _limits(element, of, reading)
    drive, mimic = _drive(element, of, reading), _mimic(element, of, reading)
    return Joint(name, element.line, kind, parent, child, origin, axis, limits, drive, mimic)


def _type(element: Element, of: str, reading: Reading) -> str | None:
    kind = reading.text(element, "type", of)
    if kind is None or kind in _TYPES:
        return kind
    known = f"no type `{kind[:40]}`{nearest(kind, _TYPES)} (there are {', '.join(_TYPES)})"
    reading.problem(element, "type", of, _FLOATING if kind == "floating" else known)
    return None


def _end(element: Element, tag: str, of: str, reading: Reading) -> str | None:
    end = reading.needed(element, tag, of)
    return None if end is None else reading.text(end, "link", of)


def _axis(joint: Element, of: str, reading: Reading) -> Vector | None:
    element = reading.only(joint, "axis", of)
    return _X if element is None else reading.direction(element, "xyz", of)


def _limits(joint: Element, of: str, reading: Reading) -> tuple[Any, Any] | None:
    """Return the limits, if there are any: one alone is from or to 0."""
    element = reading.only(joint, "limit", of)
    if element is None:
        return None
    reading.knows(element, of, ("lower", "upper", "effort", "velocity"))
    if not {"lower", "upper"} & set(element.attributes):
        return None
    lower, upper = (reading.number(element, key, of, _ZERO) for key in ("lower", "upper"))
    if lower is None or upper is None:
        return None
    if lower > upper:
        message = f"lower must not be above upper: {short(lower)} and {short(upper)}"
        reading.problem(element, "", of, message)
        return None
    return lower, upper


def _drive(joint: Element, of: str, reading: Reading) -> Drive:
    element = reading.only(joint, "dynamics", of)
    if element is None:
        return _FREE
    reading.knows(element, of, ("damping", "friction"))
    damping = reading.number(element, "damping", of, _ZERO, least=_ZERO) or _ZERO
    friction = reading.number(element, "friction", of, _ZERO, least=_ZERO) or _ZERO
    return Drive(viscous=damping, coulomb=(friction, friction))


def _mimic(joint: Element, of: str, reading: Reading) -> Mimic | None:
    element = reading.only(joint, "mimic", of)
    if element is None:
        return None
    reading.knows(element, of, ("joint", "multiplier", "offset"))
    other = reading.text(element, "joint", of)
    multiplier = reading.number(element, "multiplier", of, _ONE)
    offset = reading.number(element, "offset", of, _ZERO)
    if other is None or multiplier is None or offset is None:
        return None
    return Mimic(other, multiplier, offset, element.line)


# -- what both have -------------------------------------------------------------------------------


def _origin(element: Element, of: str, reading: Reading) -> Origin:
    origin = reading.only(element, "origin", of)
    if origin is None:
        return Origin()
    reading.knows(origin, of, ("xyz", "rpy"))
    shift, angles = (reading.vector(origin, key, of) for key in ("xyz", "rpy"))
    if shift is None or angles is None:
        return Origin()
    x, y, z = map(reading.length, shift)
    roll, pitch, yaw = map(reading.angle, angles)
    return Origin((x, y, z), (roll, pitch, yaw))
