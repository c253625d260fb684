"""Rows of a DH table as a person writes them, read as constants and a joint variable."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import sympy as sp
from sympy.core.function import AppliedUndef

from moro.abc import t
from moro.checks import values as checks
from moro.formats.coupling import affine, inseparable
from moro.formats.dh.arm import Row
from moro.model import PRISMATIC, REVOLUTE, JointType
from moro.printing.plain import natural

#: what the types of joints are called in a row
_TYPES = {word: kind for kind in (REVOLUTE, PRISMATIC) for word in (kind.letter, kind.name)}

#: what the conventions are called, and what is meant
CONVENTIONS: dict[str, Literal["dh", "mdh"]] = {
    "dh": "dh",
    "mdh": "mdh",
    "standard": "dh",
    "distal": "dh",
    "modified": "mdh",
    "proximal": "mdh",
    "craig": "mdh",
    "khalil": "mdh",
}

_FORM = '(a, alpha, d, theta) or (a, alpha, d, theta, "r" or "p")'


def read_convention(text: Any, what: str = "convention") -> Literal["dh", "mdh"]:
    """Return the convention, "dh" or "mdh"; ValueError says which was meant."""
    word = text.strip().lower() if isinstance(text, str) else ""
    if word in ("dh", "mdh"):
        return CONVENTIONS[word]
    meant = CONVENTIONS.get(word)
    near = f'; did you mean "{meant}"?' if meant else checks.suggestion(word, ("dh", "mdh"))
    raise ValueError(
        f'{what} must be "dh" (standard) or "mdh" (modified), not {checks.brief(text)}{near}'
    )


def given_rows(rows: Sequence[Any]) -> tuple[tuple[Any, ...], ...]:
    """Return rows as tuples, of the right length, their entries not looked at."""
    if not rows:
        raise ValueError(f"a robot needs at least one row {_FORM}")
    if len(rows) == 1 and _holds_rows(rows[0]):
        raise ValueError("rows are given one by one, Robot(row, row, ...): write Robot(*rows)")
    given = []
    for i, row in enumerate(rows, 1):
        items = checks.sequence(row, f"row {i}")
        if len(items) not in (4, 5):
            raise ValueError(f"row {i} must be {_FORM}, not {len(items)} values")
        given.append(tuple(items))
    return tuple(given)


def read_rows(rows: Sequence[tuple[Any, ...]]) -> tuple[Row, ...]:
    """Return the rows ``(a, alpha, d, theta[, "r" | "p"])`` of a table, checked.

    The joint variables are found in theta (revolute) or d (prismatic): the functions of time there,
    else the one symbol; they may have constant ratios, and what is added to them is an offset.
    """
    read = tuple(_read_row(row, f"row {i}") for i, row in enumerate(rows, 1))
    _check_variables(read)
    return read


def _holds_rows(row: Any) -> bool:
    if len(getattr(row, "shape", ())) == 2:
        return 1 not in row.shape or not isinstance(row, sp.MatrixBase)
    return (
        isinstance(row, (list, tuple))
        and len(row) > 0
        and all(isinstance(x, (list, tuple, sp.MatrixBase)) for x in row)
    )


def _read_row(items: tuple[Any, ...], what: str) -> Row:
    kind = _type(items[4] if len(items) == 5 else "r", what)
    a = checks.scalar(items[0], f"a of {what}")
    alpha = checks.angle(items[1], f"alpha of {what}")
    d = checks.scalar(items[2], f"d of {what}")
    theta = checks.angle(items[3], f"theta of {what}")
    if kind.is_angle:
        terms, theta = _split(theta, f"theta of {what}")
    else:
        terms, d = _split(d, f"d of {what}")
    return Row(a, alpha, d, theta, terms, kind)


def _type(text: Any, what: str) -> JointType:
    kind = _TYPES.get(text.lower()) if isinstance(text, str) else None
    if kind is None:
        near = checks.suggestion(text.lower(), _TYPES) if isinstance(text, str) else ""
        raise ValueError(
            f'joint type of {what} must be "r" (revolute) or "p" (prismatic), '
            f"not {checks.brief(text)}{near}"
        )
    return kind


def _split(expr: Any, what: str) -> tuple[tuple[tuple[Any, Any], ...], Any]:
    """Return (joint variable, ratio) of each one in ``expr``, and the constant offset."""
    variables = _variables(expr, what)
    try:
        ratios, offset = affine(expr, variables)
    except ValueError as error:
        raise ValueError(f"{what} {error} {expr}") from None
    for constant in (offset, *ratios.values()):
        if checks.moving(constant):
            raise ValueError(f"{what} must be joint variables and constants, not {expr}")
    return tuple(ratios.items()), offset


def _variables(expr: Any, what: str) -> list[Any]:
    functions = expr.atoms(AppliedUndef)
    candidates = sorted(functions or expr.free_symbols, key=lambda x: natural(str(x)))
    if not candidates:
        raise ValueError(
            f"{what} is {expr}, a number: the joint variable must stand there, "
            "q1 of moro.abc, say. A fixed row, of a tool say, is no joint: a robot.yaml, and "
            "Robot.of({...}), have fixed links and a tool"
        )
    if len(candidates) > 1 and not functions:
        names = ", ".join(map(str, candidates))
        raise ValueError(
            f"{what} is {expr}: which of {names} is the joint variable? "
            "Write it as a function of time (q1 of moro.abc), and the rest as plain symbols"
        )
    if candidates == [t]:
        raise ValueError(f"{what} is {expr}: t is time; the joint variable is q1 of moro.abc, say")
    if any(q.args != (t,) for q in functions):
        raise ValueError(
            f"{what} is {expr}: a joint variable must be a function of time, the t of moro.abc "
            "(a plain Symbol('t')), and of nothing else"
        )
    return candidates


def _check_variables(rows: Sequence[Row]) -> None:
    owner: dict[Any, int] = {}
    alone: dict[Any, int] = {}
    for i, row in enumerate(rows, 1):
        ((variable, ratio), *others) = row.terms
        if ratio == 1 and not others and alone.setdefault(variable, i) != i:
            raise ValueError(
                f"rows {alone[variable]} and {i} have the same joint variable {variable}; joints"
                " that move together are links of Robot.of({...}), or of a robot.yaml"
            )
        for variable, _ in row.terms:
            owner.setdefault(variable, i)
    if lost := inseparable([dict(row.terms) for row in rows], [*owner]):
        raise ValueError(
            f"{' and '.join(map(str, lost))} move joints only together; they are too many by one at"
            " least"
        )
    for i, row in enumerate(rows, 1):
        for name in ("a", "alpha", "d", "theta"):
            constant = getattr(row, name)
            held = checks.moving(constant, owner)
            for variable in held:
                if variable in owner:
                    raise ValueError(
                        f"{name} of row {i} is {constant}, which holds {variable}, "
                        f"the joint variable of row {owner[variable]}: it must be constant"
                    )
            if held:
                raise ValueError(f"{name} of row {i} must be constant, not {constant}")
