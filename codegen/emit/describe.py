"""What headers, docstrings and manifests say of a program, written once."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from itertools import zip_longest
from typing import TYPE_CHECKING

from moro.model import JOINT_TYPES, JointType
from moro_codegen.emit.escape import printable

if TYPE_CHECKING:
    from moro_codegen.functions.arguments import Argument
    from moro_codegen.program import Program, Routine
    from moro_codegen.signature import RuntimeParameter, Signature

_CONVENTIONS = {"dh": "standard", "mdh": "modified"}
_COUNTED = {
    "add": "additions",
    "sub": "subtractions",
    "mul": "multiplications",
    "div": "divisions",
    "sincos": "sine-cosine pairs",
    "sign": "signs",
    "call": "calls of libm",
}


def conventions(program: Program) -> list[str]:
    """Return what holds for every function: joints, units, frames, gravity, parameters."""
    joints = [
        printable(f"  joint {i}{f', {name}' if name else ''}: {kind} ({_units(JOINT_TYPES[kind])})")
        for i, (kind, name) in enumerate(zip_longest(program.joint_kinds, program.joint_names), 1)
    ]
    lines = [
        "SI units, radians. Component k of a joint vector belongs to joint k + 1; matrices are",
        "row-major.",
        *joints,
    ]
    if program.convention:
        name = _CONVENTIONS[program.convention]
        lines.append(f"Frames 0 (the base) to {program.dof}: {name} Denavit-Hartenberg convention.")
    if program.gravity is not None:
        lines += wrapped(f"Gravity, in frame 0: ({', '.join(program.gravity)}) m/s^2.")
    if program.scalar == "float":
        lines.append("Computed in single precision.")
    if program.parameters:
        lines += ["", "Run-time parameters, in this order:"]
        for line in parameter_lines(program):
            lines += textwrap.wrap(line, 92, initial_indent="  ", subsequent_indent=" " * 6)
    return lines


def _units(kind: JointType) -> str:
    """Return the units of q and of tau: "rad, torque in N m"."""
    return f"{kind.unit}, {'torque' if kind.is_angle else 'force'} in {kind.effort}"


def parameter_lines(program: Program) -> list[str]:
    """Return a line per run-time parameter: index, name, default, meaning."""
    lines = []
    for k, parameter in enumerate(program.parameters):
        default = "no default" if parameter.default is None else f"default {parameter.default!r}"
        meaning = f": {parameter.description}" if parameter.description else ""
        lines.append(printable(f"parameters[{k}]  {parameter.name}, {default}{meaning}"))
    return lines


def argument_lines(arguments: Iterable[Argument]) -> list[str]:
    """Return a line per argument: name and shape, unit, meaning with its frame."""
    arguments = tuple(arguments)
    names = [a.name + "".join(f"[{n}]" for n in a.shape) for a in arguments]
    units = [printable(f"[{a.unit}]") for a in arguments]
    wide, wider = max(map(len, names), default=0), max(map(len, units), default=0)
    return [
        f"{name:<{wide}}  {unit:<{wider}}  {printable(a.description)}"
        for name, unit, a in zip(names, units, arguments, strict=True)
    ]


def operations(routine: Routine | Signature) -> str:
    """Return the operation counts as a phrase: 104 additions, 77 subtractions, ..."""
    counts = [f"{n} {_COUNTED.get(op, op)}" for op, n in routine.ops.items() if n]
    return ", ".join(counts) or "no operations"


def wrapped(text: str, width: int = 92) -> list[str]:
    """Return a paragraph as lines."""
    return textwrap.wrap(printable(text), width)


def docstring(signature: Signature) -> list[str]:
    """Return what a function's users read, line by line."""
    returned = ", ".join(a.name for a in signature.outputs)
    lines = [
        printable(signature.summary),
        "",
        f"Takes arrays of {signature.dtype}, or what NumPy makes them of. Further axes in front",
        "are samples, and are broadcast against each other.",
        "",
        *argument_lines(signature.given),
        "",
        f"Returns {returned}:",
        "",
        *argument_lines(signature.outputs),
        "",
    ]
    if signature.parameters:
        lines += [
            "Run-time parameters, as a dict by name, a sequence in this order, or None for the",
            "defaults:",
            "",
            *(_parameter_line(p) for p in signature.parameters),
            "",
        ]
    else:
        lines += ["The model has no run-time parameters: ``parameters`` is None or empty.", ""]
    out = "a tuple of arrays" if len(signature.outputs) > 1 else "an array"
    return [
        *lines,
        f"``out``: {out} of {signature.dtype} for the result; it must not overlap an input.",
        "``threads``: so many share a large batch's samples; the results are the same.",
        "",
        f"Takes {operations(signature)}.",
    ]


def _parameter_line(parameter: RuntimeParameter) -> str:
    default = "no default" if parameter.default is None else f"default {parameter.default!r}"
    return printable(f"{parameter.name}  ({default})  {parameter.description}".rstrip())
