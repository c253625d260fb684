"""The folder templates/: text with holes. What goes into the holes is decided in Python."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

import jinja2

import moro
from moro_codegen.emit.escape import c_comment, python_docstring


def render(template: str, **holes: Any) -> str:
    """Return a template of ``moro_codegen.templates`` with its holes filled."""
    return _environment().get_template(template).render(holes)


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("moro_codegen.templates", ""),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - C and Python, not HTML
    )
    environment.globals["version"] = moro.__version__
    environment.filters |= {
        "c_comment": c_comment,
        "docstring": python_docstring,
        "python": repr,
        "zip": partial(zip, strict=True),
    }
    return environment
