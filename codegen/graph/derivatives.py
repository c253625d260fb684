"""Derivatives of graphs.

Forwards, one pass a variable or direction, through the nodes it reaches and no others; backwards,
one pass for all variables, for one weighted sum of the results. What a joint does not move has no
derivative and costs nothing. The sine and the cosine of an angle are each other's derivatives, so
they are at hand. The graph makes equal nodes only once, so what the derivatives share with each
other, and with the function itself, is computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from moro_codegen.graph.nodes import Graph, Node, schedule


def jacobian(results: Sequence[Node], variables: Sequence[Node]) -> list[list[Node]]:
    """Return d results_i / d variables_j as nodes, a list of rows.

    The derivative of ``sign`` is 0: it has none where it jumps.
    """
    if not results:
        return []
    graph, order = results[0].graph, schedule(results)
    columns = [_along(graph, order, results, {variable: graph.one}) for variable in variables]
    return [list(row) for row in zip(*columns, strict=True)]


def directional(results: Sequence[Node], direction: Mapping[Node, Node]) -> list[Node]:
    """Return the derivatives of the results along {variable: component}: a Jacobian-vector product.

    With velocities for components, they are rates.
    """
    return _along(results[0].graph, schedule(results), results, direction) if results else []


def gradient(
    results: Sequence[Node], weights: Sequence[Node], variables: Sequence[Node]
) -> list[Node]:
    """Return d (weights . results) / d variables: a vector-Jacobian product.

    Backwards, so it takes a few times the operations of the results for any number of variables
    (Griewank & Walther 2008, ch. 3). The weights are held fixed.
    """
    if not results:
        return []
    graph = results[0].graph
    felt: dict[Node, Node] = {}
    for result, weight in zip(results, weights, strict=True):
        felt[result] = felt.get(result, graph.zero) + weight
    for node in reversed(schedule(results)):
        if (weight := felt.get(node, graph.zero)) is not graph.zero:
            for operand, share in zip(node.args, _shares(graph, node, weight), strict=True):
                if operand.op != "const":
                    felt[operand] = felt.get(operand, graph.zero) + share
    return [felt.get(variable, graph.zero) for variable in variables]


def _along(
    graph: Graph, order: Sequence[Node], results: Sequence[Node], direction: Mapping[Node, Node]
) -> list[Node]:
    """Return the derivatives of the results along a direction."""
    slopes = dict(direction)
    for node in order:
        if any(operand in slopes for operand in node.args):
            slope = _slope(graph, node, [slopes.get(a, graph.zero) for a in node.args])
            if slope is not graph.zero:
                slopes[node] = slope
    return [slopes.get(node, graph.zero) for node in results]


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


def _shares(graph: Graph, node: Node, weight: Node) -> tuple[Node, ...]:
    """Return how much of the weight of an operation falls on each of its operands."""
    a = node.args
    match node.op:
        case "add":
            return weight, weight
        case "sub":
            return weight, -weight
        case "neg":
            return (-weight,)
        case "mul":
            return weight * a[1], weight * a[0]
        case "div":
            share = weight / a[1]
            return share, -(share * node)
        case "sin":
            return (graph.cos(a[0]) * weight,)
        case "cos":
            return (-(graph.sin(a[0]) * weight),)
        case "sign":
            return (graph.zero,)
        case "call":
            return tuple(weight * p for p in _CALLS[node.value](graph, node, *a))
    raise ValueError(f"no derivative of the operation {node.op!r}")


def _power(graph: Graph, node: Node, x: Node, y: Node) -> tuple[Node, Node]:
    return y * graph.call("pow", x, y - 1), graph.call("log", x) * node


def _atan2(graph: Graph, node: Node, y: Node, x: Node) -> tuple[Node, Node]:
    r2 = x * x + y * y
    return x / r2, -(y / r2)


def _chosen(s: Node) -> tuple[Node, Node]:
    return (1 + s) / 2, (1 - s) / 2


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
    "fmax": lambda g, f, x, y: _chosen(g.sign(x - y)),
    "fmin": lambda g, f, x, y: _chosen(g.sign(y - x)),
    "pow": _power,
    "atan2": _atan2,
}
