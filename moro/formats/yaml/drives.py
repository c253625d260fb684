"""Drives of a robot file, brought to the side of the joint.

A motor that turns r times as fast as its joint has r^2 times its inertia and viscous friction
there, and r times what rubs dry; speeds there are r times as small.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy

from moro.formats.yaml.schema import Driven, Friction
from moro.model import Coordinate, Drive

_ONE = sympy.Integer(1)


def driven(entry: Driven, so_far: Coordinate = Coordinate()) -> Coordinate:  # noqa: B008 - frozen
    """Return a coordinate with what ``entry`` says of it, beside what is known ``so_far``."""
    drive, ratio = so_far.drive, entry.gear_ratio or _ONE
    if entry.motor_inertia is not None:
        drive = replace(drive, rotor_inertia=ratio**2 * entry.motor_inertia)
    if entry.rotor_inertia is not None:
        drive = replace(drive, rotor_inertia=entry.rotor_inertia)
    if entry.friction is not None:
        drive = _rubbing(entry.friction, drive, ratio if entry.friction.side == "motor" else _ONE)
    if entry.stiffness is not None:
        drive = replace(drive, stiffness=entry.stiffness, rest=entry.rest or sympy.Integer(0))
    return Coordinate(
        so_far.variable,
        entry.limits or so_far.limits,
        drive,
        entry.joint_name or so_far.name,
    )


def _rubbing(friction: Friction, drive: Drive, ratio: Any) -> Drive:
    def dry(pair: Any) -> tuple[Any, Any]:
        forwards, backwards = pair
        return ratio * forwards, ratio * backwards

    drive = replace(drive, viscous=ratio**2 * friction.viscous, coulomb=dry(friction.coulomb))
    if friction.static is not None:
        drive = replace(
            drive,
            static=dry(friction.static),
            stribeck_velocity=friction.stribeck_velocity / ratio,
        )
    return drive if friction.smooth is None else replace(drive, width=friction.smooth / ratio)
