"""What makes functions small, in order: the same torques from an arm in fewer numbers.

frames   where frames are, how they are turned, and the unit of length
reduce   base inertial parameters
factor   common factors of a sum
share    common divisors of several sums
arrival  terms in the order in which they are there
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from enum import Enum
from itertools import chain

from moro.algorithms.posture import Posture
from moro_codegen.graph.nodes import Node, cost
from moro_codegen.passes.arrival import soonest
from moro_codegen.passes.factor import factored
from moro_codegen.passes.frames import (
    along_common_normals,
    common_normals,
    has_parameters,
    in_unit,
    turnable_leaves,
    turnable_parallels,
    unturned,
)
from moro_codegen.passes.reduce import reduced
from moro_codegen.passes.share import shared


class Pass(Enum):
    """One way to need fewer operations, the last one less time; each builds on those before it."""

    COMMON_NORMALS = "common normals"
    X_AXES = "x axes along them"
    BASE_PARAMETERS = "base parameters"
    BALANCING_MASSES = "balancing masses"
    UNIT_OF_LENGTH = "unit of length"
    LAST_LINKS = "last links not turned"
    PARALLEL_AXES = "parallel axes summed"
    COMMON_FACTORS = "common factors"
    COMMON_DIVISORS = "common divisors"
    CLOSED_FORMS = "closed forms"
    ORDER_OF_ARRIVAL = "order of arrival"


#: all of them, in order
PASSES = tuple(Pass)

#: pairs of terms among which common divisors are looked for: so many take about a second, and a
#: tenth of it; with more than a few it is done only once
MOST_PAIRS, FEW_PAIRS = 12_000, 1_200


def equivalent_postures(arm: Posture, passes: Collection[Pass] = PASSES) -> Iterator[Posture]:
    """Yield the arm in the descriptions that may need the fewest operations, for one to choose."""
    for placed in chain.from_iterable(_placed(x, passes) for x in _turned(arm, passes)):
        leaves = turnable_leaves(placed) if Pass.LAST_LINKS in passes else frozenset()
        parallel = turnable_parallels(placed) if Pass.PARALLEL_AXES in passes else frozenset()
        for moved in _reduced(placed, passes):
            for turned in dict.fromkeys([leaves | parallel, leaves, parallel, frozenset()]):
                scaled = in_unit(moved, turned) if Pass.UNIT_OF_LENGTH in passes else moved
                yield unturned(scaled, turned)


def rearranged(arm: Posture, passes: Collection[Pass] = PASSES) -> Iterator[Posture]:
    """Yield the arm with other frames, but the last: its bodies and lengths stay what they are."""
    arms = [*_turned(arm, passes)]
    if Pass.COMMON_NORMALS in passes:
        arms += [moved for turned in tuple(arms) for moved in _placed(turned, passes)]
    yield from arms
    if Pass.PARALLEL_AXES in passes:
        yield from (unturned(placed, turnable_parallels(placed)) for placed in arms)


def lighter(results: Sequence[Node], passes: Collection[Pass] = PASSES) -> list[Node]:
    """Return the same values with the commonest factors and divisors taken out of sums, at once."""
    factor = factored if Pass.COMMON_FACTORS in passes else list
    first = factor(results)
    return list(factor(shared(first, MOST_PAIRS)) if Pass.COMMON_DIVISORS in passes else first)


def condensed(results: Sequence[Node], passes: Collection[Pass] = PASSES) -> list[Node]:
    """Return the same values with common factors and divisors taken out of sums, results sooner.

    In turns, as long as that saves something.
    """
    factor = factored if Pass.COMMON_FACTORS in passes else list
    results = list(factor(results))
    if Pass.COMMON_DIVISORS in passes:
        for most in (MOST_PAIRS, FEW_PAIRS, FEW_PAIRS):
            shorter = list(factor(shared(results, most)))
            if cost(shorter) >= cost(results):
                break
            results = shorter
    return soonest(results) if Pass.ORDER_OF_ARRIVAL in passes else results


def _turned(arm: Posture, passes: Collection[Pass]) -> Iterator[Posture]:
    """Yield the arm as it is, and with other x axes if it has others."""
    yield arm
    if Pass.X_AXES in passes and (turned := along_common_normals(arm)) != arm:
        yield turned


def _placed(arm: Posture, passes: Collection[Pass]) -> Iterator[Posture]:
    return common_normals(arm) if Pass.COMMON_NORMALS in passes else iter((arm,))


def _reduced(arm: Posture, passes: Collection[Pass]) -> Iterator[Posture]:
    """Yield the arm in its base parameters; also without moving run-time parameters, if it has."""
    if Pass.BASE_PARAMETERS not in passes:
        yield arm
        return
    balanced = Pass.BALANCING_MASSES in passes
    for constants_only in (False, True) if has_parameters(arm) else (False,):
        yield reduced(arm, balanced=balanced, constants_only=constants_only)
