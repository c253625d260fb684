"""Common factors taken out of sums: a c + b c = (a + b) c."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from moro_codegen.graph.nodes import Graph, Node, schedule
from moro_codegen.passes.sums import SUMS, Sums, Term


def factored(results: Sequence[Node]) -> tuple[Node, ...]:
    """Return the same values with fewer multiplications.

    Every sum is looked at as a whole, with the products in it that nothing else uses. As long as a
    factor that several of them share saves operations, it is taken out; constants that meet fold.
    """
    order = schedule(results)
    sums = Sums(order, results)
    new: dict[Node, Node] = {}
    for node in order:
        shorter = None
        if node.op in SUMS and node not in sums.parts:
            terms = [(sign, [new.get(x, x) for x in factors]) for sign, factors in sums.terms(node)]
            shorter = _factored_sum(node.graph, terms)
        new[node] = shorter or node.graph.remake(node, [new.get(a, a) for a in node.args])
    return tuple(new.get(node, node) for node in results)


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
