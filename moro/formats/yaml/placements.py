"""Elementary motions as placements, axes and rows of a robot file.

The reverse of what ``links.py`` makes of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import sympy as sp

from moro.formats.assembly import inverse, joined, placed, rpy
from moro.model import Placement, Rotation, Shift, Turn
from moro.model.placement import Step
from moro.spatial.vectors import times

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
_QUARTER = sp.pi / 2
Z = (_ZERO, _ZERO, _ONE)
#: denominators of directions that are written in whole numbers, to within rounding
_SMALL, _ROUNDING = 100, sp.Rational(1, 10**16)
#: by which an angle may miss the decimal that it was given as
_CLOSE = sp.Rational(1, 10**14)


@dataclass(frozen=True)
class Row:
    """A row of DH parameters, without the joint variable."""

    a: Any = _ZERO
    alpha: Any = _ZERO
    d: Any = _ZERO
    theta: Any = _ZERO


def row(before: Sequence[Step], after: Sequence[Step], moves: bool, convention: str) -> Row | None:
    """Return the row that steps before and after a motion make; None if they make none.

    Rz(theta) Tz(d) Tx(a) Rx(alpha), or modified, Tx(a) Rx(alpha) Rz(theta) Tz(d); a link that does
    not move has all its steps before.
    """
    start, end = [*joined(before)], [*joined(after)]
    if convention == "dh":
        d, theta = _screw(start)
        if not moves:
            start, end = [], start
        more = _screw(end)
        a, alpha, height = _twist(end)
    else:
        a, alpha, height = _twist(start)
        if height != 0 and alpha != 0:
            return None
        d, theta = _screw(start)
        more = _screw(end)
    if start or end:
        return None
    return Row(a, alpha, d + more[0] + height, theta + more[1])


def _screw(steps: list[Step]) -> tuple[Any, Any]:
    """Take the first steps, along and about z, off a list; return how far they go."""
    d, theta = _ZERO, _ZERO
    while steps:
        step = steps[0]
        if isinstance(step, Turn) and step.axis == "z":
            theta += step.angle
        elif isinstance(step, Shift) and step.p[0] == step.p[1] == 0:
            d += step.p[2]
        else:
            break
        steps.pop(0)
    return d, theta


def _twist(steps: list[Step]) -> tuple[Any, Any, Any]:
    """Take Tx(a) Rx(alpha) off a list; return a, alpha, and how far it is shifted along z too."""
    a, alpha, height = _ZERO, _ZERO, _ZERO
    if steps and isinstance(step := steps[0], Shift) and step.p[1] == 0:
        a, _, height = step.p
        steps.pop(0)
    if steps and isinstance(step := steps[0], Turn) and step.axis == "x":
        alpha = step.angle
        steps.pop(0)
    return a, alpha, height


# -- placements -----------------------------------------------------------------------------------


def poses(steps: Sequence[Step]) -> list[dict[str, Any]]:
    """Return poses, {xyz, rpy or R}, that follow each other as the steps do."""
    found: list[dict[str, Any]] = []
    waiting = [*joined(steps)]
    while waiting:
        pose: dict[str, Any] = {}
        if isinstance(step := waiting[0], Shift):
            pose["xyz"] = step.p
            waiting.pop(0)
        if turns := [*takewhile(lambda x: isinstance(x, Turn), waiting)]:
            pose["rpy"], count = _rpy(turns)
            del waiting[:count]
        elif waiting and isinstance(step := waiting[0], Rotation):
            angles = _decimal_rpy(step)
            pose |= {"R": step.R} if angles is None else {"rpy": angles}
            waiting.pop(0)
        found.append(pose)
    return found


def _decimal_rpy(step: Rotation) -> tuple[Any, ...] | None:
    """Return decimals that are read as a rotation in rational numbers; None if there are none."""
    (xx, _, _), (yx, _, _), (zx, zy, zz) = step.R
    if not all(x.is_Rational for row in map(sp.Tuple, *step.R) for x in row):
        return None
    exact = sp.atan2(zy, zz), sp.asin(-zx), sp.atan2(yx, xx)
    angles = [x.evalf(20) for x in exact]
    for digits in range(1, 17):
        shorter = tuple(sp.Rational(f"{x:.{digits}f}") for x in angles)
        if all(abs(x - y) < _CLOSE for x, y in zip(angles, shorter, strict=True)):
            return shorter if placed(rpy(*shorter)).R == step.R else None
    return None


def _rpy(turns: Sequence[Any]) -> tuple[tuple[Any, Any, Any], int]:
    """Return the angles of as many turns as make a roll, a pitch and a yaw, and how many.

    Rz(yaw) Rx(roll), or Rz(yaw + pi/2) Rx(pitch) Rz(-pi/2) Rx(roll).
    """
    about_z = [turns[0].angle] if turns[0].axis == "z" else []
    k = len(about_z)
    if len(turns) > k + 1 and turns[k + 1].angle == -_QUARTER:
        yaw = (about_z[0] if about_z else _ZERO) - _QUARTER
        roll = turns[k + 2].angle if len(turns) > k + 2 else _ZERO
        return (roll, turns[k].angle, yaw), min(len(turns), k + 3)
    roll = turns[k].angle if len(turns) > k else _ZERO
    return (roll, _ZERO, about_z[0] if about_z else _ZERO), min(len(turns), k + 1)


def axis(before: Sequence[Step], after: Sequence[Step]) -> tuple[Any, tuple[Step, ...]] | None:
    """Return the axis of a joint in the frame of its link, and how that is placed.

    None where the frame is not on the axis as the steps before lead to it.
    """
    after = joined(after)
    if any(isinstance(step, Shift) for step in after):
        return None
    direction = times(Placement.by(*inverse(after)).R, Z)
    return _scaled(direction), joined((*before, *after))


def _scaled(direction: Sequence[Any]) -> tuple[Any, ...]:
    """Return a direction in small whole numbers, if it is one, or in decimals."""
    if not all(x.is_number for x in map(sp.sympify, direction)):
        return tuple(direction)
    values = [sp.Rational(str(sp.sympify(x).evalf(20))) for x in direction]
    most = max(map(abs, values))
    small = [(x / most).limit_denominator(_SMALL) for x in values]
    if all(abs(x / most - y) < _ROUNDING for x, y in zip(values, small, strict=True)):
        return tuple(x * sp.ilcm(*(y.q for y in small), 1) for x in small)
    return tuple(sp.Rational(str(x.evalf(17))) for x in values)
