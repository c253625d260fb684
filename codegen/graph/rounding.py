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
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from random import Random
from typing import Any, TypeVar

import mpmath

from moro_codegen.graph.nodes import Constant, Node, schedule
from moro_codegen.graph.precise import DIGITS, evaluate, inputs_of, operation

#: so many times larger may errors be, at states of a kind on average
MARGIN = 3
#: states of each kind
STATES = 8
#: kinds of states: how far joints are from a quarter turn; None: anywhere
KINDS = (None, 1e-2, 1e-4, 1e-6)
#: smaller errors, relative to the largest result, are none
LEAST = 2.0**-54

Number = TypeVar("Number", float, Decimal)

ARITHMETIC: dict[str, Callable[..., Any]] = {
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
    with mpmath.workdps(DIGITS), localcontext(Context(prec=DIGITS)):
        angular = evaluate(sines, {x: mpmath.mpf(y) for x, y in state.items()})
        precise = {x: Decimal(mpmath.nstr(y, DIGITS)) for x, y in zip(sines, angular, strict=True)}
        exact = _values(
            results, order, {x: Decimal(y) for x, y in state.items()} | precise, _decimal
        )
        rounded = {x: float(y) for x, y in precise.items()}
        found = _values(results, order, {**state, **rounded}, float)
        size = max(map(abs, exact)) or 1
        return [float(abs(Decimal(x) - y) / size) for x, y in zip(found, exact, strict=True)]


def _values(
    results: Sequence[Node],
    order: Sequence[Node],
    known: Mapping[Node, Number],
    number: Callable[[Any], Number],
) -> list[Number]:
    """Return the values of results in a kind of numbers; functions are rounded correctly.

    ``number`` makes one of a constant, and of a number of mpmath's.
    """
    values = dict(known)

    def value(node: Node) -> Number:
        return number(node.value) if node.op == "const" else values[node]

    for node in order:
        if node not in values:
            operands = [value(a) for a in node.args]
            if (arithmetic := ARITHMETIC.get(node.op)) is not None:
                values[node] = arithmetic(*operands)
            else:
                values[node] = number(operation(node)(*map(_mpf, operands)))
    return [value(node) for node in results]


def _decimal(x: Constant) -> Decimal:
    if isinstance(x, mpmath.mpf):
        return Decimal(mpmath.nstr(x, DIGITS))
    exact = Fraction(x)
    return Decimal(exact.numerator) / Decimal(exact.denominator)


def _mpf(x: float | Decimal) -> mpmath.mpf:
    return mpmath.mpf(x if isinstance(x, float) else str(x))
