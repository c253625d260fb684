"""SymPy expressions, as models hold them, to graph nodes."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp
from moro_codegen.graph import Graph, Node, Operand

#: functions of SymPy that C's math.h knows
CALLS = {
    sp.tan: "tan", sp.asin: "asin", sp.acos: "acos", sp.atan: "atan", sp.atan2: "atan2",
    sp.sinh: "sinh", sp.cosh: "cosh", sp.tanh: "tanh", sp.exp: "exp", sp.log: "log",
    sp.Abs: "fabs",
}  # fmt: skip


class Converter:
    """Turns numbers and SymPy expressions over the given symbols into nodes of a graph."""

    def __init__(self, graph: Graph, symbols: Mapping[Any, Node]) -> None:
        self.graph = graph
        self._known: dict[Any, Node] = dict(symbols)

    def __call__(self, value: Any) -> Node:
        """Return the node of a number, a SymPy expression or a node."""
        if isinstance(value, (Node, int, float, Fraction)):
            return self.graph.constant(value)
        node = self._known.get(value)
        if node is None:
            node = self._known[value] = self._convert(sp.sympify(value))
        return node

    def _convert(self, value: Any) -> Node:
        graph = self.graph
        if value.is_Rational:
            return graph.constant(Fraction(int(value.p), int(value.q)))
        if value.is_number:
            return graph.constant(_real(value))
        if value.is_Add or value.is_Mul:
            nodes = [self(arg) for arg in value.args]
            total: Operand = nodes[0]
            for node in nodes[1:]:
                total = total + node if value.is_Add else total * node
            return graph.constant(total)
        if value.is_Pow:
            return self._power(*value.args)
        if value.func in (sp.sin, sp.cos, sp.sign):
            return getattr(graph, value.func.__name__)(self(value.args[0]))  # type: ignore[no-any-return]
        if value.func in CALLS:
            return graph.call(CALLS[value.func], *[self(arg) for arg in value.args])
        raise ValueError(f"{value} is neither a number nor an expression of the parameters")

    def _power(self, base: Any, exponent: Any) -> Node:
        graph, node = self.graph, self(base)
        if exponent.is_Integer:
            power = _integer_power(node, abs(int(exponent)))
            return power if exponent > 0 else 1 / power
        if exponent.is_Rational and exponent.q == 2:
            power = _integer_power(graph.call("sqrt", node), abs(int(exponent.p)))
            return power if exponent > 0 else 1 / power
        return graph.call("pow", node, self(exponent))


def _integer_power(node: Node, exponent: int) -> Node:
    """Return node**exponent by repeated squaring, exponent >= 1."""
    half = node
    result: Node | None = None
    while exponent:
        if exponent & 1:
            result = half if result is None else result * half
        exponent >>= 1
        if exponent:
            half = half * half
    assert result is not None  # noqa: S101
    return result


def _real(value: Any) -> float:
    """Return an irrational number of SymPy's, rounded to the nearest float."""
    number = value.evalf(30)
    if not (number.is_Float or number.is_Rational) or not number.is_finite:
        raise ValueError(f"{value} is not a real number")
    return float(number)
