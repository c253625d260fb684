"""Python: one module that needs NumPy only."""

from __future__ import annotations

from typing import Any

from moro_codegen.backends import numpy
from moro_codegen.emit.describe import conventions
from moro_codegen.emit.escape import printable
from moro_codegen.emit.render import render
from moro_codegen.targets import Export, Target
from moro_codegen.targets.tables import numbers, rows


class Python(Target):
    """A module to be imported where it lies, with its test."""

    name = "python"
    reserved = numpy.BACKEND.reserved

    def files(self, export: Export) -> dict[str, str]:
        """Return the module, its test and words."""
        name = export.name
        (text,) = numpy.emit(export.program, made(export)).values()
        return {
            f"{name}.py": text,
            f"test_{name}.py": test(export, name),
            "README.md": render(
                "export_python_readme.md.jinja",
                name=name,
                notes=conventions(export.program),
                signatures=export.program.signatures,
                made=made(export),
            ),
        }


def made(export: Export) -> list[str]:
    """Return lines that say what an export was made of, and how to make it again."""
    return [
        f"Made of {printable(export.model.name)}, SHA-256 of the model",
        f"{export.model_hash}. To make it again:",
        "",
        f"    {export.command or export.call}",
        "",
        "It is yours: choose your own licence.",
    ]


def test(export: Export, module: str) -> str:
    """Return the text of a test of golden states for a module of Python."""
    golden = export.golden
    return render(
        "export_test.py.jinja",
        name=export.name,
        module=module,
        tolerance=repr(golden.tolerance),
        functions=[
            {
                "name": g.signature.name,
                "inputs": [_array(a.name, g.inputs[a.name], a.sizes) for a in g.signature.inputs],
                "results": [
                    {
                        "k": k,
                        "factor": result.factor,
                        "expected": rows(result.expected),
                        "scale": numbers(result.scale),
                    }
                    for k, result in enumerate(g.results)
                    if result is not None
                ],
            }
            for g in golden.functions
        ],
        unchecked=list(golden.unchecked),
    )


def _array(name: str, values: Any, sizes: tuple[int, ...]) -> dict[str, Any]:
    """Return an input; what is the same at all states has no axis for them."""
    return {"name": name, "rows": rows(values), "shape": (len(values), *sizes)}


TARGET = Python()
