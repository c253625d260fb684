"""What sums have in common, computed once: the same values, never more operations."""

from fractions import Fraction

import numpy as np
import pytest
from arms import reference_model
from exact import exact_values, random_expressions

from moro_codegen.graph.nodes import Graph, cost, count, schedule
from moro_codegen.passes import PASSES, Pass, condensed
from moro_codegen.passes.divisors import divided, pairs
from moro_codegen.passes.share import nodes_of, shared
from moro_codegen.program import generate

MOST = 10_000


@pytest.fixture
def graph():
    return Graph()


def operations(results):
    return sum(count(schedule(results)).values())


@pytest.mark.parametrize(
    ("sums", "expected"),
    [
        # (a + 2 b) times c, d and 3
        (lambda a, b, c, d: [a * c + 2 * b * c, a * d + 2 * b * d, 3 * a + 6 * b], 5),
        (lambda a, b, c, d: [a * b * c, a * b * d], 3),
        (lambda a, b, c, d: [5 * a + b, 5 * a * c], 3),
        # a + b + c, of which no term is next to the other in both
        (lambda a, b, c, d: [a + b + c + d, a + (c - d) + b], 4),
        (lambda a, b, c, d: [a * a * b + a * a * c, a * a], 3),
        (lambda a, b, c, d: [a * b + c, a * d - c], 4),
    ],
)
def test_examples(graph, sums, expected):
    results = sums(*(graph.input("x", i) for i in range(4)))
    assert operations(condensed(shared(results, MOST))) == expected


@pytest.mark.parametrize("seed", range(20))
def test_random_expressions(graph, seed):
    """Exactly the same values, not more operations."""
    results, inputs = random_expressions(np.random.default_rng(seed), graph, 6)
    for fewer in (shared(results, MOST), condensed(results)):
        assert exact_values(fewer, inputs) == exact_values(results, inputs)
    assert cost(condensed(results)) <= cost(results)


def test_too_much_is_left_alone(graph):
    a, b, c, d = (graph.input("x", i) for i in range(4))
    results = [a * c + b * c, a * d + b * d]
    assert shared(results, 1) == results != shared(results, 2)
    polynomial = {(a,): Fraction(1), (b,): Fraction(2), (): Fraction(3)}
    assert nodes_of([polynomial], graph, 2) is None
    assert nodes_of([polynomial, polynomial], graph, 3) == [a + 2 * b + 3] * 2


def test_multiples_of_a_sum_share_it():
    """x (a + 2 b) and y (-3 a - 6 b): factors 0 and 1 times 2 and 3."""
    polynomials = [{(0, 2): 1, (1, 2): 2}, {(0, 3): Fraction(-3), (1, 3): Fraction(-6)}]
    found = divided(polynomials, 4)
    assert found.polynomials == [{(2, 4): 1}, {(3, 4): -3}]
    assert found.divisors == [{(0,): 1, (1,): 2}]
    assert pairs(polynomials) == 2


def test_the_same_every_time():
    """Byte for byte: nothing depends on what was generated before, or on hashes."""
    model = reference_model("ur5")
    first, second = (generate(model, ("jacobian",)).routines[0] for _ in range(2))
    assert [repr(x) for x in first.schedule] == [repr(x) for x in second.schedule]


def test_what_it_saves():
    model = reference_model("stanford_arm")
    without = [x for x in PASSES if x is not Pass.COMMON_DIVISORS]
    most, fewest = (
        cost(generate(model, rigid=True, passes=passes).routines[0].results)
        for passes in (without, PASSES)
    )
    assert fewest <= 220 + 30 < most
