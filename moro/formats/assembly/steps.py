"""Placements as elementary motions: turns about x and z, and shifts, as few as can be.

An angle in terms of pi or of symbols stays a turn, which closed forms hold exactly. One that is a
number and means nothing, 0.3 say, becomes a rotation by rational numbers: sine and cosine from the
tangent of the half angle, so that the matrix is orthogonal exactly, and the angle right to 1e-17.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import groupby
from typing import Any

import sympy as sp

from moro.model import Placement, Rotation, Shift, Turn
from moro.model.placement import Step
from moro.spatial.angles import rational_sincos
from moro.spatial.vectors import Matrix, Vector, add, product, times, transpose

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
_QUARTER = sp.pi / 2
_EYE: Matrix = ((_ONE, _ZERO, _ZERO), (_ZERO, _ONE, _ZERO), (_ZERO, _ZERO, _ONE))


# -- what is given --------------------------------------------------------------------------------


def turn_y(angle: Any) -> tuple[Step, ...]:
    """Return a turn about y, Rz(pi/2) Rx(angle) Rz(-pi/2)."""
    return Turn("z", _QUARTER), Turn("x", angle), Turn("z", -_QUARTER)


def rpy(roll: Any, pitch: Any, yaw: Any) -> tuple[Step, ...]:
    """Return Rz(yaw) Ry(pitch) Rx(roll): turns about the fixed axes x, y, z, one after the other.

    Angles are SymPy values [rad].
    """
    about_y = turn_y(pitch) if pitch != 0 else ()
    return joined((Turn("z", yaw), *about_y, Turn("x", roll)))


def to_axis(direction: Sequence[Any]) -> tuple[Step, ...]:
    """Return turns Rz(phi) Rx(theta) after which z points in a direction, of any length.

    phi is 0 or a quarter turn, and theta a multiple of one, for the directions of the axes. Raises
    ValueError for the zero vector.
    """
    x, y, z = direction
    if not (x or y or z):
        raise ValueError("the zero vector has no direction")
    phi = sp.atan2(x, -y) if x else _ZERO
    if not x and not y:
        theta = _ZERO if z > 0 else sp.pi
    elif not x:
        theta = _angle(-y, z)
    else:
        theta = _angle(sp.sqrt(x**2 + y**2), z)
    return joined((Turn("z", _value(phi)), Turn("x", theta)))


def inverse(steps: Iterable[Step]) -> tuple[Step, ...]:
    """Return the steps back."""
    return tuple(_back(step) for step in reversed([*steps]))


def _back(step: Step) -> Step:
    if isinstance(step, Turn):
        return Turn(step.axis, -step.angle)
    if isinstance(step, Shift):
        x, y, z = step.p
        return Shift((-x, -y, -z))
    return Rotation(transpose(step.R))


def _angle(sine: Any, cosine: Any) -> Any:
    return _value(sp.atan2(sine, cosine))


def _value(angle: Any) -> Any:
    """Return an angle as it is if it is a fraction of pi, else as a decimal."""
    if (angle / sp.pi).is_Rational:
        return angle
    return sp.Rational(str(angle.evalf(20)))


# -- as few as can be -----------------------------------------------------------------------------


def joined(steps: Iterable[Step]) -> tuple[Step, ...]:
    """Return steps of which no two that follow each other are about one axis, or nothing."""
    found: list[Step] = []
    for step in steps:
        last = found.pop() if found else None
        both = None if last is None else _both(last, step)
        if last is not None and both is None:
            found.append(last)
        new = both or step
        if not _is_nothing(new):
            found.append(new)
    return tuple(found)


def _both(first: Step, second: Step) -> Step | None:
    """Return two steps as one, or None."""
    if isinstance(first, Shift) and isinstance(second, Shift):
        return Shift(add(first.p, second.p))
    if isinstance(first, Rotation) and isinstance(second, Rotation):
        return Rotation(product(first.R, second.R))
    if isinstance(first, Turn) and isinstance(second, Turn) and first.axis == second.axis:
        return Turn(first.axis, _reduced(first.angle + second.angle))
    return None


def _reduced(angle: Any) -> Any:
    """Return an angle in -pi < angle <= pi, if it is a fraction of pi."""
    halves = angle / sp.pi
    return -sp.pi * ((1 - halves) % 2 - 1) if halves.is_Rational else angle


def _is_nothing(step: Step) -> bool:
    if isinstance(step, Turn):
        return bool(step.angle == 0)
    return bool(step.R == _EYE) if isinstance(step, Rotation) else not any(step.p)


def placed(steps: Iterable[Step]) -> Placement:
    """Return the pose that steps lead to, by as few as can be.

    Where a turn among them is a plain number, they make one shift and one rotation in rational
    numbers. Else turns stay as they are but for quarter turns, which are as few as can be, and a
    shift goes before quarter turns that come before it.
    """
    steps = joined(steps)
    if any(map(_is_plain, steps)) and all(map(_is_numeric, steps)):
        steps = [step if isinstance(step, Shift) else _rotation(step) for step in steps]
        whole = Placement.by(*steps)
        found = Placement.by(*joined(Placement(whole.R, whole.p).steps))
    else:
        found = Placement.by(*joined(_shifted(_few(steps))))
    return Placement(settled_matrix(found.R), settled_vector(found.p), found.given)


def _few(steps: Iterable[Step]) -> Iterator[Step]:
    """Yield steps with quarter turns as few as can be."""
    for quarters, run in groupby(steps, _is_quarter):
        turns = [*run]
        yield from _quarters(turns) if quarters else turns


def _quarters(run: list[Step]) -> Sequence[Step]:
    """Return quarter turns as few: three always do."""
    few = joined(Placement(Placement.by(*run).R).steps)
    return few if len(few) < len(run) else run


def _shifted(steps: Iterable[Step]) -> Iterator[Step]:
    """Yield steps with shifts before quarter turns."""
    R, waiting = _EYE, []
    for step in steps:
        if isinstance(step, Shift):
            yield Shift(times(R, step.p))
        elif _is_quarter(step):
            R = product(R, step.R)
            waiting.append(step)
        else:
            yield from (*waiting, step)
            R, waiting = _EYE, []
    yield from waiting


def _rotation(step: Turn | Rotation) -> Turn | Rotation:
    """Return a turn by a number, unless by quarters, as an orthogonal matrix of rational ones."""
    if isinstance(step, Rotation) or _is_quarter(step):
        return step
    s, c = (sp.Rational(x.numerator, x.denominator) for x in rational_sincos(_fraction(step.angle)))
    if step.axis == "x":
        return Rotation(((_ONE, _ZERO, _ZERO), (_ZERO, c, -s), (_ZERO, s, c)))
    return Rotation(((c, -s, _ZERO), (s, c, _ZERO), (_ZERO, _ZERO, _ONE)))


def _fraction(angle: Any) -> Fraction:
    """Return a number as a fraction, exactly if it is one."""
    return Fraction(str(angle if angle.is_Rational else angle.evalf(30)))


def settled(x: Any) -> Any:
    """Return a SymPy value; a number made of roots and fractions with what cancels cancelled."""
    x = sp.sympify(x)
    return x if x.is_Rational or not x.is_number else sp.expand(x)


def settled_vector(v: Iterable[Any]) -> Vector:
    """Return a vector of settled components."""
    x, y, z = map(settled, v)
    return x, y, z


def settled_matrix(rows: Iterable[Iterable[Any]]) -> Matrix:
    """Return a matrix of settled entries."""
    x, y, z = map(settled_vector, rows)
    return x, y, z


def _is_quarter(step: Step) -> bool:
    return isinstance(step, Turn) and bool((step.angle / _QUARTER).is_Integer)


def _is_numeric(step: Step) -> bool:
    """Whether a step is a shift, or a turn by numbers."""
    if isinstance(step, Turn):
        return bool(step.angle.is_number)
    return isinstance(step, Shift) or all(x.is_number for row in step.R for x in row)


def _is_plain(step: Step) -> bool:
    """Whether a step is a turn by a number that is no fraction of pi."""
    if not isinstance(step, Turn):
        return False
    return bool(step.angle.is_number and not (step.angle / sp.pi).is_Rational)
