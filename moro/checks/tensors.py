"""Inertia tensors as people write them: a matrix, its diagonal, six values, or named entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

#: the entries of a tensor, in the order in which six values are read
ENTRIES = ("xx", "yy", "zz", "xy", "xz", "yz")
#: the orders in which other programs write them
OTHER_ORDERS = (("xx", "yy", "zz", "xy", "yz", "xz"), ("xx", "xy", "xz", "yy", "yz", "zz"))
#: what is read as a tensor
FORMS = "[Ixx, Iyy, Izz], [Ixx, Iyy, Izz, Ixy, Ixz, Iyz] or {xx: Ixx, yy: Iyy, ...}"

Rows = tuple[tuple[Any, ...], ...]


class Listed(tuple[tuple[Any, ...], ...]):
    """The rows of a tensor that came as six values, in the order of ``ENTRIES``."""


def rows_of(entries: Mapping[str, Any]) -> Rows:
    """Return the symmetric matrix of named entries."""
    xx, yy, zz = (entries[name] for name in ENTRIES[:3])
    xy, xz, yz = (entries[name] for name in ENTRIES[3:])
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def listed(values: Sequence[Any], order: Sequence[str] = ENTRIES) -> Rows:
    """Return the matrix of three values, the diagonal, or of six."""
    zero = sp.Integer(0)
    rows = rows_of(dict.fromkeys(order, zero) | dict(zip(order, values, strict=False)))
    return Listed(rows) if len(values) == len(ENTRIES) else rows


def entry_name(key: str) -> str:
    """Return the name of an entry of which ``key`` is a spelling: xx for Ixx and ixx."""
    bare = key.lower()
    return bare[1:] if bare[:1] == "i" and bare[1:] in ENTRIES else bare


def in_other_order(tensor: Rows, order: Sequence[str]) -> Rows:
    """Return what six values, read in the order of ``ENTRIES`` as a tensor, are in another."""
    return listed([tensor["xyz".index(x[0])]["xyz".index(x[1])] for x in ENTRIES], order)


def matrix(values: Any) -> Rows:
    """Return the matrix of any of the forms: rows, three or six values, or named entries."""
    if isinstance(values, Mapping):
        zeros = dict.fromkeys(ENTRIES, sp.Integer(0))
        return rows_of(zeros | {entry_name(str(key)): value for key, value in values.items()})
    if isinstance(values[0], tuple):
        x, y, z = values
        return x, y, z
    return listed(values)
