"""What a robot file says legally but probably does not mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import sympy

from moro.checks.constants import numeric
from moro.checks.plausibility import LinkData
from moro.checks.plausibility import remarks as remarks_on
from moro.checks.values import shown
from moro.formats.yaml.schema import Link, RobotFile

Location = tuple[int | str, ...]


def remarks(file: RobotFile) -> Iterator[tuple[Location, str]]:
    """Yield the location and the description of each oddity in ``file``."""
    values = list(_values((), file.model_dump(exclude={"parameters"})))
    used = set[Any]().union(*(value.free_symbols for _, value in values))
    for symbol in file.parameters:
        if symbol not in used:
            yield ("parameters", symbol.name), "this parameter is not used in the file"
    for location, value in values:
        if message := _without_value(value, file.parameters):
            yield location, message
    for field, link, message in remarks_on([_data(link) for link in file.links], file.gravity):
        yield (field,) if link is None else ("links", link, field), message


def _values(location: Location, value: Any) -> Iterator[tuple[Location, Any]]:
    """Yield all SymPy values in a field, with the location of each, without places in lists."""
    if isinstance(value, sympy.Basic):
        yield location, value
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from _values((*location, name), part)
    elif isinstance(value, tuple):
        for i, part in enumerate(value):
            yield from _values((*location, i) if location == ("links",) else location, part)


def _without_value(value: Any, defaults: Mapping[Any, Any]) -> str | None:
    """Say that a value is no real, finite number at the defaults of its parameters, if so."""
    own = {s: x for s, x in defaults.items() if s in value.free_symbols and x is not None}
    found = value.xreplace(own) if own else value
    if not found.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo, sympy.I) and (
        not found.is_number or numeric(found).is_Number
    ):
        return None
    given = ", ".join(f"{s} = {shown(x)}" for s, x in own.items())
    return f"`{value}` is not a real, finite number at the default {given}"


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
