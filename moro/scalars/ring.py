"""What the formulas of the symbolic route ask of their scalars, whatever these are.

Scalars are added, subtracted and multiplied with each other, and multiplied by whole numbers. There
are three rings: ``TrigRing``, whose scalars are exact polynomials; ``DualRing``, numbers at states
that carry their derivatives; ``RandomPoint``, numbers mod a prime at random states.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from moro.spatial.vectors import Scalar


class Ring(Protocol):
    """Scalars made of SymPy expressions."""

    zero: Any
    one: Any
    #: a factor for scalars
    half: Any

    def convert(self, expr: Any) -> Scalar:
        """Return a SymPy expression as a scalar."""

    def sincos(self, angle: Any) -> tuple[Scalar, Scalar]:
        """Return (sin, cos) of an angle, a sum of joint variables and constants."""


class DifferentialRing(Ring, Protocol):
    """Scalars that have derivatives."""

    def declare_angles(
        self, angles: Sequence[tuple[Any, Any]], groups: Sequence[int] | None = None
    ) -> None:
        """Prepare for (joint variable, angle) pairs; ``groups`` are those of parallel joints."""

    def diff(self, x: Scalar, variable: Any) -> Scalar:
        """Return dx/dq for a joint variable q."""
