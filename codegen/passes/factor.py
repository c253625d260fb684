"""Common factors taken out of sums: a c + b c = (a + b) c."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from moro_codegen.graph.nodes import Graph, Node, schedule

#: a product, as its factors, with its sign
Term = tuple[int, list[Node]]

SUMS = ("add", "sub", "neg")


def factored(results: Sequence[Node]) -> tuple[Node, ...]:
    """Return the same values with fewer multiplications.

    Every sum is looked at as a whole, with the products in it that nothing else uses. As long as a
    factor that several of them share saves operations, it is taken out; constants that meet fold.
    """
    order = schedule(results)
    uses = Counter(operand for node in order for operand in node.args)
    uses.update(results)
    # what is used once, by a sum or as a factor of a product, is a part of that
    parts = {
        operand
        for node in order
        if node.op in SUMS or node.op == "mul"
        for operand in node.args
        if uses[operand] == 1 and (operand.op == "mul" or node.op in SUMS)
    }
    new: dict[Node, Node] = {}
    for node in order:
        shorter = None
        if node.op in SUMS and node not in parts:
            shorter = _factored_sum(node.graph, _terms(node, parts, new))
        new[node] = shorter or node.graph.remake(node, [new.get(a, a) for a in node.args])
    return tuple(new.get(node, node) for node in results)


def _terms(node: Node, parts: set[Node], new: dict[Node, Node]) -> list[Term]:
    """Return the products that make up a sum."""
    terms: list[Term] = []
    stack = [(1, node)]
    while stack:
        sign, item = stack.pop()
        if item.op in SUMS and (item is node or item in parts):
            if item.op == "neg":
                stack.append((-sign, item.args[0]))
            else:
                stack.append((sign if item.op == "add" else -sign, item.args[1]))
                stack.append((sign, item.args[0]))
        else:
            terms.append((sign, _factors(item, parts, new)))
    return terms


def _factors(node: Node, parts: set[Node], new: dict[Node, Node]) -> list[Node]:
    """Return the factors that make up a product."""
    if node.op != "mul" or node not in parts:
        return [new.get(node, node)]
    return [factor for operand in node.args for factor in _factors(operand, parts, new)]


def _factored_sum(graph: Graph, terms: list[Term]) -> Node | None:
    """Return the sum with common factors taken out, or None where that saves nothing."""
    gained = False
    while (factor := _best_factor(terms)) is not None:
        gained = True
        inside: list[Term] = []
        outside: list[Term] = []
        for sign, factors in terms:
            if factor in factors:
                rest = list(factors)
                rest.remove(factor)
                inside.append((sign, rest))
            else:
                outside.append((sign, factors))
        terms = [(1, [factor, _factored_sum(graph, inside) or _sum(graph, inside)]), *outside]
    return _sum(graph, terms) if gained else None


def _best_factor(terms: list[Term]) -> Node | None:
    """Return the factor whose taking out saves the most operations, None if none saves any."""
    saved: Counter[Node] = Counter()
    constants: Counter[Node] = Counter()
    for _, factors in terms:
        for factor in set(factors):
            saved[factor] += len(factors) > 1
            if len(factors) == 1 or (
                len(factors) == 2 and factors[factors[0] is factor].op == "const"
            ):
                constants[factor] += 1
    for factor, count in constants.items():
        saved[factor] += max(count - 1, 0)
    best = max(saved, key=lambda factor: (saved[factor], -factor.index), default=None)
    return best if best is not None and saved[best] > 1 else None


def _sum(graph: Graph, terms: list[Term]) -> Node:
    """Return the sum of products; an empty product is 1."""
    total = graph.zero
    for sign, factors in terms:
        product = graph.one
        for factor in factors:
            product = product * factor
        total = total + product if sign > 0 else total - product
    return total
