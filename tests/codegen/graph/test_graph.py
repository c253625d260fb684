"""The expression graph: what never comes into being, what is exact, what is counted."""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from exact import exact_values, random_expressions

from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, constant_value, cost, count, fewest, schedule
from moro_codegen.passes.factor import factored


@pytest.fixture
def graph():
    return Graph()


@pytest.fixture
def abc(graph):
    return [graph.input(name, 0) for name in "abc"]


def ops(*results):
    found = count(schedule(results))
    return {op: n for op, n in found.items() if n}


def test_equal_nodes_are_one_node(graph, abc):
    a, b, c = abc
    assert a + b is b + a
    assert a * b is b * a
    assert (a + b) * c is c * (b + a)
    assert a - b is -(b - a)
    assert graph.sin(a) is graph.sin(a)
    assert graph.input("a", 0) is a
    assert graph.constant(1) is graph.constant(1.0) is graph.constant(Fraction(1))


def test_neutral_elements(graph, abc):
    a, b, _ = abc
    for result in (
        a + 0,
        0 + a,
        a - 0,
        a * 1,
        1 * a,
        a / 1,
        graph.neg(-a),
        a * -1 * -1,
        (a - b) + b,
    ):
        assert result is a
    for result in (a * 0, 0 * a, a - a, a + -a, 0 / a, a * b - b * a):
        assert result is graph.zero
    assert a / a is graph.one
    assert a + a is 2 * a
    assert 0 - a is -a


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (lambda a, b: a + -b, lambda a, b: a - b),
        (lambda a, b: a - -b, lambda a, b: a + b),
        (lambda a, b: -a + b, lambda a, b: b - a),
        (lambda a, b: -a - b, lambda a, b: -(a + b)),
        (lambda a, b: -a * b, lambda a, b: -(a * b)),
        (lambda a, b: -a * -b, lambda a, b: a * b),
        (lambda a, b: -3 * a + b, lambda a, b: b - 3 * a),
        (lambda a, b: -a / b, lambda a, b: -(a / b)),
        (lambda a, b: a / -b, lambda a, b: -(a / b)),
        (lambda a, b: -2 / b, lambda a, b: -(2 / b)),
        (lambda a, b: 2 * (3 * a), lambda a, b: 6 * a),
        (lambda a, b: a / 4, lambda a, b: Fraction(1, 4) * a),
        (lambda a, b: (a + 2) + 3, lambda a, b: a + 5),
        (lambda a, b: (a - 2) + 3, lambda a, b: a + 1),
        (lambda a, b: (2 - a) - 3, lambda a, b: -1 - a),
        (lambda a, b: (a + 2) - 2, lambda a, b: a),
        (lambda a, b: (a + b) - b, lambda a, b: a),
        (lambda a, b: (a - b) - a, lambda a, b: -b),
        (lambda a, b: a - (a + b), lambda a, b: -b),
        (lambda a, b: a - (a - b), lambda a, b: b),
        (lambda a, b: a.graph.sin(-a), lambda a, b: -a.graph.sin(a)),
        (lambda a, b: a.graph.cos(-a), lambda a, b: a.graph.cos(a)),
        (lambda a, b: a.graph.sign(-a), lambda a, b: -a.graph.sign(a)),
    ],
)
def test_normal_forms(abc, expression, expected):
    a, b, _ = abc
    assert expression(a, b) is expected(a, b)


def test_constants_are_exact(graph):
    third = graph.constant(Fraction(1, 3))
    assert (third + third + third) is graph.one
    assert (graph.constant(0.1) * 3).value == 0.1 * 3
    assert graph.constant(2.0).value == Fraction(2)
    assert graph.sin(0) is graph.zero
    assert graph.cos(0) is graph.one
    assert [graph.sign(x).value for x in (-3, 0, 0.5)] == [-1, 0, 1]
    assert graph.sin(0.5).value == math.sin(0.5)


def test_floats_that_cancel_are_zero(graph):
    root = graph.constant(math.sqrt(2))
    assert root * root - 2 is graph.zero
    assert graph.constant(0.1) + 0.2 - 0.3 is graph.zero
    assert (root - 1.4).value == math.sqrt(2) - 1.4  # far from rounding


def test_impossible_constants(graph, abc):
    for bad in (math.nan, math.inf):
        with pytest.raises(ValueError, match="finite"):
            graph.constant(bad)
    with pytest.raises(ZeroDivisionError):
        abc[0] / 0


def test_schedule(graph, abc):
    a, b, c = abc
    unused = a * c
    results = [graph.sin(a + b) * c, graph.zero, c, a + b]
    order = schedule(results)
    assert unused not in order
    assert {node.op for node in order} == {"add", "sin", "mul"}
    for i, node in enumerate(order):
        assert all(operand in order[:i] for operand in node.args if operand.args)


def test_count(graph, abc):
    a, b, c = abc
    results = [-(a * b) / c, graph.sin(a) - graph.cos(a), graph.cos(b), graph.sign(a)]
    results.append(graph.call("sqrt", a))
    assert ops(*results) == {"sub": 2, "mul": 1, "div": 1, "sincos": 2, "sign": 1, "call": 1}


def test_fewest(graph, abc):
    a, b, c = abc
    assert cost([a * c + b * c]) == 3 > cost([(a + b) * c]) == 2
    assert fewest([[a * c + b * c], [(a + b) * c]], graph) == [(a + b) * c]
    assert fewest([[graph.sin(a)], [a * b + c * c]], graph) == [a * b + c * c]


def test_numbers_are_recognised(graph, abc):
    assert constant_value(3) == constant_value(graph.constant(3)) == 3
    assert constant_value(abc[0]) is None
    assert constant_value("3") is None


class TestFactored:
    @pytest.mark.parametrize(
        ("expression", "expected"),
        [
            (lambda a, b, c: a * c + b * c, {"add": 1, "mul": 1}),
            (lambda a, b, c: a * c - b - b * c, {"sub": 2, "mul": 1}),
            (lambda a, b, c: 2 * a + b + 3 * a, {"add": 1, "mul": 1}),
            (lambda a, b, c: a * b + 3 * (a * b), {"mul": 2}),
            (lambda a, b, c: a + 3 * a, {"mul": 1}),
            (lambda a, b, c: a * a * b + c + a * a * a, {"add": 2, "mul": 2}),
            (lambda a, b, c: 5 * a - c + 5 * b, {"add": 1, "sub": 1, "mul": 1}),
            (lambda a, b, c: a * b + c, {"add": 1, "mul": 1}),
        ],
    )
    def test_examples(self, abc, expression, expected):
        (result,) = factored([expression(*abc)])
        assert ops(result) == expected

    def test_what_is_used_elsewhere_stays(self, abc):
        """With a c and b c wanted anyway, a c + b c is one addition."""
        a, b, c = abc
        results = [a * c, b * c, a * c + b * c]
        assert list(factored(results)) == results

    @pytest.mark.parametrize("seed", range(20))
    def test_random_expressions(self, graph, seed):
        """Exactly the same values, never more operations."""
        results, inputs = random_expressions(np.random.default_rng(seed), graph, 5)
        fewer = factored(results)
        assert exact_values(fewer, inputs) == exact_values(results, inputs)
        assert sum(ops(*fewer).values()) <= sum(ops(*results).values())


class TestConverter:
    @pytest.fixture
    def convert(self, graph):
        self.x, self.y = sp.symbols("x y", real=True)
        return Converter(graph, {self.x: graph.input("x", 0), self.y: graph.input("y", 0)})

    def test_numbers(self, convert):
        assert convert(sp.Rational(1, 3)).value == Fraction(1, 3)
        assert convert(sp.cos(sp.pi / 7)).value == math.cos(math.pi / 7)
        assert convert(sp.Float("0.1")).value == 0.1
        assert convert(0.25).value == 0.25
        assert convert(sp.sqrt(2) ** 2).value == 2

    def test_expressions(self, convert):
        x, y = self.x, self.y
        a, b = convert(x), convert(y)
        graph = a.graph
        assert convert(x + 2 * y) is a + 2 * b
        assert convert(x**3) is a * (a * a)
        assert convert(1 / x**2) is 1 / (a * a)
        assert convert(sp.sqrt(x)) is graph.call("sqrt", a)
        assert convert(x ** sp.Rational(-3, 2)) is 1 / (
            graph.call("sqrt", a) * (graph.call("sqrt", a) * graph.call("sqrt", a))
        )
        assert convert(x**y) is graph.call("pow", a, b)
        assert convert(sp.sin(x) * sp.tan(y)) is graph.sin(a) * graph.call("tan", b)
        assert convert(sp.atan2(x, y)) is graph.call("atan2", a, b)

    @pytest.mark.parametrize(
        "bad", [sp.sqrt(-1), sp.oo, sp.nan, sp.Symbol("z"), sp.gamma(sp.Symbol("x", real=True))]
    )
    def test_refused(self, convert, bad):
        with pytest.raises(ValueError, match="number"):
            convert(bad)
