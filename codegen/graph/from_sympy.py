"""SymPy expressions, as models hold them, to graph nodes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

import sympy as sp

from moro_codegen.graph.nodes import Graph, Node

#: a number times powers of nodes
Term: TypeAlias = "tuple[Node, Counter[Node]]"

#: functions of SymPy that C's math.h knows
CALLS = {
    sp.tan: "tan", sp.asin: "asin", sp.acos: "acos", sp.atan: "atan", sp.atan2: "atan2",
    sp.sinh: "sinh", sp.cosh: "cosh", sp.tanh: "tanh", sp.asinh: "asinh", sp.acosh: "acosh",
    sp.atanh: "atanh", sp.exp: "exp", sp.log: "log", sp.Abs: "fabs",
}  # fmt: skip

#: functions of SymPy that are one over a sine, cosine or tangent
RECIPROCALS = {sp.csc: sp.sin, sp.sec: sp.cos, sp.cot: sp.tan}


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
        if value.is_Add:
            return self._sum([self._term(term) for term in value.args])
        if value.is_Mul:
            return self._product(*self._term(value))
        if value.is_Pow:
            return self._power(*value.args)
        if value.func in (sp.sin, sp.cos, sp.sign):
            return getattr(graph, value.func.__name__)(self(value.args[0]))  # type: ignore[no-any-return]
        if value.func in CALLS:
            return graph.call(CALLS[value.func], *[self(arg) for arg in value.args])
        if value.func in RECIPROCALS:
            return 1 / self(RECIPROCALS[value.func](value.args[0]))
        raise ValueError(f"{value} is neither a number nor an expression of the parameters")

    def _term(self, term: Any) -> Term:
        """Return a term of a sum as a number and the factors behind it."""
        number, factors = self.graph.one, Counter[Node]()
        for factor in term.args if term.is_Mul else (term,):
            if factor.is_number:
                number = number * self(factor)
            elif factor.is_Pow and factor.exp.is_Integer:
                base = self(factor.base)
                power = int(factor.exp)
                factors[base if power > 0 else 1 / base] += abs(power)
            else:
                factors[self(factor)] += 1
        return number, factors

    def _sum(self, terms: Sequence[Term]) -> Node:
        """Return a sum; the factor that most of its terms have is taken out of them, and so on."""
        shared = Counter(factor for _, factors in terms for factor in factors)
        factor = min(shared, key=lambda x: (-shared[x], x.index), default=None)
        if factor is None or shared[factor] < 2:
            total = self.graph.zero
            for number, factors in terms:
                total = total + self._product(number, factors)
            return total
        one = Counter([factor])
        inside = self._sum([(number, rest - one) for number, rest in terms if factor in rest])
        outside = self._sum([(number, rest) for number, rest in terms if factor not in rest])
        return self._product(self.graph.one, Counter([factor, inside])) + outside

    def _product(self, number: Node, factors: Counter[Node]) -> Node:
        """Return a product, as one division if there is something to divide by.

        The number comes last, so that products share what they have without it.
        """
        above, below = self.graph.one, self.graph.one
        for factor in sorted(factors, key=lambda x: x.index):
            inverse = factor.op == "div" and factor.args[0] is self.graph.one
            power = _integer_power(factor.args[1] if inverse else factor, factors[factor])
            above, below = (above, below * power) if inverse else (above * power, below)
        return number * above / below

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
