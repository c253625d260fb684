"""Arguments of functions, taken and given: names, shapes, units, frames."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

#: a dimension is a number, or "n" for the number of joints
Shape: TypeAlias = tuple[str | int, ...]


@dataclass(frozen=True)
class Argument:
    """An input or output array: row-major, components of ``shape``."""

    name: str
    shape: Shape
    unit: str
    #: what it is, with the frame it is expressed in
    description: str

    @property
    def sizes(self) -> tuple[int, ...]:
        """The shape, where it is in numbers."""
        return tuple(int(n) for n in self.shape)

    @property
    def size(self) -> int:
        """The number of components."""
        return math.prod(self.sizes)
