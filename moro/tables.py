"""Small tables that print well as text, in Jupyter and in LaTeX."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

from moro.notation import Notation
from moro.typeset import GREEK, Formula, latex, letter, mathml, text


class Table:
    """Rows of values under headings. ``rows`` are tuples; iterating and indexing give them.

    Text stays text, anything else is mathematics, in the notation of ``moro.notation``; headings
    that are a single letter or the name of a Greek one are mathematics too.
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
        """Return the table in HTML, its formulas in MathML."""
        return self._html(lambda x: f"<math>{mathml(self._cell(x))}</math>")

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def _repr_html_(self) -> str:
        return self._html(lambda x: f"${escape(latex(self._cell(x)))}$")

    def _html(self, mathematics: Any) -> str:
        def cell(x: Any) -> str:
            return escape(x) if isinstance(x, str) else str(mathematics(x))

        head = "".join(f"<th>{escape(words)}</th>" for words in self.headings)
        rows = ("".join(f"<td>{cell(x)}</td>" for x in row) for row in self.rows)
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def _cell(self, value: Any) -> Formula:
        return [text(value)] if isinstance(value, str) else self._notation.formula(value)


def _heading(words: str) -> Formula:
    return [letter(words) if len(words) == 1 or words in GREEK else text(words)]
