"""Several functions as one: their results in one call, what they have in common computed once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function, own_parameters
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Node


def together(functions: Sequence[Function]) -> Function:
    """Return the function that computes what all of these do.

    Its name joins theirs: tau and inertia_matrix make tau_inertia_matrix(q, qd, qdd) -> (tau, M).
    It takes every input that one of them takes, those of the first function first, and returns all
    results in order. Both are built in one graph, where equal operations are one.

    Raises ValueError for fewer than two functions, or the same one twice.
    """
    names = [function.name for function in functions]
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"{twice[0]} is asked for twice in {'+'.join(names)}")
    if len(names) < 2:
        asked = f"only {names[0]}" if names else "none"
        raise ValueError(f"a tuple of functions is for two or more in one call, found {asked}")
    taken = _taken(functions)
    inputs = _first_motion({a.name: a for arguments in taken for a in arguments})

    def build(system: System, *given: Sequence[Node]) -> list[Sequence[Node]]:
        nodes = dict(zip((a.name for a in inputs), given, strict=True))
        return [
            result
            for function, arguments in zip(functions, taken, strict=True)
            for result in function.build(
                replace(system, function=function.request), *(nodes[a.name] for a in arguments)
            )
        ]

    return Function(
        "_".join(names),
        inputs,
        _outputs(functions, {a.name for a in inputs}),
        f"Together, what they share computed once: {', '.join(names)}. "
        + " ".join(function.summary for function in functions),
        build,
        parameters=own_parameters(functions),
        together=tuple(functions),
    )


def _taken(functions: Sequence[Function]) -> list[tuple[Argument, ...]]:
    """Return the inputs of each; those of one name that mean two things get their function's."""
    count = Counter(a.name for a in {a for function in functions for a in function.inputs})
    return [
        tuple(
            replace(a, name=f"{function.name}_{a.name}") if count[a.name] > 1 else a
            for a in function.inputs
        )
        for function in functions
    ]


def _first_motion(found: dict[str, Argument]) -> tuple[Argument, ...]:
    """Return inputs with q, qd and qdd before others, as everywhere."""
    first = [found.pop(name) for name in ("q", "qd", "qdd") if name in found]
    return (*first, *found.values())


def _outputs(functions: Sequence[Function], inputs: set[str]) -> tuple[Argument, ...]:
    """Return all results; those of one name, or with that of an input, get their function's."""
    count = Counter(a.name for function in functions for a in function.outputs)
    return tuple(
        replace(a, name=f"{function.name}_{a.name}") if count[a.name] > 1 or a.name in inputs else a
        for function in functions
        for a in function.outputs
    )
