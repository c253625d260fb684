"""From what a robot file says to what a robot is given by: rows of DH parameters, or links."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sympy import sympify

from moro.abc import joint_variable
from moro.formats.assembled import Assembled
from moro.formats.dh.arm import Arm, Row
from moro.formats.dh.description import Description
from moro.formats.source import Source
from moro.formats.yaml.coordinates import Moved, moved
from moro.formats.yaml.drives import driven
from moro.formats.yaml.links import assembled
from moro.formats.yaml.schema import Friction, Link, RobotFile
from moro.model import JOINT_TYPES

#: what a link of a bare chain says
_OF_ROWS = {"joint", "a", "alpha", "d", "theta", "mass", "com", "inertia", "limits"}
_OF_ROWS |= {"rotor_inertia", "motor_inertia", "gear_ratio", "friction"}
_OF_ARMS = {"name", "convention", "gravity", "parameters", "links"}


def build(file: RobotFile, decimal: bool = False) -> Source:
    """Return the robot that ``file`` describes. What the file leaves out is not set.

    A bare chain of rows is one whose masses can be set, ...; ``decimal``: whether a float was in
    what it says.
    """
    motions, _ = moved(file)
    return _arm(file) if _is_bare(file, motions) else Assembled(assembled(file), decimal)


def _is_bare(file: RobotFile, motions: Iterable[Moved | None]) -> bool:
    """Whether all that is said has a place in rows of DH parameters."""
    return (
        file.model_fields_set <= _OF_ARMS
        and all(_has_place(link) for link in file.links)
        and all(x is not None and x.terms == ((i, 1),) for i, x in enumerate(motions, start=1))
    )


def _has_place(link: Link) -> bool:
    friction = link.friction or Friction()
    return (
        link.model_fields_set <= _OF_ROWS
        and link.joint in JOINT_TYPES
        and friction.static is None
        and friction.smooth is None
    )


def _arm(file: RobotFile) -> Description:
    links, motions = file.links, moved(file)[0]
    arm = Arm(
        tuple(_row(link, x, i) for i, (link, x) in enumerate(zip(links, motions, strict=True), 1)),
        file.convention,
        # one has it: all have mass, com and inertia
        _given(link.mass for link in links),
        _given(link.com for link in links),
        _given(link.inertia for link in links),
        file.gravity,
        _drives(links, "rotor_inertia", "rotor_inertia", "motor_inertia"),
        _drives(links, "viscous", "friction"),
        _drives(links, "coulomb", "friction"),
        _given(link.limits for link in links),
    )
    return Description.of(arm, file.name, file.parameters)


def _row(link: Link, motion: Moved | None, i: int) -> Row:
    offset = None if motion is None else motion.offset
    theta, d = (link.theta, offset) if link.joint == "prismatic" else (offset, link.d)
    return Row(link.a, link.alpha, d, theta, joint_variable(i), JOINT_TYPES[link.joint])


def _drives(links: Iterable[Link], name: str, *fields: str) -> tuple[Any, ...] | None:
    """Return a quantity of all drives; None where no link has one of the ``fields``."""
    if not any(getattr(link, field) is not None for link in links for field in fields):
        return None
    return tuple(_exact(getattr(driven(link).drive, name)) for link in links)


def _exact(x: Any) -> Any:
    return tuple(map(sympify, x)) if isinstance(x, tuple) else sympify(x)


def _given(values: Iterable[Any]) -> tuple[Any, ...] | None:
    """Return values, None among them; None where all are."""
    listed = tuple(values)
    return None if all(value is None for value in listed) else listed
