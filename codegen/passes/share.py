"""What several sums have in common, computed once: common divisors of all sums of a graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from moro_codegen.graph.nodes import Constant, Graph, Node, schedule
from moro_codegen.passes.divisors import Cube, Divided, divided, pairs
from moro_codegen.passes.sums import SUMS, Sums

#: a sum of products of nodes, with the coefficient of each
Polynomial: TypeAlias = Mapping[tuple[Node, ...], Constant]


def shared(results: Sequence[Node], most: int) -> list[Node]:
    """Return the same values with what sums, and products, have in common computed once.

    Every sum is looked at as a whole, with those sums and products in it that nothing else uses.
    Where they have more than ``most`` pairs of terms, the results are returned as they are.
    """
    order = schedule(results)
    sums = Sums(order, results)
    whole = [n for n in order if (n.op in SUMS or n.op == "mul") and n not in sums.parts]
    numbered = _Numbered([_collected(sums.terms(node)) for node in whole])
    if numbered.pairs > most:
        return list(results)
    new: dict[Node, Node] = {}
    shorter = _Builder(numbered, lambda node: new.get(node, node))
    places = {node: k for k, node in enumerate(whole)}
    for node in order:
        if node in places:
            new[node] = shorter.polynomial(places[node], node.graph)
        elif node not in sums.parts:
            new[node] = node.graph.remake(node, [new.get(a, a) for a in node.args])
    return [new.get(node, node) for node in results]


def nodes_of(polynomials: Sequence[Polynomial], graph: Graph, most: int) -> list[Node] | None:
    """Return the values of polynomials, what they have in common computed once.

    None if they have more than ``most`` pairs of terms.
    """
    distinct = list({frozenset(p.items()): p for p in polynomials}.values())
    numbered = _Numbered(distinct)
    if numbered.pairs > most:
        return None
    shorter = _Builder(numbered, lambda node: node)
    made = [shorter.polynomial(k, graph) for k in range(len(distinct))]
    found = {frozenset(p.items()): node for p, node in zip(distinct, made, strict=True)}
    return [found[frozenset(p.items())] for p in polynomials]


def _collected(terms: Sequence[tuple[int, Sequence[Node]]]) -> Polynomial:
    """Return the terms of a sum with their constants as coefficients, alike ones as one."""
    found: dict[tuple[Node, ...], Constant] = {}
    for sign, factors in terms:
        c: Constant = sign
        for factor in factors:
            if factor.op == "const":
                c = c * factor.value
        rest = sorted((x for x in factors if x.op != "const"), key=lambda x: x.index)
        cube = tuple(rest)
        found[cube] = found.get(cube, 0) + c
    return {cube: c for cube, c in found.items() if c != 0}


class _Numbered:
    """Polynomials in numbers for the nodes that are their factors."""

    def __init__(self, polynomials: Sequence[Polynomial]) -> None:
        numbers: dict[Node, int] = {}
        self.polynomials: list[dict[Cube, Constant]] = [
            {
                tuple(sorted(numbers.setdefault(x, len(numbers)) for x in cube)): c
                for cube, c in polynomial.items()
            }
            for polynomial in polynomials
        ]
        self.factors = list(numbers)
        self.pairs = pairs(self.polynomials)


class _Builder:
    """Makes nodes of numbered polynomials, divided by what they have in common."""

    def __init__(self, numbered: _Numbered, new: Callable[[Node], Node]) -> None:
        self._factors, self._new = numbered.factors, new
        self._divided: Divided = divided(numbered.polynomials, len(numbered.factors))
        self._divisors: dict[int, Node] = {}

    def polynomial(self, k: int, graph: Graph) -> Node:
        """Return the value of a polynomial; its factors must have been made."""
        return self._sum(self._divided.polynomials[k], graph)

    def _sum(self, polynomial: Mapping[Cube, Constant], graph: Graph) -> Node:
        """Return a sum of products, negative ones last."""
        total = graph.zero
        for cube, c in sorted(polynomial.items(), key=lambda term: term[1] < 0):
            product = graph.one
            for x in cube:
                product = product * self._factor(x, graph)
            product = product * abs(c)
            total = total + product if c > 0 else total - product
        return total

    def _factor(self, x: int, graph: Graph) -> Node:
        if x < len(self._factors):
            return self._new(self._factors[x])
        if x not in self._divisors:
            divisor = self._divided.divisors[x - len(self._factors)]
            self._divisors[x] = self._sum(divisor, graph)
        return self._divisors[x]
