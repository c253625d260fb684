"""Graphs evaluated in the precision of mpmath, and what is zero whatever the inputs are."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import mpmath

from moro_codegen.graph.nodes import Node, schedule

DIGITS = 50
#: what is below is zero: far above the rounding of DIGITS, far below what models are made of
SMALL = mpmath.mpf(10) ** -35

_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "sign": mpmath.sign,
    "fabs": abs,
    "pow": mpmath.power,
    "fmax": max,
    "fmin": min,
}


def evaluate(results: Sequence[Node], inputs: Mapping[Node, Any]) -> list[Any]:
    """Return the values of nodes; ``inputs`` maps input nodes to numbers."""
    values = dict(inputs)

    def value(node: Node) -> Any:
        if node.op != "const":
            return values[node]
        exact = Fraction(node.value)
        return mpmath.mpf(exact.numerator) / exact.denominator

    for node in schedule(results):
        values[node] = operation(node)(*map(value, node.args))
    return [value(node) for node in results]


def operation(node: Node) -> Callable[..., Any]:
    """Return what a node does to its operands, which are numbers of mpmath's."""
    name = node.value if node.op == "call" else node.op
    return _OPERATIONS.get(name) or getattr(mpmath, name)


def vanishing(nodes: Iterable[Node]) -> set[Node]:
    """Return those nodes that are zero whatever the inputs are: where terms cancel that differ.

    They are at two random points, in 50 digits, at which what is analytic and not zero is not zero.
    Nothing is said to vanish if the nodes have no values there.
    """
    unsure = list(dict.fromkeys(nodes))
    rng = random.Random(0)  # noqa: S311 - the same every time
    with mpmath.workdps(DIGITS):
        for _ in range(2):
            inputs = {x: mpmath.mpf(rng.uniform(0.5, 1.5)) for x in inputs_of(unsure)}
            try:
                values = evaluate(unsure, inputs)
            except (ArithmeticError, TypeError, ValueError):  # a formula that has no value there
                return set()
            unsure = [x for x, y in zip(unsure, values, strict=True) if abs(y) < SMALL]
    return set(unsure)


def inputs_of(results: Sequence[Node]) -> list[Node]:
    """Return the inputs that results depend on."""
    operands = (a for node in schedule(results) for a in node.args)
    return sorted(
        {x for x in (*results, *operands) if x.op == "input"}, key=lambda node: node.index
    )
