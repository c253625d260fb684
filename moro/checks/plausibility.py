"""What is legal in the data of an arm and probably not meant: units, degrees, tensors of no body.

The same remarks are made of a robot file, with its lines, and of what is set on a Robot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from moro.checks.tensors import OTHER_ORDERS, Listed, Rows, in_other_order
from moro.checks.values import shown

#: lengths above this are millimetres, no doubt [m]
LONG = 100
#: limits above two turns that are not written with pi are degrees [rad]
TWO_TURNS = 4 * math.pi
#: how close to a quarter turn an angle is, if it was meant to be one [rad]
CLOSE = 1e-5
#: how much an inertia may miss what is physical, relative to its largest moment: rounded data
ROUNDING = 1e-3

#: a radius of gyration is never more than this many times the size of the arm ..
WIDE = 5
#: .. which counts as this much where it is less, and as 1 where it is given in symbols [m]
SMALLEST = 0.5
#: the radius of gyration of a link, as a part of the arm's size: between 0.02 and 0.3, mostly
TYPICAL = 0.1
#: below this part of the size, on average, and above this density, masses are not in kg [kg/m^3]
NARROW, DENSE = 0.01, 2000
#: masses of more than this are not in kg if the arm is as dense as this [kg, kg/m^3]
HEAVY, SOLID = 1000, 500

#: 1 kg m^2 in units that data sheets and CAD programs use
_INERTIA_UNITS = {"kg cm^2": 1e4, "kg mm^2": 1e6, "g cm^2": 1e7, "g mm^2": 1e9}
#: 1 m/s^2 in other units
_ACCELERATION_UNITS = {"mm/s^2": 1e3, "cm/s^2": 1e2, "in/s^2": 1 / 0.0254, "ft/s^2": 1 / 0.3048}
_EARTH = 9.81


_unremarked: ContextVar[bool] = ContextVar("unremarked", default=False)


@contextmanager
def unremarked() -> Iterator[None]:
    """Set values without a warning of them: what is in a file is remarked on with its lines."""
    token = _unremarked.set(True)
    try:
        yield
    finally:
        _unremarked.reset(token)


def is_unremarked() -> bool:
    """Whether ``unremarked`` is on, in this thread."""
    return _unremarked.get()


class Remark(NamedTuple):
    """An oddity."""

    #: as a robot file calls it: alpha, mass, gravity
    field: str
    #: the joint and link, from 0; None: that of the whole arm
    link: int | None
    message: str


@dataclass(frozen=True)
class LinkData:
    """What is given of a joint and its link, in exact SymPy values; None: not given."""

    revolute: bool
    #: length, twist, offset and angle of the row, without the joint variable
    a: Any
    alpha: Any
    d: Any
    theta: Any
    mass: Any = None
    com: Sequence[Any] | None = None
    #: about the centre of mass, 3 x 3
    inertia: Rows | None = None
    limits: Sequence[Any] | None = None


def remarks(links: Sequence[LinkData], gravity: Sequence[Any] | None) -> Iterator[Remark]:
    """Yield the oddities in the data of an arm."""
    if gravity is not None and (remark := _acceleration(gravity)):
        yield Remark("gravity", None, remark)
    short = True
    for i, link in enumerate(links):
        for field, remark in _lengths(link):
            short = False
            yield Remark(field, i, remark)
        for field, remark in _angles(link):
            yield Remark(field, i, remark)
        if link.inertia and (remark := unphysical(link.inertia)):
            yield Remark("inertia", i, remark)
    if short:  # else the size of the arm is no measure
        yield from _masses_and_inertias(links)


# -- lengths and angles ---------------------------------------------------------------------------


def _lengths(link: LinkData) -> Iterator[tuple[str, str]]:
    for field in ("a", "d"):
        if _exceeds(getattr(link, field), LONG):
            yield field, f"{shown(getattr(link, field))} m is long for a link; lengths are in m"
    if any(_exceeds(part, LONG) for part in link.com or ()):
        yield "com", "is far from the link; lengths are in m"
    if not link.revolute and any(_exceeds(limit, LONG) for limit in link.limits or ()):
        yield "limits", "is far for a joint to slide; lengths are in m"


def _angles(link: LinkData) -> Iterator[tuple[str, str]]:
    for field in ("alpha", "theta"):
        if remark := angle_remark(getattr(link, field)):
            yield field, remark
    if link.revolute and any(_exceeds(limit, TWO_TURNS) for limit in link.limits or ()):
        yield "limits", "is more than two turns; angles are in radians, 180 degrees are `pi`"


def _exceeds(value: Any, bound: float) -> bool:
    """Whether a plain number, without symbols or pi, is larger in size than ``bound``."""
    return bool(value.is_Rational and abs(value) > bound)


def angle_remark(value: Any) -> str | None:
    """Find degrees, and quarter turns typed as decimals: then sines that should be 0 are 1e-8."""
    if not value.is_Rational or value == 0:
        return None
    quarters = round(float(value) / (math.pi / 2))
    if abs(float(value) - quarters * math.pi / 2) < CLOSE or _is_rounded(value, quarters):
        turn = quarters * sp.pi / 2
        return (
            f"{shown(value)} is close to {turn}; if that is meant, write `{turn}`:"
            " exact zeros make short equations and fast kernels"
        )
    if abs(value) > 2 * math.pi:
        return (
            f"{shown(value)} rad is more than a turn; angles are in radians,"
            f" {shown(value)} degrees are `{value * sp.pi / 180}`"
        )
    return None


def _is_rounded(value: Any, quarters: int) -> bool:
    """Whether ``value`` is so many quarter turns, not 0, rounded or cut to 2, 3 or 4 decimals."""
    size = abs(quarters) * math.pi / 2
    return quarters != 0 and any(
        abs(value) * 10**digits in (math.floor(size * 10**digits), round(size * 10**digits))
        for digits in (2, 3, 4)
    )


# -- gravity, masses, inertias --------------------------------------------------------------------


def _acceleration(gravity: Sequence[Any]) -> str | None:
    """Find other units than m/s^2."""
    components = _numbers(gravity)
    if components is None:
        return None
    size = math.hypot(*components)
    for unit, per_si in _ACCELERATION_UNITS.items():
        if abs(size / (_EARTH * per_si) - 1) < 0.01:
            return f"{size:.6g} is what gravity is in {unit}; it is given in m/s^2, {_EARTH}"
    if size > 10 * _EARTH:
        return f"{size:.6g} m/s^2 is {size / _EARTH:.0f} times gravity; it is given in m/s^2"
    return None


def unphysical(tensor: Rows) -> str | None:
    """Find what no body has, and the order in which its six values would be those of one."""
    fault = _fault(tensor)
    if fault is None:
        return None
    remark = f"not physical: {fault}"
    if isinstance(tensor, Listed):
        for order in OTHER_ORDERS:
            if _fault(in_other_order(tensor, order)) is None:
                names = ", ".join(f"I{name}" for name in order)
                return (
                    f"{remark}; the six values are read as Ixx, Iyy, Izz, Ixy, Ixz, Iyz, and would"
                    f" be physical as {names}: name them, {{xx: ..., yy: ...}}, and no order counts"
                )
    return remark


def _fault(tensor: Rows) -> str | None:
    """Find a negative principal moment, or one above the sum of the others."""
    moments = _principal_moments(tensor)
    if moments is None:
        return None
    tolerance = ROUNDING * max(abs(moment) for moment in moments)
    listed = ", ".join(f"{moment:.6g}" for moment in moments)
    if moments[0] < -tolerance:
        return f"a principal moment is negative ({listed})"
    if moments[2] > moments[0] + moments[1] + tolerance:
        return f"a principal moment is above the sum of the other two ({listed})"
    return None


def _masses_and_inertias(links: Sequence[LinkData]) -> Iterator[Remark]:
    """Find masses and tensors that are not in kg and kg m^2, by the radius of gyration."""
    known = _size(links)
    size = max(known or 1.0, SMALLEST)
    radii = {i: r for i, link in enumerate(links) if (r := _radius_of_gyration(link))}
    wide = [i for i, radius in radii.items() if radius > WIDE * size]
    if wide:
        also = f" (likewise links {', '.join(str(i + 1) for i in wide[1:])})" if wide[1:] else ""
        unit = _likely_unit([radii[i] for i in wide], size)
        yield Remark(
            "inertia",
            wide[0],
            f"has a radius of gyration sqrt(I/m) of {radii[wide[0]]:.3g} m{also}, far beyond"
            f" {_described(known)}; inertias are in kg m^2, and this looks like {unit}",
        )
        return
    masses = _numbers([link.mass for link in links])
    if masses is None or known is None or not any(masses):
        return
    density = sum(masses) / size**3
    narrow = bool(radii) and _mean(list(radii.values())) < NARROW * size
    if (narrow and density > DENSE) or (sum(masses) > HEAVY and density > SOLID):
        yield Remark(
            "mass",
            max(range(len(masses)), key=masses.__getitem__),
            f"the links weigh {sum(masses):.4g} kg in all, much for {_described(known)};"
            " masses are in kg, and these look like g",
        )


def _described(size: float | None) -> str:
    return "any arm" if size is None else f"an arm that is {size:.3g} m long"


def _size(links: Sequence[LinkData]) -> float | None:
    """Return how far the arm reaches at most [m]; None where that takes symbols to say."""
    lengths = [x for link in links for x in (link.a, link.d)]
    lengths += [x for link in links if not link.revolute for x in link.limits or ()]
    reach, offsets = _numbers(lengths), _numbers([x for link in links for x in link.com or ()])
    if reach is None or offsets is None:
        return None
    return sum(map(abs, reach)) + max(map(abs, offsets), default=0.0)


def _radius_of_gyration(link: LinkData) -> float | None:
    """Return sqrt(I/m) [m] of the largest principal moment; None for points and symbols."""
    if link.mass is None or link.inertia is None or not link.mass.is_number:
        return None
    moments, mass = _principal_moments(link.inertia), float(link.mass)
    return math.sqrt(moments[2] / mass) if moments and moments[2] > 0 and mass > 0 else None


def _likely_unit(radii: Sequence[float], size: float) -> str:
    """Return the unit of inertia in which links would have the most common radius of gyration."""

    def strangeness(unit: str) -> float:
        return abs(math.log(_mean(radii) / math.sqrt(_INERTIA_UNITS[unit]) / (TYPICAL * size)))

    return min(_INERTIA_UNITS, key=strangeness)


def _mean(sizes: Sequence[float]) -> float:
    """Return the geometric mean."""
    return math.exp(sum(map(math.log, sizes)) / len(sizes))


def _principal_moments(tensor: Rows) -> list[float] | None:
    """Return them in order; None where they depend on symbols."""
    rows = [_numbers(row) for row in tensor]
    if not all(rows):
        return None
    return [float(x) for x in np.linalg.eigvalsh(np.array(rows))]


def _numbers(values: Sequence[Any]) -> list[float] | None:
    """Return values as floats; None if one is missing or depends on symbols."""
    if any(value is None or not value.is_number for value in values):
        return None
    return [float(value) for value in values]
