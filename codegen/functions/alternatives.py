"""The same results in several ways: the one that takes the fewest operations, and its route."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from enum import Enum
from operator import itemgetter
from typing import NamedTuple, TypeAlias

from moro_codegen.graph.nodes import Graph, Node, Operand, price
from moro_codegen.passes import PASSES, Pass, lighter
from moro_codegen.passes.arrival import last, soonest


class Route(Enum):
    """How results were come by. Whatever checks them comes by another."""

    RECURSION = "recursion"
    CLOSED_FORM = "closed form"


class Alternative(NamedTuple):
    """Results, and the route that they were made by."""

    route: Route
    results: list[Node]


#: what makes nodes of a closed form that has no more than so many pairs of terms, in several ways
ClosedForms: TypeAlias = Callable[[int], Iterable[list[Node]]]

#: of the recursions, the cheapest few are looked at again without what their sums share, if they
#: take no more than so much longer than the first, by a ratio and additions
FINALISTS, BEHIND, ADDITIONS = 3, 1.03, 4
#: what takes longer is taken from the cheapest recursion as it is: no closed form is shorter
LONG = 2000
#: pairs of terms, for each operation of the recursion, with which closed forms still are shorter
PAIRS = 20


def nothing(_: int) -> tuple[()]:
    """Return no closed forms."""
    return ()


def cheapest(
    graph: Graph,
    recursions: Iterable[Sequence[Operand]],
    closed_form: ClosedForms = nothing,
    passes: Collection[Pass] = PASSES,
) -> Alternative:
    """Return the alternative of the lowest price; no closed form that is less accurate.

    Of recursions that cost the same, that whose results are there first.
    """
    from moro_codegen.graph.rounding import no_less_accurate  # numbers, which help does without

    found = [[graph.constant(x) for x in results] for results in recursions]
    prices = [*map(price, found)]
    least = min(prices)
    if least[1] > LONG:
        return Alternative(Route.RECURSION, found[prices.index(least)])
    first = sorted(zip(prices, found, strict=True), key=itemgetter(0))[:FINALISTS]
    most = least[0], least[1] * BEHIND + ADDITIONS
    near = [x for spent, x in first if spent <= most]
    best = min((lighter(x, passes) for x in near), key=lambda x: (price(x), last(soonest(x))))
    others = [lighter(x, passes) for x in closed_form(PAIRS * price(best)[1])]
    for other in sorted(others, key=price):
        if price(other) >= price(best):
            break
        if no_less_accurate(other, best):
            return Alternative(Route.CLOSED_FORM, other)
    return Alternative(Route.RECURSION, best)
