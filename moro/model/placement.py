"""Constant poses of frames in frames, as the elementary motions that they are given by.

Turns about parallel axes add up, which is what keeps closed forms short: so a placement keeps its
turns about x and z, and its shifts, beside the rotation matrix and the position that follow.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, TypeAlias

from moro.spatial.vectors import Matrix, Scalar, Vector, add, product, times

_EYE: Matrix = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@dataclass(frozen=True)
class Turn:
    """A turn about the frame's own x or z axis [rad]."""

    axis: Literal["x", "z"]
    angle: Any

    @property
    def R(self) -> Matrix:
        """The rotation matrix."""
        from sympy import cos, sin  # takes long, and help needs models and no numbers

        s, c = sin(self.angle), cos(self.angle)
        if self.axis == "x":
            return (1, 0, 0), (0, c, -s), (0, s, c)
        return (c, -s, 0), (s, c, 0), (0, 0, 1)


@dataclass(frozen=True)
class Rotation:
    """Any other rotation, as its matrix."""

    R: Matrix


@dataclass(frozen=True)
class Shift:
    """A shift, in the frame's own axes [m]."""

    p: Vector


#: one after the other, each in the frame that those before have made
Step: TypeAlias = "Turn | Rotation | Shift"


@dataclass(frozen=True)
class Placement:
    """A constant pose of one frame in another: ``x_parent = R x + p``."""

    R: Matrix = _EYE
    p: Vector = (0, 0, 0)
    #: how it was given, if it was by steps
    given: tuple[Step, ...] = ()

    @classmethod
    def by(cls, *steps: Step) -> Placement:
        """Return the pose that elementary motions lead to."""
        R, p = _EYE, (0, 0, 0)
        for step in steps:
            if isinstance(step, Shift):
                p = add(p, times(R, step.p))
            else:
                R = product(R, step.R)
        return cls(R, p, steps)

    @property
    def steps(self) -> tuple[Step, ...]:
        """Elementary motions that lead to it: those given, or the position and the rotation."""
        return self.given or (Shift(self.p), *_turns(self.R))


def _turns(R: Matrix) -> tuple[Step, ...]:
    """Return a rotation as quarter turns about z, x and z, if it is one of the 24, or as it is."""
    entries = tuple(x for row in R for x in row)
    if all(x in (-1, 0, 1) for x in entries):
        return _quarter_turns()[tuple(int(x) for x in entries)]
    return (Rotation(R),)


@cache
def _quarter_turns() -> dict[tuple[Scalar, ...], tuple[Turn, ...]]:
    """Return {entries of a rotation matrix: turns that it is made of}."""
    from sympy import pi

    found: dict[tuple[Scalar, ...], tuple[Turn, ...]] = {}
    for a, b, c in itertools.product((0, 1, 2, 3), repeat=3):
        given = (Turn("z", a * pi / 2), Turn("x", b * pi / 2), Turn("z", c * pi / 2))
        turns = tuple(turn for turn in given if turn.angle != 0)
        R = Placement.by(*turns).R
        key = tuple(int(x) for row in R for x in row)
        if key not in found or len(turns) < len(found[key]):
            found[key] = turns
    return found
