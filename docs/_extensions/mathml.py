"""Formulas as MathML, which browsers typeset by themselves: no script, no network, real text."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from math_core import LatexError, LatexToMathML
from sphinx.util import logging

_logger = logging.getLogger(__name__)
_converter = LatexToMathML(fancy_error=False)


def setup(app: Any) -> dict[str, Any]:
    """Offer the renderer to Sphinx as "mathml"."""
    app.add_html_math_renderer("mathml", (_visit_inline, None), (_visit_block, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _visit_inline(self: Any, node: nodes.math) -> None:
    self.body.append(_mathml(node, displaystyle=False))
    raise nodes.SkipNode


def _visit_block(self: Any, node: nodes.math_block) -> None:
    self.body.append(self.starttag(node, "div", CLASS="math"))
    self.body.append(_mathml(node, displaystyle=True))
    self.body.append("</div>\n")
    raise nodes.SkipNode


def _mathml(node: nodes.Element, *, displaystyle: bool) -> str:
    try:
        return _converter.convert_with_local_state(node.astext(), displaystyle=displaystyle)
    except LatexError as error:
        _logger.warning("formula %s: %s", node.astext(), error, location=node)
        return ""
