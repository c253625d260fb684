"""Friction, rotors and springs of joints, at the coordinates that move them.

A joint that moves by x = r q + b does the work of its torque at q: what it takes there is r times
what it takes at x, of the rate r qd.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.model import Drive

NONE = Drive()


def folded(drive: Drive, ratio: Any, offset: Any, what: str) -> Drive:
    """Return a drive at x = ratio q + offset as one at q.

    r^2 times rotor inertia, viscous friction and stiffness; |r| times what rubs dry, the two
    directions swapped where r < 0. ValueError names ``what`` where the sign of r is not known and
    counts.
    """
    if drive == NONE or (ratio == 1 and offset == 0):
        return drive
    square, size = ratio**2, sp.Abs(ratio)

    def dry(pair: tuple[Any, Any]) -> tuple[Any, Any]:
        forward, backward = pair
        if forward != backward and not sp.sympify(ratio).is_real:
            raise ValueError(
                f"{what}: friction differs in the two directions, and the sign of the ratio"
                f" {ratio} is not known; give the ratio as a number"
            )
        if ratio.is_negative:
            forward, backward = backward, forward
        return size * forward, size * backward

    return replace(
        drive,
        rotor_inertia=square * drive.rotor_inertia,
        viscous=square * drive.viscous,
        coulomb=dry(drive.coulomb),
        static=None if drive.static is None else dry(drive.static),
        stribeck_velocity=drive.stribeck_velocity / (1 if drive.static is None else size),
        width=None if drive.width is None else drive.width / size,
        stiffness=square * drive.stiffness,
        rest=(drive.rest - offset) / ratio if drive.stiffness != 0 else drive.rest,
    )


def together(drives: Sequence[Drive], what: str) -> Drive:
    """Return drives at one coordinate as one.

    ValueError names ``what`` where two rub dry in ways that do not add up: with widths or Stribeck
    velocities that differ.
    """
    total = NONE
    for drive in drives:
        total = drive if total == NONE else total if drive == NONE else _both(total, drive, what)
    return total


def _both(first: Drive, second: Drive, what: str) -> Drive:
    stiffness = first.stiffness + second.stiffness
    moment = first.stiffness * first.rest + second.stiffness * second.rest
    dry = _dry(first, second, what)
    return replace(
        dry,
        rotor_inertia=first.rotor_inertia + second.rotor_inertia,
        viscous=first.viscous + second.viscous,
        stiffness=stiffness,
        rest=moment / stiffness if stiffness != 0 else first.rest,
    )


def _dry(first: Drive, second: Drive, what: str) -> Drive:
    """Return the dry friction of both."""
    rubbing = [x for x in (first, second) if any(x.coulomb) or any(x.static or ())]
    if len(rubbing) < 2:
        return rubbing[0] if rubbing else first
    if first.width != second.width:
        raise ValueError(
            f"{what}: the friction of joints on one coordinate adds up where it has one width,"
            f" not {first.width} and {second.width}"
        )
    coulomb = _sum(first.coulomb, second.coulomb)
    if first.static is None and second.static is None:
        return replace(first, coulomb=coulomb)
    velocities = {x.stribeck_velocity for x in rubbing if x.static is not None}
    if len(velocities) > 1:
        raise ValueError(
            f"{what}: the friction of joints on one coordinate adds up where it has one Stribeck"
            f" velocity, not {' and '.join(map(str, sorted(velocities, key=str)))}"
        )
    static = _sum(first.static or first.coulomb, second.static or second.coulomb)
    return replace(first, coulomb=coulomb, static=static, stribeck_velocity=velocities.pop())


def _sum(a: tuple[Any, Any], b: tuple[Any, Any]) -> tuple[Any, Any]:
    return a[0] + b[0], a[1] + b[1]
