"""Tables of numbers as lines of text."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from moro_codegen.emit.statements import literal

#: columns of a line of numbers
WIDTH = 84


def rows(values: NDArray[Any], suffix: str = "") -> list[list[str]]:
    """Return of each row, the components of one state, its lines; ``suffix`` is that of C."""
    return [numbers(row, suffix) for row in values.reshape(len(values), -1)]


def numbers(values: NDArray[Any], suffix: str = "") -> list[str]:
    """Return numbers as lines, with commas between them."""
    lines = [""]
    for x in values:
        text = literal(x, suffix)
        if lines[-1] and len(lines[-1]) + len(text) + 2 > WIDTH:
            lines.append("")
        lines[-1] += f"{', ' * bool(lines[-1])}{text}"
    return lines
