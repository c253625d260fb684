"""What a robot file says legally but probably does not mean."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import sympy

from .schema import Link, RobotFile, shown

#: lengths above this are millimetres, no doubt [m]
_LONG = 100
#: limits above two turns that are not written with pi are degrees [rad]
_TWO_TURNS = 4 * sympy.pi
#: how close to a quarter turn an angle is, if it was meant to be one [rad]
_CLOSE = sympy.Rational("1e-5")
#: how much an inertia may miss what is physical, relative to its largest moment: rounded data
_ROUNDING = 1e-3

Location = tuple[int | str, ...]


def remarks(file: RobotFile) -> Iterator[tuple[Location, str]]:
    """Yield the location and the description of each oddity in ``file``."""
    used = _used_symbols(file)
    for symbol in file.parameters:
        if symbol not in used:
            yield ("parameters", symbol.name), "this parameter is not used in the file"
    for i, link in enumerate(file.links):
        for field, remark in _of_link(link):
            yield ("links", i, field), remark


def _used_symbols(file: RobotFile) -> set[Any]:
    used: set[Any] = set()

    def look(value: Any) -> None:
        if isinstance(value, sympy.Basic):
            used.update(value.free_symbols)
        elif isinstance(value, tuple):
            for part in value:
                look(part)
        elif isinstance(value, dict):
            look(tuple(value.values()))

    look(file.model_dump(exclude={"parameters"}))
    return used


def _of_link(link: Link) -> Iterator[tuple[str, str]]:
    for field in ("alpha", "theta"):
        if remark := _angle(getattr(link, field)):
            yield field, remark
    for field in ("a", "d"):
        if _exceeds(getattr(link, field), _LONG):
            yield field, f"{shown(getattr(link, field))} m is long for a link; lengths are in m"
    if any(_exceeds(part, _LONG) for part in link.com or ()):
        yield "com", "is far from the link; lengths are in m"
    turns = link.limits if link.joint == "revolute" else None
    if any(_exceeds(limit, _TWO_TURNS) for limit in turns or ()):
        yield "limits", "is more than two turns; angles are in radians, 180 degrees are `pi`"
    if link.inertia and (remark := _inertia(link.inertia)):
        yield "inertia", remark


def _exceeds(value: Any, bound: Any) -> bool:
    """Whether a plain number, without symbols or pi, is larger in size than ``bound``."""
    return bool(value.is_Rational and abs(value) > bound)


def _angle(value: Any) -> str | None:
    """Find degrees, and quarter turns typed as decimals: then sines that should be 0 are 1e-8."""
    if not value.is_Rational or value == 0:
        return None
    turn = round(float(value) / (np.pi / 2)) * sympy.pi / 2
    if abs(value - turn) < _CLOSE or _is_rounded(value, turn):
        return (
            f"{shown(value)} is close to {turn}; if that is meant, write `{turn}`:"
            " exact zeros make short equations and fast kernels"
        )
    if abs(value) > 2 * sympy.pi:
        return (
            f"{shown(value)} rad is more than a turn; angles are in radians,"
            f" {shown(value)} degrees are `{value * sympy.pi / 180}`"
        )
    return None


def _is_rounded(value: Any, exact: Any) -> bool:
    """Whether ``value`` is ``exact``, not 0, rounded or cut to 2, 3 or 4 decimals."""
    return exact != 0 and any(
        abs(value) * 10**digits in (sympy.floor(size), sympy.floor(size + sympy.Rational(1, 2)))
        for digits in (2, 3, 4)
        for size in [abs(exact) * 10**digits]
    )


def _inertia(tensor: tuple[tuple[Any, ...], ...]) -> str | None:
    """Find what no body has: a negative principal moment, or one above the sum of the others."""
    if not all(value.is_number for row in tensor for value in row):
        return None
    moments = np.linalg.eigvalsh(np.array(tensor, dtype=float))
    tolerance = _ROUNDING * np.max(np.abs(moments))
    listed = ", ".join(f"{moment:.6g}" for moment in moments)
    if moments[0] < -tolerance:
        return f"not physical: a principal moment is negative ({listed})"
    if moments[2] > moments[0] + moments[1] + tolerance:
        return f"not physical: a principal moment is above the sum of the other two ({listed})"
    return None
