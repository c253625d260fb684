"""Displacements of joints as sums of joint variables, each times a constant."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import sympy as sp


def affine(value: Any, variables: Collection[Any]) -> tuple[dict[Any, Any], Any]:
    """Return {variable: ratio} and offset of a sum of ratio times variable, and a constant.

    ValueError, whose message begins where the place is named, if it is no such sum.
    """
    expanded = sp.expand(value)
    ratios = {q: expanded.coeff(q) for q in variables}
    offset = sp.expand(expanded - sum(ratio * q for q, ratio in ratios.items()))
    if any(x.has(*variables) for x in (offset, *ratios.values())):
        raise ValueError(
            "must be a sum of joint variables, each times a constant, and a constant, not"
        )
    return {q: ratio for q, ratio in ratios.items() if ratio != 0}, offset


def inseparable(joints: Sequence[Mapping[Any, Any]], variables: Sequence[Any]) -> list[Any]:
    """Return variables that joints, {variable: ratio} each, do not tell apart.

    Some motion of these moves no joint: the inertia matrix would be singular.
    """
    if all(len(terms) == 1 for terms in joints):
        moved = {q for terms in joints for q in terms}
        return [q for q in variables if q not in moved]
    A = sp.Matrix([[terms.get(q, 0) for q in variables] for terms in joints])
    still = A.nullspace()
    return [q for k, q in enumerate(variables) if any(v[k] != 0 for v in still)]
