"""A function that can be generated: what C, Python, the headers and the docs say of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from moro_codegen.functions.arguments import Argument
from moro_codegen.graph.nodes import Node

#: a sequence of nodes for every output, flat
Outputs = list[Sequence[Node]]


@dataclass(frozen=True)
class Function:
    """A function of the dynamics.

    ``build`` takes the system and one sequence of nodes per input, and returns one flat sequence
    of nodes per output.
    """

    name: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    summary: str
    build: Callable[..., Sequence[Sequence[Node]]]
    #: how it is computed
    algorithm: str = ""
    #: run-time parameters besides those of the robot, with their defaults (None: no default)
    parameters: Mapping[Any, Any] = field(default_factory=dict, hash=False)
    #: what it computes together, in the order of its outputs; itself if that is all
    together: tuple[Function, ...] = ()
    #: name of the frame that it is of, "" for the last; None if it is of none
    frame: str | None = None
    #: its name in the catalogue, if that is another
    kind: str = ""

    @property
    def request(self) -> str:
        """What asks for it: jacobian, jacobian@camera."""
        return f"{self.kind}@{self.frame}" if self.frame else self.name

    @property
    def parts(self) -> tuple[Function, ...]:
        """The functions that it computes, none of which computes several."""
        return tuple(part for one in self.together for part in one.parts) or (self,)


def own_parameters(functions: Iterable[Function]) -> dict[Any, Any]:
    """Return the parameters that functions bring, with their defaults.

    Raises ValueError if two give one symbol different defaults.
    """
    found: dict[Any, Any] = {}
    for function in functions:
        for symbol, default in function.parameters.items():
            if found.setdefault(symbol, default) != default:
                raise ValueError(
                    f"{function.name}: the default of {symbol} is {default}, but another "
                    f"function's is {found[symbol]}"
                )
    return found
