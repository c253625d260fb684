"""C99 that builds anywhere: source, header, builds by CMake and make, and a test for the target."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import moro
from moro_codegen.backends import c_text
from moro_codegen.emit.describe import (
    argument_lines,
    conventions,
    operations,
    parameter_lines,
    wrapped,
)
from moro_codegen.emit.escape import c_string, printable
from moro_codegen.emit.render import render
from moro_codegen.emit.statements import Identifiers, literal
from moro_codegen.functions.arguments import Argument
from moro_codegen.proof.golden import GoldenFunction, GoldenResult
from moro_codegen.targets import Export, Target
from moro_codegen.targets.tables import numbers, rows


class C(Target):
    """A folder that CMake and make build, install and test."""

    name = "c"
    reserved = c_text.RESERVED

    def files(self, export: Export) -> dict[str, str]:
        """Return sources, builds, examples and words."""
        return files(export)


def files(export: Export, *, cpp: bool = False) -> dict[str, str]:
    """Return the texts of all files; ``cpp``: there is a header of C++ beside them."""
    name, holes = export.name, {**described(export), "cpp": cpp}
    texts = sources(export)
    for path, template in {
        "CMakeLists.txt": "export_cmakelists.txt.jinja",
        f"{name}-config.cmake.in": "export_config.cmake.in.jinja",
        f"{name}.pc.in": "export_pc.in.jinja",
        "Makefile": "export_makefile.jinja",
        "cortex_m.c": "export_cortex_m.c.jinja",
        "cortex_m.cmake": "export_cortex_m.cmake.jinja",
        "README.md": "export_c_readme.md.jinja",
        "selftest.c": "export_selftest.c.jinja",
    }.items():
        texts[path] = render(template, **holes)
    if holes["computed_torque"]:
        texts["computed_torque.c"] = render("export_computed_torque.c.jinja", **holes)
    return texts


def sources(export: Export) -> dict[str, str]:
    """Return the texts of source and header."""
    program, upper = export.program, export.name.upper()
    holes = described(export)
    data = render("export_data.c.jinja", **holes).rstrip("\n")
    sincos = f"{upper}_SINCOS"
    return {
        f"{export.name}.c": c_text.source(program, batch=export.batch, sincos=sincos, data=data),
        f"{export.name}.h": render("export_kernel.h.jinja", **holes),
    }


def described(export: Export) -> dict[str, Any]:
    """Return what the templates say of an export."""
    program, model = export.program, export.model
    f = c_text.suffix(program)
    names = [x.name for x in model.coordinates]
    tau = next((g.signature for g in export.golden.functions if g.signature.name == "tau"), None)
    is_usual = tau is not None and [a.name for a in tau.given] == ["q", "qd", "qdd"]
    return {
        **c_text.described(program),
        "name": export.name,
        "upper": export.name.upper(),
        "robot": printable(model.name),
        "n": program.dof,
        "real": program.scalar,
        "f": f,
        "batch": export.batch,
        "hash": export.model_hash,
        "command": export.command,
        "call": export.call,
        "project_version": re.match(r"\d+(\.\d+)*", moro.__version__)[0],  # type: ignore[index]
        "conventions": conventions(program),
        "joint_names": [c_string(name) for name in names],
        "limits": [[_limit(x, f) for x in pair] for pair in zip(*limits(export), strict=True)],
        "limit_lines": list(_limit_lines(export)),
        "parameters": parameters(export),
        "parameter_lines": parameter_lines(program),
        "functions": [_function(export, g) for g in export.golden.functions],
        "states": max((g.states for g in export.golden.functions), default=0),
        "checked": [_checked(g, f) for g in export.golden.functions if any(g.results)],
        "unchecked": list(export.golden.unchecked),
        "golden_tolerance": literal(export.golden.tolerance, f),
        "computed_torque": is_usual,
        "reducible": c_text.SCALARS[program.scalar]["reducible"],
    }


def limits(export: Export) -> tuple[list[float], list[float]]:
    """Return the lower and upper limits of the coordinates; infinities where none are given.

    Those that depend on run-time parameters are taken at their defaults, if these have all.
    """
    model = export.model
    defaults = {s: x for s, x in model.defaults.items() if x is not None}

    def number(value: Any, otherwise: float) -> float:
        value = value.xreplace(defaults) if hasattr(value, "xreplace") else value
        return otherwise if getattr(value, "free_symbols", None) else float(value)

    pairs = [
        (-math.inf, math.inf) if x.limits is None
        else (number(x.limits[0], -math.inf), number(x.limits[1], math.inf))
        for x in model.coordinates
    ]  # fmt: skip
    return [low for low, _ in pairs], [high for _, high in pairs]


def parameters(export: Export) -> list[dict[str, str]]:
    """Return of each run-time parameter the identifier, and its default as text of C."""
    identifiers, real = Identifiers(()), export.program.scalar
    f = c_text.suffix(export.program)
    return [
        {
            "identifier": identifiers.take(p.name),
            "default": f"({real})NAN" if p.default is None else literal(p.default, f),
            "name": p.name,
            "note": "no default: give it" if p.default is None else "",
        }
        for p in export.program.parameters
    ]


def _limit(value: float, f: str) -> str:
    if math.isinf(value):
        return f"{'-' * (value < 0)}HUGE_VAL{f.upper()}"
    return literal(value, f)


def _limit_lines(export: Export) -> Iterator[str]:
    kinds = export.model.types
    pairs = zip(*limits(export), strict=True)
    for k, ((low, high), kind) in enumerate(zip(pairs, kinds, strict=True), 1):
        if not math.isinf(low) or not math.isinf(high):
            yield f"joint {k}: from {low:.6g} to {high:.6g} {kind.unit}"


def _function(export: Export, golden: GoldenFunction) -> dict[str, Any]:
    """Return what headers and words say of a function."""
    s = golden.signature
    inputs, outputs = [(a, "in") for a in s.inputs], [(a, "out") for a in s.outputs]
    return {
        "name": s.name,
        "summary": wrapped(s.summary),
        "arguments": [
            printable(f"@param[{way}] {a.name} [{a.unit}] {a.description}")
            for a, way in (*inputs, *outputs)
        ],
        "lines": argument_lines([*s.inputs, *s.outputs]),
        "operations": operations(s),
    }


# -- golden states -------------------------------------------------------------------------------


def _checked(golden: GoldenFunction, f: str) -> dict[str, Any]:
    """Return the tables of a function's states, for the self-test."""
    s = golden.signature
    results = []
    for k, result in enumerate(golden.results):
        if result is not None:
            results.append({"k": k, **_result(golden, result, f)})
    return {
        "name": s.name,
        "states": golden.states,
        "inputs": [
            {
                "name": printable(a.name),
                "size": a.size,
                "rows": len(golden.inputs[a.name]),
                "table": rows(golden.inputs[a.name], f),
                "strides": _strides(a, len(golden.inputs[a.name])),
            }
            for a in s.inputs
        ],
        "outputs": [
            {"name": printable(a.name), "size": a.size, "strides": _strides(a, 2)}
            for a in s.outputs
        ],
        "results": results,
    }


def _result(golden: GoldenFunction, result: GoldenResult, f: str) -> dict[str, Any]:
    expected = result.expected.reshape(len(result.expected), -1)
    return {
        "size": expected.shape[1],
        "table": rows(expected, f),
        "scale": numbers(result.scale, f),
        "factor": result.factor,
        "columns": result.argument.sizes[-1] if result.factor is not None else 0,
    }


def _strides(a: Argument, count: int) -> str:
    """Return the strides of rows of an array, that from row to row 0 if there is only one."""
    sizes = a.sizes
    strides = [math.prod(sizes[k:]) for k in range(len(sizes) + 1)]
    return ", ".join(map(str, [strides[0] * (count > 1), *strides[1:]]))


TARGET = C()
