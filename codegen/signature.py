"""What a kernel's function takes and returns, kept in the manifest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from moro_codegen.calls import Calls, Operand
from moro_codegen.emit.describe import all_inputs, core_shapes, shape
from moro_codegen.functions import Argument
from moro_codegen.generate import Parameter, Program, Routine

#: NumPy's names of C's types
DTYPES = {"double": "float64", "float": "float32"}


@dataclass(frozen=True)
class Part:
    """A function that is computed, alone or together with others."""

    name: str
    #: how many results it has
    outputs: int


@dataclass(frozen=True)
class Signature:
    """A function of a kernel: what it computes, from what, with how many operations."""

    name: str
    summary: str
    #: run-time parameters, as one array, are the last input if there are any
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    parameters: tuple[Parameter, ...]
    ops: Mapping[str, int]
    #: what it is made of, in the order of the outputs
    parts: tuple[Part, ...]
    #: of all arrays: float64 or float32
    dtype: str = "float64"

    @classmethod
    def of(cls, program: Program, routine: Routine) -> Signature:
        """Return the signature of a routine."""
        return cls(
            routine.function.name,
            routine.function.summary,
            all_inputs(program, routine),
            routine.outputs,
            program.parameters,
            routine.ops,
            tuple(Part(part.name, len(part.outputs)) for part in routine.function.parts),
            DTYPES[program.scalar],
        )

    def as_json(self) -> dict[str, Any]:
        """Return the signature in the types of JSON."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Signature:
        """Return the signature that ``as_json`` wrote."""

        def arguments(items: Sequence[Mapping[str, Any]]) -> tuple[Argument, ...]:
            return tuple(Argument(**{**item, "shape": tuple(item["shape"])}) for item in items)

        return cls(
            **{
                **data,
                "inputs": arguments(data["inputs"]),
                "outputs": arguments(data["outputs"]),
                "parameters": tuple(Parameter(**item) for item in data["parameters"]),
                "parts": tuple(Part(**item) for item in data["parts"]),
            }
        )

    @property
    def core(self) -> str:
        """The shapes as NumPy writes them for its generalized functions: (6),(6),(6)->(6)."""
        return core_shapes(self.inputs, self.outputs)

    @cached_property
    def given(self) -> tuple[Argument, ...]:
        """The inputs that a call must name: all but the run-time parameters."""
        return self.inputs[:-1] if self.parameters else self.inputs

    @cached_property
    def calls(self) -> Calls:
        """The calls of the function, with their checks."""

        def operands(arguments: Sequence[Argument]) -> tuple[Operand, ...]:
            return tuple(Operand(a.name, shape(a), a.description) for a in arguments)

        return Calls(
            self.name,
            operands(self.given),
            operands(self.outputs),
            {parameter.name: parameter.default for parameter in self.parameters},
            sum(self.ops.values()),
            self.dtype,
        )
