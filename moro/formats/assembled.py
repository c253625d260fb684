"""Links in the terms of texts and files, as what a robot is given by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import sympy as sp

from moro.checks.values import exact
from moro.formats.assembly import Assembly
from moro.formats.hand_made import HandMade
from moro.printing.tables import Table


class Assembled(HandMade):
    """A robot made of an ``Assembly``, which remembers how it was put together."""

    def __init__(self, assembly: Assembly, decimal: bool = False):
        super().__init__(assembly.model())
        self._decimal = self._decimal or decimal
        self.assembly = assembly

    def summary(self) -> Table:
        """Return what is given, with names, and what is to be said of how it was read."""
        headline, *quantities = super().summary()
        names = [coordinate.name for coordinate in self._model.coordinates]
        frames = [frame.name for frame in self._model.frames]
        rows = [
            headline,
            ("joint_names", "given", ", ".join(names)),
            ("frames", "given", ", ".join(frames)),
            *quantities,
            *((what, "read", text) for what, text in self.assembly.notes),
        ]
        return Table(("quantity", "state", "value"), rows)

    def how_to_set(self, name: str) -> str:
        """Say where it is said."""
        return f"nothing is said of it where {self.name} is described"

    def _substituted(self, values: Mapping[Any, Any]) -> Assembled:
        with_floats = any(x.has(sp.Float) for x in values.values())
        new = Assembled(_put(self.assembly, values), self._decimal or with_floats)
        new.name = self.name
        return new


def _put(x: Any, values: Mapping[Any, Any]) -> Any:
    """Return data of any shape, with values put in for symbols."""
    if isinstance(x, sp.Basic):
        return exact(x.xreplace(values))
    if isinstance(x, tuple):
        return type(x)(_put(part, values) for part in x)
    if isinstance(x, Mapping):
        return {key: _put(part, values) for key, part in x.items()}
    if is_dataclass(x) and not isinstance(x, type):
        parts = {f.name: getattr(x, f.name) for f in fields(x)}
        return replace(x, **{name: _put(part, values) for name, part in parts.items()})
    return x
