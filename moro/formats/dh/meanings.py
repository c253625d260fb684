"""Where the symbols of an arm are in what was given of it: "mass of link 2"."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from moro.formats.dh.arm import Arm

_AXES = "xyz"


def meanings(arm: Arm) -> dict[str, str]:
    """Return where each symbol is.

    ``{"m_2": "mass of link 2", "l_1": "a of row 1, in com x of link 1"}``: a symbol that is part of
    a longer expression is "in" it.
    """
    places: dict[str, dict[tuple[str, str], list[str]]] = {}
    for what, owner, number, value in _constants(arm):
        for symbol in value.free_symbols:
            text = what if value == symbol else f"in {what}"
            found = places.setdefault(str(symbol), {})
            found.setdefault((text, owner), []).append(str(number))
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


def _constants(arm: Arm) -> Iterator[tuple[str, str, int, Any]]:
    """Yield each constant: what it is, of a row, link or joint, of which, and its value."""
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
    for i, rotor in enumerate(arm.rotors or (), 1):
        if rotor is not None:
            yield "inertia", "rotor", i, rotor[0]
            yield "gear ratio", "rotor", i, rotor[1]
    for i, value in enumerate(arm.viscous_friction or (), 1):
        yield "viscous friction", "joint", i, value
    for i, (forwards, backwards) in enumerate(arm.coulomb_friction or (), 1):
        if forwards == backwards:
            yield "Coulomb friction", "joint", i, forwards
        else:
            yield "Coulomb friction where qd > 0", "joint", i, forwards
            yield "Coulomb friction where qd < 0", "joint", i, backwards
