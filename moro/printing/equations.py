"""Equations one below the other, right-hand sides broken into lines: in LaTeX and in HTML."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from moro.printing.markup import markup
from moro.printing.typeset import Formula, Line, broken, latex, mathml, matrix, width

#: the relation sign with its spaces [em]
_RELATION = 1.5


@dataclass(frozen=True)
class Equation:
    """left = right."""

    left: Formula
    right: Formula


@dataclass(frozen=True)
class EquationLine:
    """A line of an equation: the left-hand side stands on the first one only."""

    left: Formula | None
    line: Line


def entries(name: str, M: Any, write: Callable[[Any], Formula]) -> Iterator[Equation]:
    """Yield the entries of a matrix that are not zero, of a symmetric one those from M_ii on."""
    count, columns = M.shape
    comma = "," if max(M.shape) > 9 else ""
    symmetric = count == columns > 1 and M == M.T
    single = f"({name})" if "_" in name or "^" in name else name
    for i in range(count):
        for j in range(i if symmetric else 0, columns):
            if M[i, j] != 0:
                at = comma.join(map(str, (i + 1, j + 1) if columns > 1 else (i + 1,)))
                yield Equation(markup(f"{single}_{{{at}}}"), write(M[i, j]))


def in_brackets(name: str, M: Any, write: Callable[[Any], Formula], limit: float) -> list[Equation]:
    """Return a matrix in one equation if that is no wider than ``limit`` [em], else its entries."""
    whole = Equation(markup(name), [matrix([[write(x) for x in row] for row in M.tolist()])])
    if width(whole.left) + _RELATION + width(whole.right) <= limit:
        return [whole]
    return list(entries(name, M, write))


def rows(equations: Sequence[Equation], limit: float) -> Iterator[EquationLine]:
    """Yield the lines of equations that are aligned at the equals sign, ``limit`` em wide."""
    room = limit - max((width(x.left) for x in equations), default=0.0) - _RELATION
    for equation in equations:
        for i, line in enumerate(broken(equation.right, room)):
            yield EquationLine(None if i else equation.left, line)


def latex_rows(equations: Sequence[Equation], limit: float) -> list[str]:
    r"""Return the lines for an ``align*`` or ``aligned`` environment, without ``\\``."""
    return [_latex_row(row) for row in rows(equations, limit)]


def pages(equations: Sequence[Equation], limit: float, most: int) -> Iterator[list[Equation]]:
    """Yield equations some at a time, with up to ``most`` lines if each has less than that."""
    part: list[Equation] = []
    count = 0
    for equation in equations:
        lines = len(list(rows([equation], limit)))
        if part and count + lines > most:
            yield part
            part, count = [], 0
        part.append(equation)
        count += lines
    yield part


def html_table(equations: Sequence[Equation], limit: float) -> str:
    """Return a table with the equations in MathML."""
    body = "\n".join(_html_row(row) for row in rows(equations, limit))
    return f'<table class="equations">\n{body}\n</table>'


def _latex_row(row: EquationLine) -> str:
    if row.left is None:
        return rf"&\hspace{{{row.line.indent + _RELATION:g}em}}{latex(row.line.boxes)}"
    return f"{latex(row.left)} &= {latex(row.line.boxes)}"


def _html_row(row: EquationLine) -> str:
    indent = f' style="padding-left:{row.line.indent:g}em"' if row.line.indent else ""
    left = "" if row.left is None else math(row.left)
    relation = "" if row.left is None else "<math><mo>=</mo></math>"
    right = math(row.line.boxes)
    return f"<tr><td>{left}</td><td>{relation}</td><td{indent}>{right}</td></tr>"


def math_lines(formula: Formula, limit: float) -> str:
    """Return a formula as MathML, broken into lines ``limit`` em wide."""
    return "<br/>".join(math(line.boxes) for line in broken(formula, limit))


def math(formula: Formula) -> str:
    """Return a formula as an element ``math``."""
    return f"<math>{mathml(formula)}</math>"
