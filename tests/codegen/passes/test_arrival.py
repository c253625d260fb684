"""Sums and products take first what is there first: the same values and operations, sooner."""

from fractions import Fraction

import numpy as np
import pytest
from arms import reference_model
from exact import exact_values, random_expressions

from moro_codegen.graph.nodes import Graph, cost, count, schedule
from moro_codegen.passes import PASSES, Pass
from moro_codegen.passes.arrival import LATENCY, Arrival, last, soonest
from moro_codegen.program import generate


@pytest.fixture
def graph():
    return Graph()


def times(results):
    """When results are there as they are written."""
    arrival = Arrival()
    return [arrival.time(x) for x in results]


def test_what_comes_last_is_added_last(graph):
    a, b, c = (graph.input("x", i) for i in range(3))
    late = graph.sin(a)
    (total,) = soonest([late - b * c + b - a])
    assert total.op == "add"
    assert late in total.args
    assert times([total]) == [LATENCY["sin"] + LATENCY["add"]]
    assert last([total]) < last([late - b * c + b - a])


def test_what_comes_last_is_multiplied_last(graph):
    a, b, c = (graph.input("x", i) for i in range(3))
    late = graph.cos(a)
    (product,) = soonest([late * b * c * 3])
    assert late in product.args
    assert times([product]) == [LATENCY["cos"] + LATENCY["mul"]]


def test_a_product_is_one_operation_with_the_sum_that_it_is_added_to(graph):
    a, b, c = (graph.input("x", i) for i in range(3))
    late = graph.sin(a)
    assert times([late * b + c]) == [LATENCY["sin"] + LATENCY["add"]]
    assert times([late * b - late * c]) == [LATENCY["sin"] + LATENCY["mul"] + LATENCY["add"]]


def test_only_negative_terms(graph):
    a, b, c = (graph.input("x", i) for i in range(3))
    late = graph.sin(a)
    (total,) = soonest([-(late + b * c) - a])
    inputs = {"x": [Fraction(k) for k in (3, 5, 7)]}
    assert total.op == "neg"
    plain = graph.neg(graph.input("x", 0) + b * c + a)
    assert exact_values(soonest([plain]), inputs) == exact_values([plain], inputs) == [-41]


def test_what_is_used_twice_stays(graph):
    a, b, c = (graph.input("x", i) for i in range(3))
    pair = graph.sin(a) + b
    results = [pair + c, pair * c]
    assert operations(soonest(results)) == operations(results) == 4


@pytest.mark.parametrize("seed", range(20))
def test_random_expressions(graph, seed):
    results, inputs = random_expressions(np.random.default_rng(seed), graph, 6)
    assert exact_values(soonest(results), inputs) == exact_values(results, inputs)
    assert cost(soonest(results)) <= cost(results)


@pytest.mark.parametrize("arm", ["two_link", "stanford_arm", "puma560", "ur5", "panda"])
def test_packaged_arms(arm):
    model = reference_model(arm)
    written = torques(model, [x for x in PASSES if x is not Pass.ORDER_OF_ARRIVAL])
    arranged = torques(model, PASSES)
    assert cost(arranged) <= cost(written)
    assert last(soonest(arranged)) == last(arranged) < last(written)


def torques(model, passes):
    return generate(model, ("tau",), passes=passes).routines[0].results


def operations(results):
    return sum(count(schedule(results)).values())
