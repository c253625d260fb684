"""Results as Jupyter shows them: formulas in MathML and LaTeX, whole pages in a frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any, ClassVar

from moro.printing.equations import Equation, html_table, latex_rows
from moro.printing.notation import Notation

#: longer than this, Jupyter gets plain text: MathJax takes long
_MAX_LATEX_LINES = 200
#: and in MathML, which needs no script
_MAX_HTML_LINES = 2000
#: of lines [em]
WIDTH = 60.0
_STYLE = (
    "<style>.equations td { text-align: left !important; white-space: nowrap; "
    "vertical-align: baseline; padding: 0.15em 0.1em; background: none; } "
    ".equations td:first-child { text-align: right !important; } "
    ".equations tr { background: none !important; } "  # which notebooks stripe
    ".equations math { font-size: 1.1em; } "
    ".equations mover > mo { padding-block-end: 0.1em; }</style>"  # dots clear the letter
)


class Shown:
    """What shows as formulas: a class says in ``formulas`` which, and gets the rest from here."""

    def formulas(self) -> Sequence[Equation]:
        """Return the equations to print."""
        raise NotImplementedError

    def latex(self, width: float = WIDTH) -> str:
        """Return the formulas as an ``aligned`` environment, lines ``width`` em wide."""
        body = " \\\\\n".join(latex_rows(self.formulas(), width))
        return f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}"

    def html(self, width: float = WIDTH) -> str:
        """Return the formulas as a table with MathML, lines ``width`` em wide."""
        return html_table(self.formulas(), width)

    def _repr_latex_(self) -> str | None:
        """In Jupyter; None, for plain text, if that would be too much for it."""
        code = self.latex()
        return f"$\\displaystyle {code}$" if code.count("\n") <= _MAX_LATEX_LINES else None

    def _repr_html_(self) -> str | None:
        table = self.html()
        if table.count("\n") > _MAX_HTML_LINES:
            return None
        return f'<div style="overflow: auto; max-height: 48em">{_STYLE}{table}</div>'


class Equations(list[Any], Shown):
    """A list of equations (SymPy's ``Eq``) that shows as formulas, right-hand sides first.

    ``notation`` writes them. Whatever is made of the list, a slice say, is a plain list.
    """

    def __init__(self, equations: Iterable[Any], notation: Notation):
        super().__init__(equations)
        self._notation = notation

    def formulas(self) -> list[Equation]:
        """Return tau_i = ..., the side that is one symbol on the left, to print."""
        write = self._notation.formula
        return [Equation(write(x.rhs), write(x.lhs)) for x in self]


class Page(str):
    """A page of HTML, a text, that Jupyter shows in a frame of its own."""

    __slots__ = ()
    #: of the frame
    height: ClassVar[str] = "40em"

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}; border: 1px solid #ccc; background: #fff"
        return f'<iframe srcdoc="{escape(self)}" style="{style}"></iframe>'
