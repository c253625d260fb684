"""Floating-point numbers and quaternions, as MuJoCo has them, back as decimals and turns.

What MuJoCo leaves as it is written comes back as the decimals of the file; what it computes, as
short as can be. A rotation is a turn about an axis of the frame, or turns by k pi/4 and k pi/6, if
it is to the rounding of doubles; or to the digits of the file, 0.7071 0.7071 0 0, unless that is to
be taken as it is written.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from moro.formats import decimals
from moro.formats.assembly.steps import joined, turn_y
from moro.model import Placement, Rotation, Turn
from moro.model.placement import Step
from moro.spatial.vectors import Matrix, Vector

#: what computing with doubles leaves of a zero; beside 1
_NOISE = 4e-15
#: of one number, and of what it is computed from; beside 1
_ROUNDING = 5e-16
#: by which two lists of doubles are the same
_SAME = 1e-14
#: digits of the file that tell a quarter turn, and those that tell k pi/4 or k pi/6
_FEWEST = {True: 2, False: 4}
#: how much an angle misses, for a unit in the last place of a component of a quaternion
_PER_COMPONENT = 3
#: sines of angles between axes that are parallel, as quaternions of few digits have them
_CLOSE = 1e-3


def number(x: float, size: float = 1.0) -> Any:
    """Return a double as a decimal, of 15 digits if it is that; 0 if it is nothing beside ``size``.

    Then it is off by not more than the rounding of doubles.
    """
    x = float(x)
    if abs(x) <= _NOISE * size:
        return sp.Integer(0)
    short = float(f"{x:.15g}")
    is_short = abs(short - x) <= _ROUNDING * max(abs(x), size)
    return sp.Rational(repr(short if is_short else x))


def position(x: float, is_angle: bool) -> Any:
    """Return where a joint is [rad or m]: k pi/4 and k pi/6 as what they are."""
    exact = _fraction(float(x), lambda _: _ROUNDING) if is_angle else None
    return number(x) if exact is None else exact


def numbers(found: Any, said: Any = None) -> list[Any]:
    """Return doubles as decimals: those that the file says, where they are the same."""
    found = [float(x) for x in found]
    size = max(map(abs, found), default=0.0)
    if said is not None and is_same(found, said):
        return [sp.Rational(repr(float(x))) for x in said]
    return [number(x, size) for x in found]


def vector(found: Any, said: Any = None) -> Vector:
    """Return a vector [m]; components that are nothing beside 1 m are 0."""
    if said is not None and is_same(found, said):
        x, y, z = numbers(found, said)
    else:
        x, y, z = (number(x) for x in found)
    return x, y, z


def is_same(found: Any, said: Any) -> bool:
    """Whether doubles are the same but for rounding."""
    return bool(np.allclose(found, said, rtol=_SAME, atol=_SAME * np.max(np.abs(found), initial=0)))


@dataclass
class Meaning:
    """Reads directions and rotations, and keeps what was read as something else."""

    as_written: bool = False
    #: what a file says, and what it was read as
    meant: dict[str, str] = field(default_factory=dict)

    def direction(self, found: Any, said: Any) -> Vector:
        """Return a direction of any length, given one of length 1 and how the file has it."""
        length = float(np.linalg.norm(said))
        is_said = length > 0 and is_same(found, np.asarray(said) / length)
        text = _text(said if is_said else found)
        read = map(decimals.number, text.split())
        components = [x for x in read if isinstance(x, decimals.Number)]
        (x, y, z), is_meant = decimals.direction(components, self.as_written)
        if is_meant and is_said:
            self.meant[text] = f"({x}, {y}, {z})"
        return sp.sympify(x), sp.sympify(y), sp.sympify(z)

    def rotation(self, found: Any, said: Said) -> tuple[Step, ...]:
        """Return the rotation of a quaternion (w, x, y, z) of length 1, as steps."""
        exact, tolerance = _of_turns(found, lambda _: _NOISE), said.tolerance
        if exact is not None or self.as_written or tolerance is None:
            return _steps(found, said) if exact is None else exact
        meant = _of_turns(found, tolerance)
        if meant is None:
            return _steps(found, said)
        self.meant[said.text] = _words(meant)
        return meant


# -- quaternions ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Said:
    """How the file gives a rotation."""

    #: the components of a quaternion of any length, if it is one
    quaternion: tuple[float, ...] | None = None
    #: how much an angle may miss, by the digits of the file, if it is a quarter turn or is not
    tolerance: Callable[[bool], float] | None = None
    text: str = ""

    @classmethod
    def by_quaternion(cls, components: Any, found: Any) -> Said:
        """Return what is said by a quaternion, unless MuJoCo has made another one of it."""
        q = np.array([float(x) for x in components])
        if not (length := np.linalg.norm(q)) or not is_same(q / length, found):
            return cls()
        return cls(tuple(map(float, q)), _rounded(q, _PER_COMPONENT), _text(q))

    @classmethod
    def by_angles(cls, angles: Any) -> Said:
        """Return what is said by angles [rad]."""
        found = [float(x) for x in angles]
        return cls(None, _rounded(found, 1), _text(found))


def _text(said: Any) -> str:
    """Return numbers as a file has them."""
    return " ".join(repr(float(x)).removesuffix(".0") for x in said)


def _rounded(said: Any, factor: float) -> Callable[[bool], float]:
    """Return how much what is written in decimals may miss a quarter turn, and another angle."""
    digits = max(len(repr(float(x)).partition(".")[2]) for x in said)

    def tolerance(is_quarter: bool) -> float:
        return max(factor * 10.0**-digits, _NOISE) if digits >= _FEWEST[is_quarter] else _NOISE

    return tolerance


def _steps(q: Any, said: Said) -> tuple[Step, ...]:
    """Return the rotation of a quaternion in numbers: one turn, if it is about an axis."""
    (w, *v), axes = q, [k for k in range(3) if abs(q[k + 1]) > _NOISE]
    if len(axes) == 1:
        angle = number(2 * math.atan2(v[axes[0]], w))
        return _about(axes[0], angle)
    own = [sp.Rational(repr(x)) for x in said.quaternion] if said.quaternion else map(number, q)
    return (Rotation(_matrix(*own)),)


def _matrix(w: Any, x: Any, y: Any, z: Any) -> Matrix:
    """Return the rotation of a quaternion of any length, orthogonal exactly."""
    norm = w * w + x * x + y * y + z * z
    return (
        (1 - 2 * (y * y + z * z) / norm, 2 * (x * y - w * z) / norm, 2 * (x * z + w * y) / norm),
        (2 * (x * y + w * z) / norm, 1 - 2 * (x * x + z * z) / norm, 2 * (y * z - w * x) / norm),
        (2 * (x * z - w * y) / norm, 2 * (y * z + w * x) / norm, 1 - 2 * (x * x + y * y) / norm),
    )


def _of_turns(q: Any, tolerance: Callable[[bool], float]) -> tuple[Step, ...] | None:
    """Return a rotation as turns by k pi/4 and k pi/6, if it is such turns."""
    R: Any = np.array(_matrix(*(float(x) for x in q)))
    for axes, angles in (((2, 0, 2), _zxz(R)), ((0, 1, 2), _xyz(R)), ((2, 1, 0), _zyx(R))):
        exact = [_fraction(x, tolerance) for x in angles]
        if any(x is None for x in exact):
            continue
        steps = [step for k, x in zip(axes, exact, strict=True) for step in _about(k, x)]
        missed = np.array(Placement.by(*steps).R, dtype=float) - R
        if np.max(np.abs(missed)) <= 4 * max(map(tolerance, (True, False))):
            return joined(steps)
    return None


def _zxz(R: Any) -> tuple[float, float, float]:
    if math.hypot(R[0, 2], R[1, 2]) < _CLOSE:  # the axes z are parallel: one turn is enough
        return math.atan2(R[1, 0], R[0, 0]), 0.0 if R[2, 2] > 0 else math.pi, 0.0
    tilt = math.atan2(math.hypot(R[0, 2], R[1, 2]), R[2, 2])
    return math.atan2(R[0, 2], -R[1, 2]), tilt, math.atan2(R[2, 0], R[2, 1])


def _xyz(R: Any) -> tuple[float, float, float]:
    a, b, c = _zyx(R.T)
    return -c, -b, -a


def _zyx(R: Any) -> tuple[float, float, float]:
    pitch = math.atan2(-R[2, 0], math.hypot(R[0, 0], R[1, 0]))
    if math.hypot(R[0, 0], R[1, 0]) < _CLOSE:
        return math.atan2(-R[0, 1], R[1, 1]), pitch, 0.0
    return math.atan2(R[1, 0], R[0, 0]), pitch, math.atan2(R[2, 1], R[2, 2])


def _fraction(angle: float, tolerance: Callable[[bool], float]) -> Any | None:
    """Return the multiple of pi/4 or pi/6 that an angle is, or None."""
    twelfths = round(angle * 12 / math.pi)
    if twelfths % 2 and twelfths % 3:
        return None
    exact = twelfths * math.pi / 12
    return sp.pi * twelfths / 12 if abs(angle - exact) <= tolerance(twelfths % 6 == 0) else None


def _about(axis: int, angle: Any) -> tuple[Step, ...]:
    if axis == 1:
        return turn_y(angle) if angle != 0 else ()
    return (Turn("x" if axis == 0 else "z", angle),)


def _words(steps: Sequence[Step]) -> str:
    return " ".join(f"R{s.axis}({s.angle})" for s in steps if isinstance(s, Turn)) or "no turn"
