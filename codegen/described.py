"""What users of a program must know of the model it is of: frames, gravity, its parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from moro.model import Model
from moro_codegen.generate import Program


def described(program: Program, model: Model) -> Program:
    """Return the program with the model's convention and gravity, and what its parameters are."""
    where = {str(parameter.symbol): parameter.meaning for parameter in model.parameters}
    is_set = "gravity" not in model.not_set
    return replace(
        program,
        convention=model.convention,
        gravity=tuple(map(_text, model.gravity)) if is_set else None,
        parameters=tuple(replace(p, description=where.get(p.name, "")) for p in program.parameters),
    )


def _text(value: Any) -> str:
    """Return a number as a decimal, an expression as SymPy writes it."""
    return f"{float(value):.15g}" if sp.sympify(value).is_Rational else str(value)
