"""Trigonometric polynomials in angles between joints rather than from the first of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from moro.scalars.trig import TrigRing


class RelativeRing(TrigRing):
    """Has angles q2, q2 + q3 basic where ``TrigRing`` has q1 + q2, q1 + q2 + q3, and -q1 for q1.

    M does not depend on how the arm is turned as a whole. Its entries are linear in cos(q2), which
    in q1 and q1 + q2 is c1 c12 + s1 s12; products of them, determinants, have no cross terms here.
    With -q1, differences of basic angles, which displays join, are q1 + q2 and the like.
    """

    def declare_angles(
        self, angles: Sequence[tuple[Any, Any]], groups: Sequence[int] | None = None
    ) -> None:
        """Make the differences to the first angle of each group basic, and its opposite."""
        groups = groups or [0] * len(angles)
        first: dict[int, Any] = {}
        relative = []
        for (variable, angle), group in zip(angles, groups, strict=True):
            start = first.setdefault(group, angle)
            relative.append((variable, -angle if angle == start else sp.expand(angle - start)))
        super().declare_angles(relative, groups)
