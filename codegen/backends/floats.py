"""A routine as a Python function of lists of floats: for one sample, less work than arrays are.

Its results are those of the NumPy module to the last bit: the same operations in the same order,
NumPy's own sines and cosines. A division by zero raises ZeroDivisionError.
"""

from __future__ import annotations

import keyword
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from moro_codegen.backends.numpy import NAMES, RESERVED, far
from moro_codegen.emit.render import render
from moro_codegen.emit.statements import (
    FAR,
    Assign,
    Call,
    Load,
    ReduceAngles,
    Sines,
    Statement,
    body,
)

if TYPE_CHECKING:
    from moro_codegen.program import Program, Routine


def emit(program: Program) -> str:
    """Return the text of a module with a function for each routine.

    A function takes a flat list of floats for each input, and returns one flat list a result.
    """
    routines = [_holes(program, routine) for routine in program.routines]
    return render("floats.py.jinja", routines=routines, far=far(program, routines))


def _holes(program: Program, routine: Routine) -> dict[str, Any]:
    inputs = program.signature(routine).inputs
    arguments = {a.name for a in (*inputs, *routine.outputs)}
    text = body(program, routine, {*RESERVED, *keyword.kwlist, "float", *arguments})
    limit = FAR[program.scalar]
    lines = [line for statement in text.statements for line in _statement(statement, limit)]
    results = iter(text.results)
    returned = [f"[{', '.join(next(results) for _ in range(a.size))}]" for a in routine.outputs]
    return {
        "name": routine.function.name,
        "parameters": ", ".join(a.name for a in inputs),
        "body": [*lines, f"return {', '.join(returned)},"],
    }


def _statement(statement: Statement, limit: float) -> Iterator[str]:
    match statement:
        case Load(name, argument, index):
            yield f"{name} = {argument}[{index}]"
        case Assign(name, expression):
            yield f"{name} = {expression}"
        case Call(name, function, arguments):
            call = f"np.{NAMES.get(function, function)}({', '.join(arguments)})"
            yield f"{name} = float({call})"
        case ReduceAngles(names, angles, _):
            for name, angle in zip(names, angles, strict=True):
                near = f"-{limit} <= {angle} <= {limit}"
                yield f"{name} = {angle} if {near} else _turned({angle})"
        case Sines(angles, pairs, (array, *_)):
            yield f"{array} = np.array([{', '.join(angles)}])"
            for function, names in zip(("sin", "cos"), zip(*pairs, strict=True), strict=True):
                if any(names):
                    targets = ", ".join(name or "_" for name in names)
                    yield f"[{targets}] = np.{function}({array}).tolist()"
