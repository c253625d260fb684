"""Derivatives of graphs, forwards and backwards.

Forwards is one pass a variable, through the nodes it reaches and no others; backwards one pass for
all variables, of one sum of results.

What a joint does not move has no derivative and costs nothing. The sine and the cosine of an angle
are each other's derivatives, so they are at hand. The graph makes equal nodes only once, so what
the derivatives share with each other, and with the function itself, is computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from moro_codegen.graph.nodes import Graph, Node, schedule


def jacobian(results: Sequence[Node], variables: Sequence[Node]) -> list[list[Node]]:
    """Return d results_i / d variables_j as nodes, a list of rows.

    The derivative of ``sign`` is 0: it has none where it jumps.
    """
    if not results:
        return []
    graph, order = results[0].graph, schedule(results)
    columns = [_column(graph, order, results, variable) for variable in variables]
    return [list(row) for row in zip(*columns, strict=True)]


def _column(
    graph: Graph, order: Sequence[Node], results: Sequence[Node], variable: Node
) -> list[Node]:
    """Return the derivatives of the results with respect to one variable."""
    slopes = {variable: graph.one}
    for node in order:
        if any(operand in slopes for operand in node.args):
            slope = _slope(graph, node, [slopes.get(a, graph.zero) for a in node.args])
            if slope is not graph.zero:
                slopes[node] = slope
    return [slopes.get(node, graph.zero) for node in results]


def gradient(
    results: Sequence[Node], weights: Sequence[Node], variables: Sequence[Node]
) -> list[Node]:
    """Return the derivatives of the sum of weights_i results_i by all variables, backwards.

    The derivative of ``sign`` is 0: it has none where it jumps.
    """
    if not results:
        return []
    graph = results[0].graph
    slopes: dict[Node, Node] = {}

    def add(node: Node, slope: Node) -> None:
        if slope is not graph.zero:
            slopes[node] = slopes.get(node, graph.zero) + slope

    for result, weight in zip(results, weights, strict=True):
        add(result, weight)
    for node in reversed(schedule(results)):
        if node in slopes:
            for operand, partial in zip(node.args, _partials(graph, node), strict=True):
                add(operand, slopes[node] * partial)
    return [slopes.get(variable, graph.zero) for variable in variables]


def _partials(graph: Graph, node: Node) -> tuple[Node, ...]:
    """Return the derivatives of an operation by its operands."""
    a = node.args
    match node.op:
        case "add":
            return graph.one, graph.one
        case "sub":
            return graph.one, -graph.one
        case "mul":
            return a[1], a[0]
        case "div":
            return 1 / a[1], -(node / a[1])
        case "call":
            return _CALLS[node.value](graph, node, *a)
    return (_slope(graph, node, (graph.one,)),)


def _slope(graph: Graph, node: Node, d: Sequence[Node]) -> Node:
    """Return the derivative of an operation, given those of its operands."""
    a = node.args
    match node.op:
        case "add":
            return d[0] + d[1]
        case "sub":
            return d[0] - d[1]
        case "neg":
            return -d[0]
        case "mul":
            return d[0] * a[1] + a[0] * d[1]
        case "div":
            return (d[0] - node * d[1]) / a[1]
        case "sin":
            return graph.cos(a[0]) * d[0]
        case "cos":
            return -(graph.sin(a[0]) * d[0])
        case "sign":
            return graph.zero
        case "call":
            partials = _CALLS[node.value](graph, node, *a)
            return sum((p * x for p, x in zip(partials, d, strict=True)), graph.zero)
    raise ValueError(f"no derivative of the operation {node.op!r}")


def _power(graph: Graph, node: Node, x: Node, y: Node) -> tuple[Node, Node]:
    return y * graph.call("pow", x, y - 1), graph.call("log", x) * node


def _atan2(graph: Graph, node: Node, y: Node, x: Node) -> tuple[Node, Node]:
    r2 = x * x + y * y
    return x / r2, -(y / r2)


#: partial derivatives of the functions of C's math.h, by name
_CALLS: dict[str, Callable[..., tuple[Node, ...]]] = {
    "sqrt": lambda g, f, x: (0.5 / f,),
    "exp": lambda g, f, x: (f,),
    "log": lambda g, f, x: (1 / x,),
    "tan": lambda g, f, x: (f * f + 1,),
    "asin": lambda g, f, x: (1 / g.call("sqrt", 1 - x * x),),
    "acos": lambda g, f, x: (-1 / g.call("sqrt", 1 - x * x),),
    "atan": lambda g, f, x: (1 / (x * x + 1),),
    "sinh": lambda g, f, x: (g.call("cosh", x),),
    "cosh": lambda g, f, x: (g.call("sinh", x),),
    "tanh": lambda g, f, x: (1 - f * f,),
    "asinh": lambda g, f, x: (1 / g.call("sqrt", x * x + 1),),
    "acosh": lambda g, f, x: (1 / g.call("sqrt", x * x - 1),),
    "atanh": lambda g, f, x: (1 / (1 - x * x),),
    "fabs": lambda g, f, x: (g.sign(x),),
    "pow": _power,
    "atan2": _atan2,
}
