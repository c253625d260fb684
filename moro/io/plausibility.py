"""What a robot file says legally but probably does not mean."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy

from ..plausibility import LinkData
from ..plausibility import remarks as remarks_on
from .schema import Link, RobotFile

Location = tuple[int | str, ...]


def remarks(file: RobotFile) -> Iterator[tuple[Location, str]]:
    """Yield the location and the description of each oddity in ``file``."""
    used = _used_symbols(file)
    for symbol in file.parameters:
        if symbol not in used:
            yield ("parameters", symbol.name), "this parameter is not used in the file"
    for field, link, message in remarks_on([_data(link) for link in file.links], file.gravity):
        yield (field,) if link is None else ("links", link, field), message


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


def _data(link: Link) -> LinkData:
    tensor: Any = link.inertia  # its rows, whatever form it has in the file
    return LinkData(
        link.joint == "revolute",
        link.a,
        link.alpha,
        link.d,
        link.theta,
        link.mass,
        link.com,
        tensor,
        link.limits,
    )
