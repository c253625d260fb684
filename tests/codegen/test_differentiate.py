"""Derivatives of graphs against differences in high precision, and against the dynamics."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from arms import NAMES
from moro_codegen.convert import Converter
from moro_codegen.differentiate import jacobian
from moro_codegen.functions import FUNCTIONS, System
from moro_codegen.graph import Graph, count, schedule

import moro as mr

CALLS = {"fabs": abs, "pow": mpmath.power}


def evaluate(results, inputs):
    """Values of nodes in mpmath's precision; ``inputs`` maps input nodes to numbers."""
    values = dict(inputs)

    def value(node):
        if node.op != "const":
            return values[node]
        exact = Fraction(node.value)
        return mpmath.mpf(exact.numerator) / exact.denominator

    operations = {
        "add": lambda a, b: a + b,
        "sub": lambda a, b: a - b,
        "mul": lambda a, b: a * b,
        "div": lambda a, b: a / b,
        "neg": lambda a: -a,
        "sin": mpmath.sin,
        "cos": mpmath.cos,
        "sign": mpmath.sign,
    }
    for node in schedule(results):
        name = node.value if node.op == "call" else None
        function = CALLS.get(name) or getattr(mpmath, name) if name else operations[node.op]
        values[node] = function(*map(value, node.args))
    return [value(node) for node in results]


def assert_derivatives(results, inputs):
    """Compare every derivative with a central difference of 60-digit numbers."""
    variables = list(inputs)
    exact = [evaluate(row, inputs) for row in jacobian(results, variables)]
    with mpmath.workdps(60):
        step = mpmath.mpf(10) ** -20
        for j, variable in enumerate(variables):
            here = mpmath.mpf(inputs[variable])
            above = evaluate(results, inputs | {variable: here + step})
            below = evaluate(results, inputs | {variable: here - step})
            for i in range(len(results)):
                difference = (above[i] - below[i]) / (2 * step)
                assert float(exact[i][j]) == pytest.approx(float(difference), rel=1e-12, abs=1e-12)


def test_every_operation():
    g = Graph()
    x, y, z = (g.input("q", k) for k in range(3))
    results = [
        x + y * z - 3,
        -(x * x) * y,
        (x - y) / (z + 2),
        g.sin(x + y) * g.cos(z * x),
        g.sign(x) * y,
        g.constant(5),
        z,
    ]
    results += [g.call(name, x) for name in ("sqrt", "exp", "log", "tan", "asin", "acos", "atan")]
    results += [g.call(name, x) for name in ("sinh", "cosh", "tanh", "asinh", "atanh", "fabs")]
    results += [g.call("acosh", x + 1), g.call("atan2", x, y), g.call("pow", x, y)]
    assert_derivatives(results, {x: 0.7, y: -0.4, z: 1.3})


def test_what_does_not_depend_costs_nothing():
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    ((dx, dy),) = jacobian([g.sin(x) * 3 + 1], [x, y])
    assert dy is g.zero
    assert dx is g.cos(x) * 3
    assert jacobian([], [x]) == []


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_of_tau(name):
    model, g = mr.load(name).model(), Graph()
    system = System(g, model.map(Converter(g, {})))
    q, qd, qdd = ([g.input(v, k) for k in range(model.dof)] for v in ("q", "qd", "qdd"))
    (tau,) = FUNCTIONS["tau"].build(system, q, qd, qdd)
    rng = np.random.default_rng(0)
    inputs = {node: float(rng.uniform(-2, 2)) for node in (*q, *qd, *qdd)}
    assert_derivatives(list(tau), inputs)


def test_work_is_shared_with_the_function():
    """One pass for all: far fewer operations than 3 n evaluations of tau would take."""
    model, g = mr.load("puma560").model(), Graph()
    system = System(g, model.map(Converter(g, {})))
    inputs = [[g.input(v, k) for k in range(6)] for v in ("q", "qd", "qdd")]
    (tau,) = FUNCTIONS["tau"].build(system, *inputs)
    variables = [node for argument in inputs for node in argument]
    entries = [x for row in jacobian(list(tau), variables) for x in row]
    ops, all_ops = count(schedule(tau)), count(schedule(entries))
    arithmetic = ("add", "sub", "mul")
    assert sum(all_ops[k] for k in arithmetic) < 8 * sum(ops[k] for k in arithmetic)
    assert all_ops["sincos"] == ops["sincos"]
