"""What users of a program must know of the robot it is of: frames, gravity, its parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.robot import Robot
from moro_codegen.generate import Program

_AXES = "xyz"


def described(program: Program, robot: Robot) -> Program:
    """Return the program with the robot's convention and gravity, and what its parameters are."""
    where = meanings(robot)
    gravity = None if robot.gravity is None else tuple(_text(g) for g in robot.gravity)
    return replace(
        program,
        convention="dh" if robot.convention == "dh" else "mdh",
        gravity=gravity,
        parameters=tuple(replace(p, description=where.get(p.name, "")) for p in program.parameters),
    )


def meanings(robot: Robot) -> dict[str, str]:
    """Return where each parameter is in what was given of the robot.

    ``{"m_2": "mass of link 2", "l_1": "a of row 1, in com x of link 1"}``: a parameter that is part
    of a longer expression is "in" it.
    """
    places: dict[str, dict[tuple[str, str], list[str]]] = {str(s): {} for s in robot.parameters}
    for what, owner, number, value in constants(robot):
        for symbol in value.free_symbols:
            text = what if value == symbol else f"in {what}"
            numbers = places.get(str(symbol), {}).setdefault((text, owner), [])
            numbers.append(str(number))
    return {name: ", ".join(_said(found)) for name, found in places.items()}


def _said(places: dict[tuple[str, str], list[str]]) -> Iterator[str]:
    """Yield "mass of link 2", "a of rows 1 and 3", "in gravity z"."""
    for (what, owner), numbers in places.items():
        if not owner:
            yield what
            continue
        *most, last = numbers
        listed = f"{', '.join(most)} and {last}" if most else last
        yield f"{what} of {owner}{'s' * bool(most)} {listed}"


def constants(robot: Robot) -> Iterator[tuple[str, str, int, Any]]:
    """Yield each constant: what it is, of a row, link or joint, of which, and its value."""
    arm = robot.arm
    for i, row in enumerate(arm.rows, 1):
        for what in ("a", "alpha", "d", "theta"):
            yield what, "row", i, getattr(row, what)
    for i, mass in enumerate(arm.masses or (), 1):
        yield "mass", "link", i, mass
    for i, com in enumerate(arm.cm_positions or (), 1):
        for axis, value in zip(_AXES, com, strict=True):
            yield f"com {axis}", "link", i, value
    for i, tensor in enumerate(arm.inertia_tensors or (), 1):
        for j, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            yield f"I{_AXES[j]}{_AXES[k]}", "link", i, tensor[j][k]
    for axis, value in zip(_AXES, arm.gravity or (), strict=False):
        yield f"gravity {axis}", "", 0, value
    for i, value in enumerate(arm.rotor_inertias or (), 1):
        yield "rotor inertia", "joint", i, value
    for i, value in enumerate(robot.viscous_friction or (), 1):
        yield "viscous friction", "joint", i, value
    for i, (forwards, backwards) in enumerate(robot.coulomb_friction or (), 1):
        if forwards == backwards:
            yield "Coulomb friction", "joint", i, forwards
        else:
            yield "Coulomb friction where qd > 0", "joint", i, forwards
            yield "Coulomb friction where qd < 0", "joint", i, backwards


def _text(value: Any) -> str:
    """Return a number as a decimal, an expression as SymPy writes it."""
    return f"{float(value):.15g}" if sp.sympify(value).is_Rational else str(value)
