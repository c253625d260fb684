"""How much graphs lose to rounding: in doubles, against the same operations in 50 digits.

Asked of two ways to compute the same, at states where terms cancel: with joints near multiples of a
quarter turn. What is compared are the arithmetic's errors: the inputs are the same numbers in both,
and so are sines and cosines. That a sum of angles is rounded is not counted: it is as if a joint
stood elsewhere, by half a unit in the last place.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from random import Random

import mpmath

from moro_codegen.graph.nodes import Node, schedule
from moro_codegen.graph.precise import DIGITS, evaluate, inputs_of, operation

#: so many times larger may errors be, at states of a kind on average
MARGIN = 3
#: states of each kind
STATES = 8
#: kinds of states: how far joints are from a quarter turn; None: anywhere
KINDS = (None, 1e-2, 1e-4, 1e-6)
#: smaller errors, relative to the largest result, are none
LEAST = 2.0**-54

ARITHMETIC: dict[str, Callable[..., float]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
}


def no_less_accurate(results: Sequence[Node], others: Sequence[Node]) -> bool:
    """Return whether the errors of results are of the size of others' for the same, or smaller."""
    everything = [*results, *others]
    inputs = inputs_of(everything)
    order = schedule(everything)
    sines = [node for node in order if node.op in ("sin", "cos")]
    for kind in KINDS:
        excess = 0.0
        for k in range(STATES):
            state = {node: _given(node, kind, k) for node in inputs}
            try:
                errors = _errors(everything, order, sines, state)
            except (ArithmeticError, TypeError, ValueError):  # it has no value there
                continue
            mine, theirs = max(errors[: len(results)]), max(errors[len(results) :])
            excess += math.log(max(mine, LEAST) / max(theirs, LEAST))
        if excess > STATES * math.log(MARGIN):
            return False
    return True


def _given(node: Node, kind: float | None, k: int) -> float:
    """Return the value of an input at a state of a kind."""
    name, index = node.value
    draw = Random(f"{name} {index} {kind} {k}")  # noqa: S311 - the same every time
    if name == "parameters":
        return draw.uniform(0.5, 1.5)
    if name != "q" or kind is None:
        return draw.uniform(-3, 3)
    return draw.randint(-1, 1) * (math.pi / 2) + draw.uniform(-kind, kind)


def _errors(
    results: Sequence[Node],
    order: Sequence[Node],
    sines: Sequence[Node],
    state: Mapping[Node, float],
) -> list[float]:
    """Return the errors of results in doubles, relative to the largest of all."""
    with mpmath.workdps(DIGITS):
        exact = evaluate([*results, *sines], {x: mpmath.mpf(y) for x, y in state.items()})
        angular = dict(zip(sines, map(float, exact[len(results) :]), strict=True))
        found = _in_doubles(results, order, {**state, **angular})
        size = max(map(abs, exact[: len(results)])) or 1
        pairs = zip(found, exact[: len(results)], strict=True)
        return [float(abs(x - y) / size) for x, y in pairs]


def _in_doubles(
    results: Sequence[Node], order: Sequence[Node], known: Mapping[Node, float]
) -> list[float]:
    """Return the values of results in doubles; functions are rounded correctly on any machine."""
    values = dict(known)

    def value(node: Node) -> float:
        return float(node.value) if node.op == "const" else values[node]

    for node in order:
        if node not in values:
            operands = [value(a) for a in node.args]
            if (arithmetic := ARITHMETIC.get(node.op)) is not None:
                values[node] = arithmetic(*operands)
            else:
                values[node] = float(operation(node)(*map(mpmath.mpf, operands)))
    return [value(node) for node in results]
