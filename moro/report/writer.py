"""Blocks of a page from the quantities of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import sympy as sp

from moro.formats.source import Source
from moro.mechanics import Mechanics
from moro.printing.collect import Collector
from moro.printing.equations import Equation, entries, rows
from moro.printing.markup import markup
from moro.printing.typeset import Box, Formula, matrix, scripts, width
from moro.report.page import Aligned, Block, Displayed, Paragraph, Tabular


class Writer:
    """Writes quantities of ``robot``, made of ``source``, for a page that is ``page`` em wide."""

    def __init__(self, robot: Mechanics, source: Source, collector: Collector, page: float):
        self.robot = robot
        self.source = source
        self.collector = collector
        self.model = source.model()
        self.notation = source.notation
        #: coordinates from 1, and links
        self.numbers = range(1, robot.dof + 1)
        self.links = range(1, len(self.model.bodies) + 1)
        self._page = page

    def write(self, expr: Any) -> Formula:
        """Return a SymPy expression as a formula."""
        return self.notation.formula(expr)

    def index(self, *numbers: int) -> str:
        """Return a subscript, with commas where an arm has more than nine joints."""
        return ("," if self.robot.dof > 9 else "").join(map(str, numbers))

    def equation(self, name: str, value: Any) -> Equation:
        """Return an equation: its left-hand side in markup, the right one an expression."""
        return Equation(markup(name), self.write(value))

    def transform(self, name: str, T: Any) -> Iterator[Block]:
        """Yield a transform, without its last row where only entries are listed."""
        displayed, *_ = self.matrix(name, T)
        yield displayed if isinstance(displayed, Displayed) else next(self.matrix(name, T[:3, :]))

    def matrix(self, name: str, M: Any) -> Iterator[Block]:
        """Yield a matrix in brackets if it fits on a line, else its entries but zeros."""
        formulas = [[self.write(x) for x in row] for row in sp.Matrix(M).tolist()]
        displayed = self.displayed(name, matrix(formulas))
        yield displayed or Aligned(list(self.entries(name, M)) or [self.equation(name, 0)])

    def vector(self, name: str, v: Any) -> Iterator[Block]:
        """Yield a column as a transposed row if it fits on a line, else its entries."""
        row = matrix([[self.write(x) for x in v]])
        displayed = self.displayed(name, scripts(row, None, markup("T")))
        yield displayed or Aligned(list(self.entries(name, v)) or [self.equation(name, 0)])

    def displayed(self, name: str, *boxes: Box) -> Displayed | None:
        """Return ``name = boxes`` on a line of its own, None if it does not fit."""
        formula = [*markup(name), *markup("="), *boxes]
        return Displayed(formula) if width(formula) <= self._page else None

    def entries(self, name: str, M: Any) -> Iterator[Equation]:
        """Yield the entries that are not zero, of a symmetric matrix those from M_ii on."""
        return entries(name, M, self.write)

    def columns(self, columns: Mapping[str, Sequence[Any]]) -> Iterator[Block]:
        """Yield a table of values, by link or by coordinate."""
        rows = enumerate(zip(*columns.values(), strict=True), 1)
        lines = [[self.write(i), *map(self.write, row)] for i, row in rows]
        yield from self.table(["i", *columns], lines)

    def table(
        self, heads: Sequence[str | Formula], lines: Sequence[Sequence[Formula]]
    ) -> Iterator[Block]:
        """Yield a table by joint or link, as wide as the page at most.

        Heads that are markup name their cells, a_2 below a_i: as many of the widest cells as
        necessary hold their names, whose values follow. If that is not enough, the table is a list.
        """
        first = [markup(head) if isinstance(head, str) else head for head in heads]
        rows, moved = [list(line) for line in lines], dict[tuple[int, int], Equation]()
        columns = [k for k, head in enumerate(heads) if k and isinstance(head, str)]
        places = product(range(len(rows)), columns)
        for i, k in sorted(places, key=lambda at: -width(lines[at[0]][at[1]])):
            if Tabular([first, *rows]).width <= self._page:
                break
            name = markup(_numbered(str(heads[k]), i + 1))
            moved[i, k], rows[i][k] = Equation(name, rows[i][k]), name
        table = Tabular([first, *rows])
        if table.width > self._page:
            yield from self._listed(first, lines)
            return
        yield table
        if moved:
            yield Paragraph(["Here"])
            yield Aligned([moved[at] for at in sorted(moved)])

    def _listed(
        self, heads: Sequence[Formula], lines: Sequence[Sequence[Formula]]
    ) -> Iterator[Block]:
        for number, *values in lines:
            yield Paragraph(["Row ", number, ":"])
            pairs = zip(heads[1:], values, strict=True)
            yield Aligned([Equation(head, value) for head, value in pairs])

    def definitions(self, constants: Mapping[Any, Any]) -> Aligned:
        """Return what names stand for."""
        return Aligned([Equation(self.write(k), self.write(x)) for k, x in constants.items()])

    def lines(self, equations: Iterable[Equation]) -> int:
        """Return how many lines equations take on the page."""
        return sum(1 for _ in rows(list(equations), self._page))


def _numbered(head: str, i: int) -> str:
    """Return markup for number i: a_{2} for ``a_i``, a_{1} for ``a_{i-1}``."""
    head = head.replace("i-1", str(i - 1))
    return re.sub(r"(?<![A-Za-z\\])i(?![A-Za-z])", f"{{{i}}}", head)
