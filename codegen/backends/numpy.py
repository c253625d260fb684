"""A program as a Python module that needs NumPy only, vectorised over leading axes."""

from __future__ import annotations

import builtins
import inspect
import keyword
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from moro_codegen import calls
from moro_codegen.backends import Backend, Folder, Opened
from moro_codegen.emit.describe import conventions, docstring
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

RESERVED = frozenset({*keyword.kwlist, "np", "out", "samples", "len", "parameters"})
#: what the module calls something else, for those who name its functions
IN_MODULE = frozenset({"KEY", *vars(builtins), *vars(calls)})

#: NumPy's names of the functions of <math.h>, where they differ
NAMES = {
    "acos": "arccos", "asin": "arcsin", "atan": "arctan", "atan2": "arctan2", "acosh": "arccosh",
    "asinh": "arcsinh", "atanh": "arctanh", "pow": "power", "fabs": "abs",
}  # fmt: skip


class NumPy(Backend):
    """A module that needs no compiler."""

    name = "numpy"
    reserved = RESERVED | IN_MODULE

    def emit(self, program: Program) -> dict[str, str]:
        """Return the module."""
        return emit(program)

    def signed(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the module with its KEY."""
        path = f"{name}.py"
        return {**texts, path: texts[path] + render("key.py.jinja", key=key)}

    def unsigned(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the module without it."""
        path = f"{name}.py"
        return {**texts, path: texts[path].removesuffix(render("key.py.jinja", key=key))}

    def loaded(self, folder: Path, name: str) -> Path:
        """Return the path of the module."""
        return folder / f"{name}.py"

    def open(self, folder: Folder, content: bytes) -> Opened:
        """Run the module."""
        source, module = self.loaded(folder.path, folder.name), ModuleType(folder.name)
        code = builtins.compile(content, str(source), "exec")
        exec(code, module.__dict__)  # noqa: S102 - as much ours as a shared library is
        return Opened(source, self._functions(module, folder), module.KEY)

    def _functions(
        self, module: ModuleType, folder: Folder
    ) -> Iterator[tuple[str, Callable[..., Any]]]:
        for name, s in folder.signatures.items():
            run = s.calls.in_chunks(getattr(module, f"_{name}_of_arrays"))
            yield name, s.calls.function(run, "\n".join(docstring(s)))


def emit(program: Program, made: Sequence[str] = ()) -> dict[str, str]:
    """Return the text of ``<name>.py``, by file name; ``made`` says more of where it is from."""
    text = render(
        "kernel.py.jinja",
        title=f"{program.name}: dynamics of a robot arm with {program.dof} joints.",
        notes=[*made, "", *conventions(program)] if made else conventions(program),
        functions=functions(program),
        calls_source=calls_source(),
        signatures=program.signatures,
    )
    return {f"{program.name}.py": text}


def functions(program: Program) -> str:
    """Return the text of a function ``_<name>_of_arrays`` for each routine: no checks of arguments.

    It takes arrays of the program's type, which must hold as many components as it needs.
    """
    routines = [_holes(program, routine) for routine in program.routines]
    return render("functions.py.jinja", routines=routines, far=far(program, routines))


@cache
def calls_source() -> str:
    """Return the text of ``moro_codegen.calls`` from its imports on, to be part of a module."""
    text = inspect.getsource(calls)
    return text[text.index("import difflib") :].replace("import numpy as np\n\n", "")


def far(program: Program, routines: Sequence[Mapping[str, Any]]) -> float | None:
    """Return the angle beyond which those that are added lose whole turns; None: none is added."""
    lines = [line for routine in routines for line in routine["body"]]
    return FAR[program.scalar] if any("_turned(" in line for line in lines) else None


def _holes(program: Program, routine: Routine) -> dict[str, Any]:
    """Return what the template says of one routine."""
    signature = program.signature(routine)
    return {
        "name": routine.function.name,
        "parameters": ", ".join(a.name for a in signature.inputs),
        "doc": docstring(signature),
        "body": list(_lines(program, routine)),
    }


def _lines(program: Program, routine: Routine) -> Iterator[str]:
    """Return the lines of a routine's function."""
    inputs, outputs = program.signature(routine).inputs, routine.outputs
    text = body(program, routine, {*RESERVED, *(a.name for a in (*inputs, *outputs))})
    dtype = "np.float32" if program.scalar == "float" else "float"
    leading = ", ".join(f"{a.name}.shape[: {a.name}.ndim - {len(a.shape)}]" for a in inputs)
    yield f"samples = np.broadcast_shapes({leading})"
    shapes = {a.name: a.sizes for a in inputs}
    lines = [line for statement in text.statements for line in _statement(statement, shapes)]
    results = iter(text.results)
    for a in outputs:
        lines.append(f"{a.name} = np.empty(samples + {a.sizes}, dtype={dtype})")
        lines += [f"{a.name}[{_index(a.sizes, k)}] = {next(results)}" for k in range(a.size)]
    yield from _forgetting(lines, {name for s in text.statements for name in _computed(s)})
    yield f"return {', '.join(a.name for a in outputs)}"


def _forgetting(lines: Sequence[str], names: Collection[str]) -> Iterator[str]:
    """Delete arrays after their last use: the next one gets their memory, still in the cache."""
    last = {word: i for i, line in enumerate(lines) for word in re.findall(r"\w+", line)}
    dead: dict[int, list[str]] = {}
    for name in names:
        dead.setdefault(last[name], []).append(name)
    for i, line in enumerate(lines):
        yield line
        if i in dead and i < len(lines) - 1:
            yield f"del {', '.join(sorted(dead[i]))}"


def _computed(statement: Statement) -> list[str]:
    match statement:
        case Load():
            return []
        case ReduceAngles(names, _, _):
            return list(names)
        case Assign(name, _) | Call(name, _, _):
            return [name]
        case Sines(_, pairs, _):
            return [name for pair in pairs for name in pair if name]


def _statement(statement: Statement, shapes: Mapping[str, tuple[int, ...]]) -> Iterator[str]:
    match statement:
        case Load(name, argument, index):
            yield f"{name} = {argument}[{_index(shapes[argument], index)}]"
        case Assign(name, expression):
            yield f"{name} = {expression}"
        case Call(name, function, arguments):
            yield f"{name} = np.{NAMES.get(function, function)}({', '.join(arguments)})"
        case ReduceAngles(names, angles, _):
            for name, angle in zip(names, angles, strict=True):
                yield f"{name} = _turned({angle})"
        case Sines(angles, pairs, _):
            for angle, (sine, cosine) in zip(angles, pairs, strict=True):
                pair = {"sin": sine, "cos": cosine}
                used = {function: name for function, name in pair.items() if name}
                calls = ", ".join(f"np.{function}({angle})" for function in used)
                yield f"{', '.join(used.values())} = {calls}"


def _index(sizes: tuple[int, ...], index: int) -> str:
    """Return the subscript of a component after the axes of the samples: ``..., 2, 3``."""
    places = []
    for n in reversed(sizes):
        index, place = divmod(index, n)
        places.append(str(place))
    return ", ".join(["...", *reversed(places)])


BACKEND = NumPy()
