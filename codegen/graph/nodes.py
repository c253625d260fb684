"""The expression graph: equal expressions are one node, and simple ones never come into being.

A ``Graph`` makes nodes; a node knows its graph, so nodes are added and multiplied like numbers, and
the algorithms of ``moro.algorithms`` run on them as they do on floats. Constants are exact
(``Fraction``) as long as they can be: a float stands for an irrational number, and a float sum that
cancels to within the rounding of its operands is exactly 0.

What every operation does on the spot: constants fold; x + 0, x * 1 and x * 0 vanish; signs move
outwards (a + (-b) = a - b, (-a) b = -(a b)), so constants are positive; operands are ordered;
(a - b) + b = a and its like. With ``cancels``, also terms anywhere in a sum that cancel.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias, Union

#: a Fraction or a float (mypy knows no type for what they have in common)
Constant: TypeAlias = Any
Operand: TypeAlias = Union["Node", int, Fraction, float]

#: results closer to zero than this, relative to their operands, are rounding
ROUNDING = 8 * 2.0**-53

#: what cancels is looked for in sums of so many terms
LONG_SUM = 40

#: time an operation takes, in additions
WEIGHTS = {"add": 1, "sub": 1, "mul": 1, "div": 5, "sincos": 10, "sign": 1, "call": 20}


class Node:
    """A value to be computed: an operation, its operands, and for some operations a value.

    ``op``: "const" (``value``: Fraction or float), "input" (``value``: name of the argument, flat
    index), "add", "sub", "mul", "div", "neg", "sin", "cos", "sign", "call" (``value``: the name of
    a function of C's math.h). Operands always carry a smaller ``index`` than what is made of them.
    """

    __slots__ = ("args", "graph", "index", "negative", "op", "value")

    def __init__(
        self, graph: Graph, index: int, op: str, args: tuple[Node, ...], value: Any
    ) -> None:
        self.graph = graph
        self.index = index
        self.op = op
        self.args = args
        self.value = value
        #: whether it is a constant less than 0
        self.negative = op == "const" and value < 0

    def __add__(self, other: Operand) -> Node:
        return self.graph.add(self, other)

    def __radd__(self, other: Operand) -> Node:
        return self.graph.add(other, self)

    def __sub__(self, other: Operand) -> Node:
        return self.graph.sub(self, other)

    def __rsub__(self, other: Operand) -> Node:
        return self.graph.sub(other, self)

    def __mul__(self, other: Operand) -> Node:
        return self.graph.mul(self, other)

    def __rmul__(self, other: Operand) -> Node:
        return self.graph.mul(other, self)

    def __truediv__(self, other: Operand) -> Node:
        return self.graph.div(self, other)

    def __rtruediv__(self, other: Operand) -> Node:
        return self.graph.div(other, self)

    def __neg__(self) -> Node:
        return self.graph.neg(self)

    def __repr__(self) -> str:
        if self.op == "const":
            return str(self.value)
        if self.op == "input":
            return f"{self.value[0]}[{self.value[1]}]"
        name = self.value if self.op == "call" else self.op
        return f"{name}({', '.join(f'%{a.index}' if a.args else repr(a) for a in self.args)})"


class Graph:
    """Makes nodes, each only once."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[Any, ...], Node] = {}
        #: by numerator and denominator, whose hash is had sooner than that of a Fraction; floats
        #: that are no integers by themselves
        self._constants: dict[tuple[int, int] | float, Node] = {}
        #: whether run-time parameters are among the inputs
        self.has_parameters = False
        #: whether sums are searched for terms that cancel
        self.cancels = False
        self._linear: dict[Node, dict[Node, Constant]] = {}
        self.zero = self.constant(0)
        self.one = self.constant(1)

    def _node(self, op: str, args: tuple[Node, ...], value: Any = None) -> Node:
        key = (op, value, *[a.index for a in args])
        node = self._nodes.get(key)
        if node is None:
            node = self._nodes[key] = Node(self, len(self._nodes), op, args, value)
        return node

    def constant(self, value: Operand) -> Node:
        """Return a constant; a node is returned as it is."""
        if isinstance(value, Node):
            return value
        if not isinstance(value, (int, float, Fraction)):
            value = Fraction(value)  # an integer of NumPy
        key = value if isinstance(value, float) else value.as_integer_ratio()
        node = self._constants.get(key)
        if node is None:
            node = self._constants[key] = self._node("const", (), _number(value))
        return node

    def input(self, name: str, index: int) -> Node:
        """Return entry ``index`` (flat, row-major) of the argument ``name``."""
        self.has_parameters |= name == "parameters"
        return self._node("input", (), (name, index))

    def add(self, a: Operand, b: Operand) -> Node:
        """Return a + b."""
        a, b = self.constant(a), self.constant(b)
        if a.op == "const":
            a, b = b, a
        if b.op == "const":
            if a.op == "const":
                return self.constant(_sum(a.value, b.value))
            if b is self.zero:
                return a
            if a.op in ("add", "sub") and any(arg.op == "const" for arg in a.args):
                return self._shifted(a, b.value)
            if b.negative:
                return self._sub(a, self.constant(-b.value))
        if b.op == "neg":
            return self.sub(a, b.args[0])
        if a.op == "neg":
            return self.sub(b, a.args[0])
        if a is b:
            return self.mul(2, a)
        if a.op == "sub" and a.args[1] is b:
            return a.args[0]
        if b.op == "sub" and b.args[1] is a:
            return b.args[0]
        shorter = self._cancelled(a, b, 1)
        return shorter or self._node("add", (a, b) if a.index < b.index else (b, a))

    def sub(self, a: Operand, b: Operand) -> Node:
        """Return a - b."""
        a, b = self.constant(a), self.constant(b)
        if b.op == "const":
            return self.add(a, -b.value)
        if b.op == "neg":
            return self.add(a, b.args[0])
        if a is self.zero:
            return self.neg(b)
        if a.op == "neg":
            return self.neg(self.add(a.args[0], b))
        if a is b:
            return self.zero
        if a.op == "add" and b in a.args:
            return a.args[0] if a.args[1] is b else a.args[1]
        if a.op == "sub" and a.args[0] is b:
            return self.neg(a.args[1])
        if b.op == "add" and a in b.args:
            return self.neg(b.args[0] if b.args[1] is a else b.args[1])
        if b.op == "sub" and b.args[0] is a:
            return b.args[1]
        return self._cancelled(a, b, -1) or self._sub(a, b)

    def _cancelled(self, a: Node, b: Node, sign: int) -> Node | None:
        """Return a + sign b as a plain sum, if it is searched and terms of a and b cancel."""
        if not self.cancels:
            return None
        left, right = self._terms(a), self._terms(b)
        total = _combined(left, right, sign)
        if all(total[x] != 0 or x.op == "const" for x in right if x in left):
            return None
        result = self.zero
        for x, c in sorted(total.items(), key=lambda item: item[1] < 0):  # positive ones first
            result = self.add(result, self.mul(c, x))
        return result

    def _terms(self, node: Node) -> dict[Node, Constant]:
        """Return a node as a linear combination {node: factor} of others that are no sums."""
        found = self._linear.get(node)
        if found is None:
            if node.op in ("add", "sub"):
                first, second = map(self._terms, node.args)
                found = _combined(first, second, 1 if node.op == "add" else -1)
            elif node.op == "neg":
                found = {x: -c for x, c in self._terms(node.args[0]).items()}
            elif node.op == "mul" and node.args[0].op == "const":
                factor = node.args[0].value
                found = {x: c * factor for x, c in self._terms(node.args[1]).items()}
            elif node.op == "const":
                found = {self.one: node.value} if node.value else {}
            if found is None or len(found) > LONG_SUM:
                found = {node: 1}
            self._linear[node] = found
        return found

    def _shifted(self, a: Node, shift: Constant) -> Node:
        """Return a + shift, a being a sum with a constant: (x + c) + shift = x + (c + shift)."""
        x, y = a.args
        if a.op == "add":
            x, c = (y, x.value) if x.op == "const" else (x, y.value)
            return self.add(x, _sum(c, shift))
        if x.op == "const":
            return self.sub(_sum(x.value, shift), y)
        return self.add(x, _sum(-y.value, shift))

    def _sub(self, a: Node, b: Node) -> Node:
        """Return a - b, as -(b - a) if there is b - a already."""
        opposite = self._nodes.get(("sub", None, b.index, a.index))
        return self._node("sub", (a, b)) if opposite is None else self.neg(opposite)

    def neg(self, a: Operand) -> Node:
        """Return -a."""
        a = self.constant(a)
        if a.op == "const":
            return self.constant(-a.value)
        if a.op == "neg":
            return a.args[0]
        return self._node("neg", (a,))

    def mul(self, a: Operand, b: Operand) -> Node:
        """Return a * b."""
        a, b = self.constant(a), self.constant(b)
        if a.op == "const":
            a, b = b, a
        if b.op == "const":
            if a.op == "const":
                return self.constant(a.value * b.value)
            if b is self.zero:
                return self.zero
            if b is self.one:
                return a
            if b.negative:
                return self.neg(self.mul(a, -b.value))
            if a.op == "mul" and a.args[0].op == "const":
                return self.mul(a.args[1], a.args[0].value * b.value)
        if a.op == "neg":
            return self.neg(self.mul(a.args[0], b))
        if b.op == "neg":
            return self.neg(self.mul(a, b.args[0]))
        if b.op == "const":
            return self._node("mul", (b, a))
        return self._node("mul", (a, b) if a.index < b.index else (b, a))

    def div(self, a: Operand, b: Operand) -> Node:
        """Return a / b; a constant divisor becomes a factor."""
        a, b = self.constant(a), self.constant(b)
        if b.op == "const":
            if b is self.zero:
                raise ZeroDivisionError("division by zero in an expression")
            return self.mul(a, 1 / b.value)
        if a is self.zero:
            return self.zero
        if a.op == "neg":
            return self.neg(self.div(a.args[0], b))
        if b.op == "neg":
            return self.neg(self.div(a, b.args[0]))
        if a.negative:
            return self.neg(self.div(-a.value, b))
        return self.one if a is b else self._node("div", (a, b))

    def sin(self, a: Operand) -> Node:
        """Return the sine of a [rad]."""
        a = self.constant(a)
        if a.op == "const":
            return self.constant(math.sin(a.value))
        return self.neg(self.sin(a.args[0])) if a.op == "neg" else self._node("sin", (a,))

    def cos(self, a: Operand) -> Node:
        """Return the cosine of a [rad]."""
        a = self.constant(a)
        if a.op == "const":
            return self.constant(math.cos(a.value))
        return self.cos(a.args[0]) if a.op == "neg" else self._node("cos", (a,))

    def sign(self, a: Operand) -> Node:
        """Return the sign of a: -1, 0 or 1."""
        a = self.constant(a)
        if a.op == "const":
            return self.constant((a.value > 0) - (a.value < 0))
        return self.neg(self.sign(a.args[0])) if a.op == "neg" else self._node("sign", (a,))

    def call(self, name: str, *args: Operand) -> Node:
        """Return the function ``name`` of C's math.h of the arguments."""
        return self._node("call", tuple(self.constant(a) for a in args), name)

    def remake(self, node: Node, args: Sequence[Node]) -> Node:
        """Return the operation of a node on other operands."""
        if node.op == "call":
            return self.call(node.value, *args)
        result: Node = getattr(self, node.op)(*args)
        return result


def _combined(
    a: Mapping[Node, Constant], b: Mapping[Node, Constant], sign: int
) -> dict[Node, Constant]:
    """Return a + sign b, linear combinations of nodes."""
    total = dict(a)
    for x, c in b.items():
        total[x] = _sum(total.get(x, 0), sign * c)
    return total


def _number(value: float | Fraction) -> Constant:
    """Return a Fraction where a number is exact, else a float."""
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"a constant must be finite, not {value}")
    is_exact = not isinstance(value, float) or value.is_integer()
    return Fraction(value) if is_exact else float(value)


def _sum(a: Constant, b: Constant) -> Constant:
    total = a + b
    if isinstance(total, float) and abs(total) <= ROUNDING * abs(a):
        return Fraction(0)
    return total


def schedule(results: Iterable[Node]) -> list[Node]:
    """Return every node that the results need, operands first, without constants and inputs."""
    needed: set[Node] = set()
    stack = list(results)
    while stack:
        node = stack.pop()
        if node.args and node not in needed:
            needed.add(node)
            stack.extend(node.args)
    return sorted(needed, key=lambda node: node.index)


def replaced(results: Sequence[Node], new: Mapping[Node, Node]) -> list[Node]:
    """Return the results with nodes replaced by others."""
    found = dict(new)
    for node in schedule(results):
        if node not in found:
            found[node] = node.graph.remake(node, [found.get(a, a) for a in node.args])
    return [found.get(node, node) for node in results]


def count(nodes: Sequence[Node]) -> dict[str, int]:
    """Return the number of operations: a negation is a subtraction, a sine and a cosine a pair."""
    ops = dict.fromkeys(("add", "sub", "mul", "div", "sincos", "sign", "call"), 0)
    for node in nodes:
        if node.op not in ("sin", "cos"):
            ops["sub" if node.op == "neg" else node.op] += 1
    ops["sincos"] = len({node.args[0] for node in nodes if node.op in ("sin", "cos")})
    return ops


def parameters_of(results: Iterable[Node]) -> set[int]:
    """Return the indices of the run-time parameters that results depend on."""
    results = tuple(results)
    operands = (a for node in schedule(results) for a in node.args)
    return {
        node.value[1]
        for node in (*results, *operands)
        if node.op == "input" and node.value[0] == "parameters"
    }


def cost(results: Iterable[Node]) -> int:
    """Return the time that results take, in additions."""
    ops = count(schedule(results))
    return sum(ops[op] * weight for op, weight in WEIGHTS.items())


def price(results: Sequence[Node]) -> tuple[int, int]:
    """Return the number of run-time parameters that results depend on, and their cost.

    Of ways to compute the same, those with fewer parameters come first: what else there is of them
    cancels.
    """
    has_parameters = any(x.graph.has_parameters for x in results[:1])
    return len(parameters_of(results)) if has_parameters else 0, cost(results)


def fewest(alternatives: Iterable[Sequence[Operand]], graph: Graph) -> list[Node]:
    """Return the alternative of the lowest price."""
    return min(([graph.constant(x) for x in results] for results in alternatives), key=price)


def constant_value(x: Any) -> Any:
    """Return the value of a constant (a node or a plain number), None for anything else."""
    if isinstance(x, Node):
        return x.value if x.op == "const" else None
    return x if isinstance(x, (int, float, Fraction)) else None
