"""Trigonometric polynomials, as closed forms are written, to sums of products of nodes."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from moro.scalars.relations import Coefficient, Monomial
from moro.scalars.trig import TrigRing
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Constant, Node


def polynomial(
    terms: Mapping[Monomial, Coefficient], ring: TrigRing, convert: Converter
) -> dict[tuple[Node, ...], Constant]:
    """Return the coefficient of every product of nodes; numbers among the generators are in it.

    ``terms`` are those of a polynomial of the ring.
    """
    found: dict[tuple[Node, ...], Constant] = {}
    for monomial, number in terms.items():
        c: Constant = Fraction(number)
        factors: list[Node] = []
        for index, exponent in ring.exponents(monomial):
            node = convert(ring.generators[index])
            if node.op == "neg":  # sin(-x)
                node, c = node.args[0], c * (-1) ** exponent
            if node.op == "const":
                c = c * node.value**exponent
            else:
                factors += [node] * exponent
        cube = tuple(sorted(factors, key=lambda node: node.index))
        found[cube] = found.get(cube, 0) + c
    return {cube: c for cube, c in found.items() if c != 0}
