"""What a robot file says legally but probably does not mean."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import sympy

from moro.checks.constants import numeric
from moro.checks.plausibility import LinkData, angle_remark
from moro.checks.plausibility import remarks as remarks_on
from moro.checks.values import shown
from moro.formats.yaml.coordinates import affine, displacement
from moro.formats.yaml.problems import Location
from moro.formats.yaml.schema import Link, RobotFile, is_row

_ZERO = sympy.Integer(0)


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
    rows = [is_row(link.model_fields_set, link.joint) for link in file.links]
    data = [_data(link, row) for link, row in zip(file.links, rows, strict=True)]
    for field, i, message in remarks_on(data, file.gravity):
        if i is None:
            yield (field,), message
        elif field in ("a", "d") and not rows[i]:
            yield ("links", i, "xyz"), message
        else:
            yield ("links", i, field), message
    for i, link in enumerate(file.links):
        for pose in link.poses:
            for x in pose.rpy or ():
                if message := angle_remark(x):
                    yield ("links", i, "rpy"), message


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


def _data(link: Link, row: bool) -> LinkData:
    """Return what is given of a link; of one that is placed, how far it is away as its length."""
    turns = link.joint in ("revolute", "helical")
    about_com = link.com is not None and link.inertia_about == "com"
    given: dict[str, Any] = {"mass": link.mass, "com": link.com, "limits": link.limits}
    given["inertia"] = link.inertia if about_com and link.joint != "rotor" else None
    if not row:
        away = [pose.xyz for pose in link.poses if pose.xyz is not None]
        length = sum(max(map(sympy.Abs, xyz), default=_ZERO) for xyz in _numbers(away)) + _ZERO
        return LinkData(turns, length, _ZERO, _ZERO, _ZERO, **given)
    name, value = displacement(link)
    still = {name: affine(value)[1]}
    return LinkData(
        turns,
        link.a,
        link.alpha,
        still.get("d", link.d),
        still.get("theta", link.theta),
        **given,
    )


def _numbers(vectors: Iterable[Any]) -> Iterator[Any]:
    return (v for v in vectors if all(x.is_number for x in v))
