"""A page of text, formulas and tables, and its way through the templates to LaTeX and HTML."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Literal, TypeAlias

import jinja2
from markupsafe import Markup

from moro.printing.equations import Equation, html_table, latex_rows, math, pages
from moro.printing.markup import markup
from moro.printing.typeset import Formula, escaped_latex, latex, width

Format: TypeAlias = Literal["tex", "html"]
#: room for a line [em]: A4 with margins of 20 mm in 10 pt, a browser window
PAGE_WIDTH = {"tex": 46.0, "html": 58.0}
#: LaTeX keeps an environment in memory: not too many lines in one
_MAX_LINES = 40


@dataclass(frozen=True)
class Paragraph:
    """Text, and formulas within it."""

    parts: Sequence[str | Formula]
    kind: ClassVar[str] = "paragraph"


@dataclass(frozen=True)
class Aligned:
    """Equations one below the other, broken into lines."""

    equations: Sequence[Equation]
    kind: ClassVar[str] = "equations"

    def groups(self, width: float) -> Iterator[list[str]]:
        """Yield the lines in LaTeX, those of some equations at a time."""
        for equations in pages(self.equations, width, _MAX_LINES):
            yield latex_rows(equations, width)

    def html(self, width: float) -> str:
        """Return the equations as a table."""
        return html_table(self.equations, width)


@dataclass(frozen=True)
class Tabular:
    """A table; the first row is its head."""

    rows: Sequence[Sequence[Formula]]
    kind: ClassVar[str] = "table"

    @property
    def width(self) -> float:
        """Estimated width [em]."""
        columns = zip(*self.rows, strict=True)
        return sum(1.2 + max(map(width, column)) for column in columns)


@dataclass(frozen=True)
class Displayed:
    """A formula on a line of its own."""

    formula: Formula
    kind: ClassVar[str] = "displayed"


Block: TypeAlias = "Paragraph | Aligned | Tabular | Displayed"


@dataclass(frozen=True)
class Section:
    """A title and what stands below it."""

    title: str
    blocks: Sequence[Block]


def paragraph(words: str) -> Paragraph:
    r"""Read text with formulas in it: ``"Frame $i$ moves with link $i$."``."""
    parts = re.split(r"\$([^$]*)\$", words)
    return Paragraph([markup(x) if i % 2 else x for i, x in enumerate(parts) if x])


def render(title: str, sections: Sequence[Section], target: Format) -> str:
    """Return the whole document in LaTeX or as a self-contained HTML page."""
    template = _environment(target).get_template(f"report.{target}.jinja")
    return template.render(title=title, sections=sections, page=PAGE_WIDTH[target])


@cache
def _environment(target: Format) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("moro.report", "templates"),
        autoescape=target == "html",  # noqa: S701 - LaTeX has its own filter
        undefined=jinja2.StrictUndefined,
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "tex": escaped_latex,
        "latex": latex,
        "math": lambda formula: Markup(math(formula)),  # noqa: S704 - boxes escape their text
        "inline_tex": lambda x: escaped_latex(x) if isinstance(x, str) else f"${latex(x)}$",
        "inline_html": lambda x: x if isinstance(x, str) else Markup(math(x)),  # noqa: S704
    }
    return environment
