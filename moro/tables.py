"""Small tables that print well as text, in Jupyter and in LaTeX."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

import sympy as sp


class Table:
    """Rows of values under headings. ``rows`` are tuples; iterating and indexing give them."""

    def __init__(self, headings: Sequence[str], rows: Sequence[Sequence[Any]]):
        self.headings = tuple(headings)
        self.rows = tuple(tuple(row) for row in rows)

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, i: int) -> tuple[Any, ...]:
        return self.rows[i]

    def __repr__(self) -> str:
        lines = [self.headings, *((str(x) for x in row) for row in self.rows)]
        cells = [list(line) for line in lines]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        text = ["  ".join(map(str.ljust, line, widths)).rstrip() for line in cells]
        rule = "  ".join("-" * width for width in widths)
        return "\n".join([text[0], rule, *text[1:]])

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(text)}</th>" for text in self.headings)
        body = "".join(
            "<tr>" + "".join(f"<td>{_html(x)}</td>" for x in row) + "</tr>" for row in self.rows
        )
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def latex(self) -> str:
        """Return the table as a LaTeX array."""
        lines = [[f"\\text{{{text}}}" for text in self.headings]]
        lines += [[_latex(x) for x in row] for row in self.rows]
        body = " \\\\ ".join(" & ".join(line) for line in lines[1:])
        return (
            f"\\begin{{array}}{{{'c' * len(self.headings)}}} "
            f"{' & '.join(lines[0])} \\\\ \\hline {body} \\end{{array}}"
        )


def _latex(value: Any) -> str:
    return f"\\text{{{value}}}" if isinstance(value, str) else str(sp.latex(value))


def _html(value: Any) -> str:
    return escape(value) if isinstance(value, str) else f"${sp.latex(value)}$"
