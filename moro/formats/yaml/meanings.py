"""Where the parameters of a robot file are in it: "mass of body 1 of link 2"."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy

from moro.abc import t
from moro.formats.yaml.schema import RobotFile

_COMPONENTS = {"com": "xyz", "first_moment": "xyz", "xyz": "xyz", "axis": "xyz", "gravity": "xyz"}
#: what one entry of a list is called, and of a mapping
_ENTRIES = {"links": "link", "bodies": "body", "frames": "frame"}

Location = tuple[int | str, ...]


def meanings(file: RobotFile, names: list[str]) -> dict[Any, str]:
    """Return where each symbol is; links are called by their ``names``, or their numbers.

    A symbol that is part of a longer expression is "in" it.
    """
    found: dict[Any, dict[str, None]] = {}
    for location, value in _values((), file.model_dump(exclude={"parameters"})):
        for symbol in value.free_symbols - {t}:
            said = _said(location, names)
            found.setdefault(symbol, {})[said if value == symbol else f"in {said}"] = None
    return {symbol: ", ".join(places) for symbol, places in found.items()}


def _values(location: Location, value: Any) -> Iterator[tuple[Location, Any]]:
    if isinstance(value, sympy.Basic):
        yield location, value
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from _values((*location, name), part)
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            yield from _values((*location, i), part)


def _said(location: Location, names: list[str]) -> str:
    """Return what is at a location: fields, innermost first, and of what they are."""
    words: list[str] = []
    owners: list[str] = []
    steps = iter(enumerate(location))
    for k, step in steps:
        if step in _ENTRIES and k + 1 < len(location):
            _, entry = next(steps)
            called = names[int(entry)] if step == "links" else entry
            number = isinstance(entry, int) and step != "links"
            owners.append(f"{_ENTRIES[str(step)]} {int(entry) + 1 if number else called}")
        elif isinstance(step, int):
            axes = _COMPONENTS.get(words[-1], "")
            words += [axes[step]] if axes else []
        else:
            words.append(step.replace("_", " ") if step not in _COMPONENTS else step)
    return " of ".join([" ".join(words), *reversed(owners)])
