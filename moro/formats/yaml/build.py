"""From what a robot file says to the description of an arm."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy

from moro.abc import joint_variable
from moro.formats.dh.arm import Arm, Row
from moro.formats.dh.description import Description
from moro.formats.yaml.schema import Link, RobotFile
from moro.model import JOINT_TYPES

_ZERO = sympy.Integer(0)


def build(file: RobotFile) -> Description:
    """Return the arm that ``file`` describes. What the file leaves out is not set."""
    links = file.links
    friction = [link.friction for link in links]
    arm = Arm(
        tuple(_row(link, joint_variable(i)) for i, link in enumerate(links, start=1)),
        file.convention,
        # one has it: all have mass, com and inertia
        _given(link.mass for link in links),
        _given(link.com for link in links),
        _given(link.inertia for link in links),
        file.gravity,
        _given((link.rotor_inertia for link in links), _ZERO),
        _given((each and each.viscous for each in friction), _ZERO),
        _given((each and each.coulomb for each in friction), (_ZERO, _ZERO)),
        _given(link.limits for link in links),
    )
    return Description.of(arm, file.name, file.parameters)


def _given(values: Iterable[Any], default: Any = None) -> tuple[Any, ...] | None:
    """Return values, with a default for None; None where all are."""
    listed = tuple(values)
    if all(value is None for value in listed):
        return None
    return tuple(default if value is None else value for value in listed)


def _row(link: Link, q: Any) -> Row:
    return Row(link.a, link.alpha, link.d, link.theta, q, JOINT_TYPES[link.joint])
