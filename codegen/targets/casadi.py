"""CasADi: a library of external functions, dense, with Jacobians by the derivative kernels."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from moro_codegen.backends import c_text
from moro_codegen.emit.render import render
from moro_codegen.functions.arguments import Argument
from moro_codegen.program import Program, generate
from moro_codegen.signature import Signature
from moro_codegen.targets import Export, Target
from moro_codegen.targets.python import made

#: {function: (the one that has its derivatives, what that takes, its results by the inputs)}
#: a dot stands for zeros
DERIVATIVES = {
    "tau": ("tau_derivatives", "q qd qdd", (0, 1, 2)),
    "bias": ("tau_derivatives", "q qd .", (0, 1)),
    "gravity_vector": ("tau_derivatives", "q . .", (0,)),
    "forward_dynamics": ("forward_dynamics_derivatives", "q qd tau", (0, 1, 2)),
}


class CasADi(Target):
    """Sources and a Makefile of a library for ``casadi.external``."""

    name = "casadi"
    reserved = c_text.RESERVED | {"given", "room", "put"}

    def files(self, export: Export) -> dict[str, str]:
        """Return sources, Makefile and words. Raise ValueError for single precision."""
        if export.program.scalar != "double":
            raise ValueError("CasADi computes in double precision: leave out --scalar float")
        whole = _with_derivatives(export)
        name = export.name
        holes: dict[str, Any] = {
            "name": name,
            "functions": list(_functions(export.program, whole)),
            "parameters": [x.name for x in export.program.parameters],
            "made": made(export),
        }
        return {
            **c_text.emit(whole),
            f"{name}_casadi.c": render("export_casadi.c.jinja", **holes),
            "Makefile": render("export_casadi_makefile.jinja", **holes),
            "README.md": render("export_casadi_readme.md.jinja", **holes),
        }


def _with_derivatives(export: Export) -> Program:
    """Return the program with the functions that have its functions' derivatives."""
    program = export.program
    if program.parameters:
        return program
    there = {s.name for s in program.signatures}
    needed = dict.fromkeys(DERIVATIVES[x][0] for x in there if x in DERIVATIVES)
    more = tuple(x for x in needed if x not in there)
    if not more:
        return program
    return replace(program, routines=(*program.routines, *generate(export.model, more).routines))


def _functions(asked: Program, whole: Program) -> Iterator[dict[str, Any]]:
    signatures = {s.name: s for s in whole.signatures}
    for s in asked.signatures:
        needed, takes, blocks = DERIVATIVES.get(s.name, ("", "", ()))
        known = needed in signatures and not asked.parameters
        yield {**_external(asked.name, s), "has_jacobian": known, "is_jacobian": False}
        if known:
            yield _jacobian(asked.name, s, signatures[needed], takes.split(), blocks)


def _external(prefix: str, s: Signature) -> dict[str, Any]:
    """Return what the template says of a function."""
    inputs, outputs = list(map(_array, s.inputs)), list(map(_array, s.outputs))
    taken = [{"given": f"arg[{k}]", "size": a["size"]} for k, a in enumerate(inputs)]
    results = [{**a, "from": k} for k, a in enumerate(outputs)]
    return {"name": s.name, "inputs": inputs, **_called(prefix, s, taken), "results": results}


def _jacobian(
    prefix: str, s: Signature, by: Signature, takes: list[str], blocks: tuple[int, ...]
) -> dict[str, Any]:
    """Return jac_f, which CasADi hands the results of f too."""
    names = [a.name for a in s.inputs]
    (out,) = s.outputs
    inputs = [*map(_array, s.inputs), {**_array(out), "name": f"out_{out.name}"}]
    taken = [
        {"given": "NULL" if x == "." else f"arg[{names.index(x)}]", "size": a.size}
        for x, a in zip(takes, by.inputs, strict=True)
    ]
    results = [
        {**_array(by.outputs[k]), "from": k, "name": f"jac_{out.name}_{x}"}
        for k, x in zip(blocks, names, strict=True)
    ]
    return {
        "name": f"jac_{s.name}",
        "inputs": inputs,
        **_called(prefix, by, taken),
        "results": results,
        "has_jacobian": False,
        "is_jacobian": True,
    }


def _called(prefix: str, s: Signature, taken: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the call of a function of the kernel, and the work space that it takes."""
    outputs = [_array(a) for a in s.outputs]
    arguments = [f"x{k}" for k in range(len(taken))] + [f"y{k}" for k in range(len(outputs))]
    return {
        "taken": taken,
        "made": outputs,
        "call": f"{prefix}_{s.name}({', '.join(arguments)})",
        "work": sum(a["size"] for a in (*taken, *outputs)),
    }


def _array(a: Argument) -> dict[str, Any]:
    """Return an array as a matrix of CasADi's."""
    rows = a.sizes[0] if a.sizes else 1
    return {
        "name": a.name,
        "rows": rows,
        "columns": math.prod(a.sizes[1:]),
        "size": a.size,
    }


TARGET = CasADi()
