"""Small tables that print well as text, in Jupyter and in LaTeX."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

import sympy as sp

from moro.printing.equations import math_lines
from moro.printing.notation import Notation
from moro.printing.plain import plain
from moro.printing.typeset import GREEK, Formula, latex, letter, text

#: wider cells are broken into lines [em]
_WIDEST_CELL = 36.0
#: browsers and notebooks have other ideas of tables
_STYLE = (
    "<style>.moro-table td, .moro-table th { text-align: left !important; white-space: nowrap; "
    "vertical-align: top; padding: 0.25em 0.8em; } "
    ".moro-table math { font-size: 1.1em; }</style>"
)


class Table:
    """Rows of values under headings. ``rows`` are tuples; iterating and indexing give them.

    Text stays text, anything else is mathematics, in the notation of ``moro.printing.notation``;
    headings that are a single letter or the name of a Greek one are mathematics too. ``table[i,
    j]`` and ``shape`` see the table as it is printed, with its headings as row 0: ``dh_table[1,
    1]`` is a_1.
    ``"words" in table`` looks for text in what prints.
    """

    def __init__(
        self,
        headings: Sequence[str],
        rows: Sequence[Sequence[Any]],
        notation: Notation | None = None,
    ):
        self.headings = tuple(headings)
        self.rows = tuple(tuple(row) for row in rows)
        self._notation = notation or Notation()

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows, that of the headings included, and of columns."""
        return len(self.rows) + 1, len(self.headings)

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, tuple):
            row, column = i
            return (self.headings, *self.rows)[row][column]
        return self.rows[i]

    def __contains__(self, item: object) -> bool:
        return item in repr(self) if isinstance(item, str) else item in self.rows

    def __repr__(self) -> str:
        lines = [self.headings, *([_text(x) for x in row] for row in self.rows)]
        cells = [list(line) for line in lines]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        text = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in cells]
        rule = "  ".join("-" * width for width in widths)
        return "\n".join([text[0], rule, *text[1:]])

    def formulas(self) -> list[list[Formula]]:
        """Return the headings and the rows, every cell a formula to print."""
        cells = [[self._cell(x) for x in row] for row in self.rows]
        return [[_heading(words) for words in self.headings], *cells]

    def latex(self) -> str:
        """Return the table as a LaTeX array."""
        head, *lines = (" & ".join(map(latex, row)) for row in self.formulas())
        body = r" \\ ".join(lines)
        columns = "c" * len(self.headings)
        return rf"\begin{{array}}{{{columns}}} {head} \\ \hline {body} \end{{array}}"

    def html(self) -> str:
        """Return the table in HTML, its formulas in MathML, which browsers set by themselves."""
        head = "".join(f"<th>{_head_cell(words)}</th>" for words in self.headings)
        rows = ("".join(f"<td>{self._html_cell(x)}</td>" for x in row) for row in self.rows)
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        return (
            f'<table class="moro-table"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
        )

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def _repr_html_(self) -> str:
        return f'<div style="overflow-x: auto">{_STYLE}{self.html()}</div>'

    def _html_cell(self, x: Any) -> str:
        return escape(x) if isinstance(x, str) else math_lines(self._cell(x), _WIDEST_CELL)

    def _cell(self, value: Any) -> Formula:
        return [text(value)] if isinstance(value, str) else self._notation.formula(value)


def _text(value: Any) -> str:
    return plain(value) if isinstance(value, sp.Basic) else str(value)


def _is_letter(words: str) -> bool:
    return len(words) == 1 or words in GREEK


def _heading(words: str) -> Formula:
    return [letter(words) if _is_letter(words) else text(words)]


def _head_cell(words: str) -> str:
    return math_lines(_heading(words), _WIDEST_CELL) if _is_letter(words) else escape(words)
