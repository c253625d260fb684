"""Rows of a DH table as a person writes them, read as constants and a joint variable."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import sympy as sp
from sympy.core.function import AppliedUndef

from moro import checks
from moro.chain import Row

_KINDS: dict[str, Literal["r", "p"]] = {
    "r": "r",
    "p": "p",
    "revolute": "r",
    "prismatic": "p",
}


def read_rows(rows: Sequence[Any]) -> tuple[Row, ...]:
    """Return the rows ``(a, alpha, d, theta[, "r" | "p"])`` of a table, checked.

    The joint variable is found in theta (revolute) or d (prismatic): the one function of time
    there, else the one symbol; what is added to it is a constant offset.
    """
    if not rows:
        raise ValueError("a robot needs at least one row (a, alpha, d, theta)")
    read = tuple(_read_row(row, f"row {i}") for i, row in enumerate(rows, 1))
    _check_variables(read)
    return read


def _read_row(row: Any, what: str) -> Row:
    items = checks.sequence(row, what)
    if len(items) not in (4, 5):
        raise ValueError(
            f'{what} must be (a, alpha, d, theta) or (a, alpha, d, theta, "r" or "p"), '
            f"not {len(items)} values"
        )
    kind = _kind(items[4] if len(items) == 5 else "r", what)
    a = checks.scalar(items[0], f"a of {what}")
    alpha = checks.angle(items[1], f"alpha of {what}")
    d = checks.scalar(items[2], f"d of {what}")
    theta = checks.angle(items[3], f"theta of {what}")
    if kind == "r":
        variable, theta = _split(theta, f"theta of {what}")
    else:
        variable, d = _split(d, f"d of {what}")
    return Row(a, alpha, d, theta, variable, kind)


def _kind(text: Any, what: str) -> Literal["r", "p"]:
    kind = _KINDS.get(text.lower()) if isinstance(text, str) else None
    if kind is None:
        raise ValueError(f'joint type of {what} must be "r" or "p", not {text!r}')
    return kind


def _split(expr: Any, what: str) -> tuple[Any, Any]:
    """Return (joint variable, constant offset) of ``expr``."""
    variable = _variable(expr, what)
    rate = sp.expand(expr).coeff(variable)
    offset = sp.expand(expr - rate * variable)
    if offset.has(variable) or not rate.is_number:
        raise ValueError(f"{what} must be a joint variable plus a constant, not {expr}")
    if rate != 1:
        raise ValueError(
            f"{what} is {expr}: a joint variable must stand there once, with factor 1, not {rate}; "
            "turn the joint's axis round, or take the whole of it as the variable"
        )
    return variable, offset


def _variable(expr: Any, what: str) -> Any:
    functions = expr.atoms(AppliedUndef)
    candidates = sorted(functions or expr.free_symbols, key=str)
    if not candidates:
        raise ValueError(
            f"{what} is {expr}, a number: the joint variable must stand there, "
            "q1 of moro.abc, say (a fixed row belongs to its neighbours)"
        )
    if len(candidates) > 1:
        names = ", ".join(map(str, candidates))
        raise ValueError(
            f"{what} is {expr}: which of {names} is the joint variable? "
            "Write it as a function of time (q1 of moro.abc), and the rest as plain symbols"
        )
    return candidates[0]


def _check_variables(rows: Sequence[Row]) -> None:
    owner: dict[Any, int] = {}
    for i, row in enumerate(rows, 1):
        if row.variable in owner:
            raise ValueError(
                f"rows {owner[row.variable]} and {i} have the same joint variable {row.variable}"
            )
        owner[row.variable] = i
    for i, row in enumerate(rows, 1):
        for name in ("a", "alpha", "d", "theta"):
            constant = getattr(row, name)
            for variable in constant.atoms(AppliedUndef) | constant.free_symbols:
                if variable in owner:
                    raise ValueError(
                        f"{name} of row {i} is {constant}, which holds {variable}, "
                        f"the joint variable of row {owner[variable]}: it must be constant"
                    )
            moving = constant.atoms(AppliedUndef)
            if moving:
                raise ValueError(f"{name} of row {i} must be constant, not {constant}")
