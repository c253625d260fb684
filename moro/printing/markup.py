r"""Formulas from text, in a small part of LaTeX: ``markup(r"\dot{q}_1")``."""

from __future__ import annotations

import re

from moro.printing.typeset import (
    CLOSE,
    GREEK,
    MINUS,
    OPEN,
    PLUS,
    SPACE,
    Box,
    Formula,
    dotted,
    fraction,
    function,
    letter,
    number,
    scripts,
)

_MARK = re.compile(r"\s*(\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|[A-Za-z]|.)", re.DOTALL)
_OPERATORS = {
    "=": Box("=", "<mo>=</mo>", 1.4),
    "+": PLUS,
    "-": MINUS,
    "(": OPEN,
    ")": CLOSE,
    "/": Box("/", "<mo>/</mo>", 0.5),
    ",": Box(",", "<mo>,</mo>", 0.45),
    r"\,": SPACE,
    r"\quad": Box(r"\quad ", '<mspace width="1em"/>', 1.0),
    r"\cdot": Box(r"\cdot ", "<mo>⋅</mo>", 0.8),
    r"\times": Box(r"\times ", "<mo>×</mo>", 1.25),
    r"\le": Box(r"\le ", "<mo>≤</mo>", 1.4),
    r"\partial": Box(r"\partial ", "<mi>∂</mi>", 0.6),
    r"\sum": Box(r"\textstyle\sum", '<mo movablelimits="true">∑</mo>', 1.1),
}
_FUNCTIONS = {rf"\{name}": function(name) for name in ("sin", "cos")}


def markup(source: str) -> Formula:
    r"""Read a formula in a small part of LaTeX: ``r"K_i = \frac{1}{2} m_i v_i^T v_i"``.

    Letters, numbers, scripts, Greek letters, dot, ddot, frac, sum, sin, cos, times, partial.
    """
    marks = [mark for mark in _MARK.findall(source.strip()) if mark.strip()]
    formula, rest = _items(marks)
    if rest:
        raise ValueError(f"{source!r}: {rest[0]} without its counterpart")
    return formula


def _items(marks: list[str]) -> tuple[Formula, list[str]]:
    """Read marks up to a closing brace."""
    formula: Formula = []
    while marks and marks[0] != "}":
        boxes, marks = _nucleus(marks)
        below = above = None
        while marks and marks[0] in "_^":
            which, (script, marks) = marks[0], _group(marks[1:])
            below, above = (script, above) if which == "_" else (below, script)
        if (below, above) != (None, None):
            boxes = [*boxes[:-1], scripts(boxes[-1], below, above)]
        formula += boxes
    return formula, marks


def _group(marks: list[str]) -> tuple[Formula, list[str]]:
    """Read what stands in braces, or a single letter or number."""
    if not marks:
        raise ValueError("a script is missing")
    if marks[0] != "{":
        return _nucleus(marks)
    formula, rest = _items(marks[1:])
    if not rest:
        raise ValueError("{ without its counterpart")
    return formula, rest[1:]


def _nucleus(marks: list[str]) -> tuple[Formula, list[str]]:
    mark, rest = marks[0], marks[1:]
    if mark == "{":
        return _group(marks)
    if mark in (r"\dot", r"\ddot"):
        inner, rest = _group(rest)
        if not inner:
            raise ValueError("nothing below the dots")
        return [dotted(inner[0], 1 if mark == r"\dot" else 2)], rest
    if mark == r"\frac":
        above, rest = _group(rest)
        below, rest = _group(rest)
        return [fraction(above, below)], rest
    if mark in _OPERATORS:
        return [_OPERATORS[mark]], rest
    if mark in _FUNCTIONS:
        return [_FUNCTIONS[mark]], rest
    if mark[0].isdigit():
        return [number(mark)], rest
    name = mark.removeprefix("\\")
    if (mark[0] == "\\") != (name in GREEK) or not (name in GREEK or name.isalpha()):
        raise ValueError(f"{mark!r} is not known here")
    return [letter(name)], rest
