"""Sums as wholes: the products that make up a sum, whatever order they are added in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TypeAlias

from moro_codegen.graph.nodes import Node

#: a product, as its factors, with its sign
Term: TypeAlias = tuple[int, list[Node]]

SUMS = ("add", "sub", "neg")


class Sums:
    """The sums and products of a graph, each with those parts of it that nothing else uses."""

    def __init__(self, order: Sequence[Node], results: Sequence[Node]) -> None:
        uses = Counter(operand for node in order for operand in node.args)
        uses.update(results)
        # what is used once, by a sum or as a factor of a product, is a part of that
        self.parts = {
            operand
            for node in order
            if node.op in SUMS or node.op == "mul"
            for operand in node.args
            if uses[operand] == 1 and (operand.op == "mul" or node.op in SUMS)
        }

    def terms(self, node: Node) -> list[Term]:
        """Return the products that make up a sum, or the one that a product is."""
        terms: list[Term] = []
        stack = [(1, node)]
        while stack:
            sign, item = stack.pop()
            if item.op in SUMS and (item is node or item in self.parts):
                if item.op == "neg":
                    stack.append((-sign, item.args[0]))
                else:
                    stack.append((sign if item.op == "add" else -sign, item.args[1]))
                    stack.append((sign, item.args[0]))
            elif item.op == "mul" and (item is node or item in self.parts):
                terms.append((sign, [x for part in item.args for x in self._factors(part)]))
            else:
                terms.append((sign, [item]))
        return terms

    def _factors(self, node: Node) -> list[Node]:
        """Return the factors that make up a product."""
        if node.op != "mul" or node not in self.parts:
            return [node]
        return [factor for operand in node.args for factor in self._factors(operand)]
