"""Signatures: what a function of a kernel takes and gives, of which type, at what cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np

from moro_codegen.calls import Calls, Operand, parameters_operand
from moro_codegen.functions.arguments import Argument

#: what kernels compute with, as C calls it
Real: TypeAlias = Literal["double", "float"]

#: NumPy's names of C's types
DTYPES: dict[Real, str] = {"double": "float64", "float": "float32"}


@dataclass(frozen=True)
class RuntimeParameter:
    """A number of the model that is given at run time."""

    name: str
    default: float | None
    #: what it is of the robot, "mass of link 2"; or ""
    description: str


@dataclass(frozen=True)
class Part:
    """A function that is computed, alone or together with others."""

    name: str
    #: how many results it has
    outputs: int
    #: the frame that it is of, if that was named
    frame: str = ""
    #: how its results were come by: "recursion", "closed form", both with a comma between, or
    #: "expression" for a function of the user's own
    route: str = "recursion"


@dataclass(frozen=True)
class Signature:
    """A function of a kernel: what it computes, from what, with how many operations."""

    name: str
    summary: str
    #: run-time parameters, as one array, are the last input if there are any
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    parameters: tuple[RuntimeParameter, ...]
    ops: Mapping[str, int]
    #: what it is made of, in the order of the outputs
    parts: tuple[Part, ...]
    #: of all arrays: float64 or float32
    dtype: str = "float64"

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
                "parameters": tuple(RuntimeParameter(**item) for item in data["parameters"]),
                "parts": tuple(Part(**item) for item in data["parts"]),
            }
        )

    @property
    def core(self) -> str:
        """The shapes as NumPy writes them for its generalized functions: (6),(6),(6)->(6)."""

        def core(arguments: Iterable[Argument]) -> str:
            return ",".join(f"({','.join(map(str, a.shape))})" for a in arguments)

        return f"{core(self.inputs)}->{core(self.outputs)}"

    @cached_property
    def given(self) -> tuple[Argument, ...]:
        """The inputs that a call must name: all but the run-time parameters."""
        return self.inputs[: len(self.inputs) - len(parameters_input(self.parameters))]

    @cached_property
    def calls(self) -> Calls:
        """The calls of the function, with their checks."""

        def operands(arguments: Sequence[Argument]) -> tuple[Operand, ...]:
            return tuple(Operand(a.name, a.sizes, a.description) for a in arguments)

        return Calls(
            self.name,
            operands(self.given),
            operands(self.outputs),
            {parameter.name: parameter.default for parameter in self.parameters},
            sum(self.ops.values()),
            self.dtype,
        )


def parameters_input(parameters: Sequence[RuntimeParameter]) -> tuple[Argument, ...]:
    """Return run-time parameters as an input, the last one; none if there are none."""
    return tuple(
        Argument(operand.name, operand.shape, "SI", operand.description)
        for operand in parameters_operand(len(parameters))
    )


def real(dtype: Any) -> Real:
    """Return the type of C for a type of NumPy's, or for its name in C."""
    if isinstance(dtype, str) and dtype in DTYPES:
        return "float" if dtype == "float" else "double"  # the words of C and of the command
    scalars = {name: scalar for scalar, name in DTYPES.items()}
    with suppress(TypeError, KeyError):
        return scalars[np.dtype(dtype).name]
    raise ValueError(f'dtype must be "float64" or "float32", not {dtype!r}')
