"""Sums and products take what is there first: results come sooner, with the same operations.

Calls that wait for each other take as long as the longest chain of operations from an input to a
result. A term that comes last holds up a sum of n by one addition if it is added last, by n - 1 if
it is added first.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from itertools import count

from moro_codegen.graph.nodes import Graph, Node, schedule
from moro_codegen.passes.sums import SUMS, Sums

#: cycles until the result of an operation is there, on the processors of today
LATENCY = {
    "add": 4, "sub": 4, "mul": 4, "neg": 1, "div": 13, "sin": 60, "cos": 60, "sign": 4, "call": 60,
}  # fmt: skip


def last(results: Sequence[Node]) -> int:
    """Return when the last of the results is there, in cycles after the inputs."""
    arrival = Arrival()
    for node in schedule(results):
        arrival.time(node)
    return max(map(arrival.time, results), default=0)


def soonest(results: Sequence[Node]) -> list[Node]:
    """Return the same values with the operands of every sum and product in the order they arrive.

    Parts that something else uses stay what they are, so the operations are the same, or fewer
    where two sums become one.
    """
    order = schedule(results)
    sums, arrival = Sums(order, results), Arrival()
    new: dict[Node, Node] = {}
    for node in order:
        if node.op not in (*SUMS, "mul"):
            new[node] = node.graph.remake(node, [new.get(a, a) for a in node.args])
            arrival.time(new[node])  # operands first: long chains take no recursion
        elif node not in sums.parts:
            terms = sums.terms(node)
            new[node] = arrival.sum(
                node.graph, [(sign, [new.get(x, x) for x in factors]) for sign, factors in terms]
            )
    return [new.get(node, node) for node in results]


class Arrival:
    """When nodes are there, in cycles after the inputs."""

    def __init__(self) -> None:
        self._times: dict[Node, int] = {}

    def time(self, node: Node) -> int:
        """Return when a node is there. A product that is added is one operation with the sum."""
        if not node.args:
            return 0
        found = self._times.get(node)
        if found is None:
            starts = [max(map(self.time, node.args))]
            if node.op in ("add", "sub"):
                for fused, other in (node.args, node.args[::-1]):
                    if fused.op == "mul":
                        starts.append(max(self.start(fused), self.time(other)))
            found = self._times[node] = LATENCY[node.op] + min(starts)
        return found

    def start(self, term: Node) -> int:
        """Return when a term of a sum is needed: when its factors are there, if it is a product."""
        return max(map(self.time, term.args)) if term.op == "mul" else self.time(term)

    def sum(self, graph: Graph, terms: Iterable[tuple[int, list[Node]]]) -> Node:
        """Return the sum of signed products, each operation as soon as it can be."""
        signed = [(sign, self._product(factors)) for sign, factors in terms]
        (sign, total), *others = sorted(signed, key=lambda term: self.start(term[1]))
        for other, node in others:
            if other == sign:
                total = graph.add(total, node)
            else:
                total = graph.sub(total, node) if sign > 0 else graph.sub(node, total)
                sign = 1
        return total if sign > 0 else graph.neg(total)

    def _product(self, factors: Iterable[Node]) -> Node:
        """Return the product, of two that are there first at a time."""
        order = count()
        waiting = [(self.time(x), next(order), x) for x in factors]
        heapq.heapify(waiting)
        while len(waiting) > 1:
            (*_, a), (*_, b) = heapq.heappop(waiting), heapq.heappop(waiting)
            heapq.heappush(waiting, (self.time(a * b), next(order), a * b))
        return waiting[0][-1]
