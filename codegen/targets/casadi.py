"""CasADi: a library of external functions, with their exact first and second derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from moro_codegen.backends import c_text
from moro_codegen.emit.render import render
from moro_codegen.program import Program, Routine
from moro_codegen.signature import Signature
from moro_codegen.targets import Export, Target
from moro_codegen.targets.derivatives import MOST, Differentiable, Matrix, differentiated
from moro_codegen.targets.python import made


class CasADi(Target):
    """Sources and a Makefile of a library for ``casadi.external``."""

    name = "casadi"
    reserved = c_text.RESERVED | {"given", "room", "put"}

    def files(self, export: Export) -> dict[str, str]:
        """Return sources, Makefile and words.

        Raise ValueError for single precision, and for functions called like another's derivatives.
        """
        if export.program.scalar != "double":
            raise ValueError("CasADi computes in double precision: leave out --scalar float")
        functions = list(differentiated(export.model, export.program))
        _distinct(functions)
        routines = {r.function.name: r for r in export.program.routines}
        routines |= {d.name: d.routine for _, more in functions for d in more if d.routine}
        whole = replace(export.program, routines=tuple(routines.values()))
        name = export.name
        holes: dict[str, Any] = {
            "name": name,
            "functions": list(_externals(whole, functions, routines)),
            "described": [_described(f, more) for f, more in functions],
            "parameters": [x.name for x in export.program.parameters],
            "most": f"{MOST:,}",
            "made": made(export),
        }
        return {
            **c_text.emit(whole, batch=False),
            f"{name}_casadi.c": render("export_casadi.c.jinja", **holes),
            "Makefile": render("export_casadi_makefile.jinja", **holes),
            "README.md": render("export_casadi_readme.md.jinja", **holes),
        }


def _distinct(functions: Sequence[tuple[Differentiable, Sequence[Differentiable]]]) -> None:
    """Raise ValueError if a function is called like the derivatives of another."""
    own = {f.name for f, _ in functions}
    for f, more in functions:
        for d in more:
            if d.name in own:
                raise ValueError(f"no function can be called {d.name}: to CasADi it is {f.name}'s")


def _described(f: Differentiable, derivatives: Sequence[Differentiable]) -> dict[str, Any]:
    """Return what the words say of a function."""
    there = {d.name for d in derivatives}
    return {
        "call": f"{f.name}({', '.join(a.name for a in f.inputs)})",
        "results": ", ".join(a.name for a in f.outputs),
        "first": f"jac_{f.name}" in there,
        "second": f"jac_adj1_{f.name}" in there,
    }


def _externals(
    program: Program,
    functions: Sequence[tuple[Differentiable, Sequence[Differentiable]]],
    routines: dict[str, Routine],
) -> Iterator[dict[str, Any]]:
    """Yield what the template says of every function and every derivative."""
    for f, derivatives in functions:
        for d in (f, *derivatives):
            routine = routines.get(d.name)
            signature = program.signature(routine) if routine else None
            yield _external(d, program.name, signature, d is f)


def _external(f: Differentiable, prefix: str, s: Signature | None, rowwise: bool) -> dict[str, Any]:
    """Return what the template says of a function; ``rowwise``: its matrices come row by row."""
    names = [a.name for a in f.inputs]
    taken = [{"index": names.index(a.name), "size": a.size} for a in s.inputs] if s else []
    results = []
    for k, a in enumerate(f.outputs):
        if size := len(a.places):
            rows, columns = (a.rows, a.columns) if rowwise else (size, 1)
            results.append({"index": k, "rows": rows, "columns": columns, "size": size})
    arguments = [f"x{k}" for k in range(len(taken))] + [f"y{k}" for k in range(len(results))]
    return {
        "name": f.name,
        "inputs": [{"name": a.name, "pattern": _pattern(a)} for a in f.inputs],
        "outputs": [{"name": a.name, "pattern": _pattern(a)} for a in f.outputs],
        "taken": taken,
        "results": results,
        "call": s and f"{prefix}_{s.name}({', '.join(arguments)})",
        "work": sum(a["size"] for a in (*taken, *results)),
    }


def _pattern(a: Matrix) -> list[int]:
    """Return which entries there are, as CasADi has it: all, or by columns."""
    if a.entries and len(a.places) == a.size:
        return [a.rows, a.columns, 1]
    columns = [k // a.rows for k in a.places]
    starts = [sum(c < column for c in columns) for column in range(a.columns + 1)]
    return [a.rows, a.columns, *starts, *(k % a.rows for k in a.places)]


TARGET = CasADi()
