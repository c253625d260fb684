"""From what a robot file says to what a robot is given by: rows of DH parameters, or links."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
from moro.formats.yaml.schema import Driven, Friction, Link, RobotFile
from moro.model import JOINT_TYPES

#: what a link of a bare chain says
_OF_ROWS = {"joint", "a", "alpha", "d", "theta", "mass", "com", "inertia", "limits"}
_OF_ROWS |= {"name", "joint_name", "rotor_inertia", "motor_inertia", "gear_ratio", "friction"}
_OF_ARMS = {"name", "convention", "gravity", "parameters", "links"}


def build(file: RobotFile, decimal: bool = False) -> Source:
    """Return the robot that ``file`` describes. What the file leaves out is not set.

    A bare chain of rows is one whose masses can be set, ...; ``decimal``: whether a float was in
    what it says.
    """
    motions, _ = moved(file)
    return _arm(file) if _is_bare(file, motions) else Assembled(assembled(file), decimal)


def _is_bare(file: RobotFile, motions: Sequence[Moved | None]) -> bool:
    """Whether all that is said has a place in rows of DH parameters.

    There, joint variables are in the order in which rows have them, and no two rows move by one
    alone.
    """
    moves = [x for x in motions if x is not None]
    order = [k for x in moves for k in x.own]
    alone = [x.terms for x in moves if x.terms[0][1] == 1 and len(x.terms) == 1]
    return (
        file.model_fields_set <= _OF_ARMS
        and all(map(_has_place, file.links))
        and order == sorted(order)
        and len(alone) == len({*alone})
    )


def _has_place(link: Link) -> bool:
    friction = link.friction or Friction()
    return (
        link.model_fields_set <= _OF_ROWS
        and link.joint in ("revolute", "prismatic")
        and friction.static is None
        and friction.smooth is None
    )


def _arm(file: RobotFile) -> Description:
    links, motions = file.links, moved(file)[0]
    moves = [x for x in motions if x is not None]
    # of each joint variable, the link that has it to itself
    new = [(link, x.own) for link, x in zip(links, moves, strict=True)]
    owners = [link if len(own) == 1 else None for link, own in new for _ in own]
    arm = Arm(
        tuple(_row(link, x) for link, x in zip(links, moves, strict=True)),
        file.convention,
        # one has it: all have mass, com and inertia
        _given(link.mass for link in links),
        _given(link.com for link in links),
        _given(link.inertia for link in links),
        file.gravity,
        _drives(owners, "rotor_inertia", "rotor_inertia", "motor_inertia"),
        _drives(owners, "viscous", "friction"),
        _drives(owners, "coulomb", "friction"),
        _given(link and link.limits for link in owners),
        _names(link.name for link in links),
        _names(link.joint_name for link in links),
    )
    return Description.of(arm, file.name, file.parameters)


def _names(names: Iterable[str | None]) -> tuple[str, ...]:
    """Return names, "" where there is none; nothing where there are none at all."""
    listed = tuple(name or "" for name in names)
    return listed if any(listed) else ()


def _row(link: Link, motion: Moved) -> Row:
    slides = link.joint == "prismatic"
    d, theta = (motion.offset, link.theta) if slides else (link.d, motion.offset)
    terms = tuple((joint_variable(k), ratio) for k, ratio in motion.terms)
    return Row(link.a, link.alpha, d, theta, terms, JOINT_TYPES[link.joint])


def _drives(links: Sequence[Link | None], name: str, *fields: str) -> tuple[Any, ...] | None:
    """Return a quantity of all drives; None where no link has one of the ``fields``."""
    if not any(getattr(link, field) is not None for link in links if link for field in fields):
        return None
    return tuple(_exact(getattr(driven(link or Driven()).drive, name)) for link in links)


def _exact(x: Any) -> Any:
    return tuple(map(sympify, x)) if isinstance(x, tuple) else sympify(x)


def _given(values: Iterable[Any]) -> tuple[Any, ...] | None:
    """Return values, None among them; None where all are."""
    listed = tuple(values)
    return None if all(value is None for value in listed) else listed
