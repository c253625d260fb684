"""Values as a person gave them: exactness belongs inside, what was typed comes back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import sympy as sp

from moro.checks import tensors
from moro.checks import values as checks


def scalars(values: Sequence[Any]) -> tuple[Any, ...]:
    """Return scalars as SymPy values, floats as floats."""
    return tuple(_plain(x) for x in values)


def vectors(values: Sequence[Any]) -> tuple[tuple[Any, ...], ...]:
    """Return vectors that ``checks.vector`` has passed."""
    return tuple(scalars(checks.components(x, "")) for x in values)


def tensor(values: Any) -> tensors.Rows:
    """Return a tensor that ``checks.tensor`` has passed, as a matrix."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = rows = tensors.matrix(_plain(values))
    return type(rows)(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))  # equal to rounding: equal


def pairs(values: Sequence[Any], pair: Callable[[Any, str], list[Any]]) -> tuple[Any, ...]:
    """Return pairs that ``pair`` reads; None where there is none."""
    return tuple(None if x is None else scalars(pair(x, "")) for x in values)


def _plain(value: Any) -> Any:
    """Return a SymPy value; matrices, arrays and lists as tuples, which nobody changes later."""
    if isinstance(value, Mapping):
        return {key: _plain(x) for key, x in value.items()}
    if getattr(value, "shape", None) and hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple, sp.Tuple)):
        return tuple(_plain(x) for x in value)
    return sp.sympify(value)
