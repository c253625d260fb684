"""Joints that equality constraints tie to others: y - y0 = a0 + a1 (x - x0)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)


@dataclass(frozen=True)
class Coupling:
    """A displacement from rest is a0 + a1 times that of another joint, or a0 (None)."""

    a0: Any
    a1: Any
    joint: str | None


def followed(name: str, couplings: Mapping[str, Coupling]) -> tuple[str | None, Any, Any]:
    """Return (joint, ratio, offset): what a joint follows, through all couplings, and how.

    The joint is its own, or None if it stands still.
    """
    ratio, offset, at = _ONE, _ZERO, name
    while (coupling := couplings.get(at)) is not None:
        offset, ratio = offset + ratio * coupling.a0, ratio * coupling.a1
        if coupling.joint is None or ratio == 0:
            return None, _ZERO, offset
        at = coupling.joint
    return at, ratio, offset


def is_circle(name: str, coupling: Coupling, couplings: Mapping[str, Coupling]) -> bool:
    """Whether a joint would follow itself."""
    at: str | None = coupling.joint
    while at is not None and at != name:
        at = couplings[at].joint if at in couplings else None
    return at == name
