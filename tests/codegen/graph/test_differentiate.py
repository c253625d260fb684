"""Derivatives of graphs, and of the dynamics, against differences in high precision."""

import random

import numpy as np
import pytest
import sympy as sp
from arms import NAMES
from precise import differences, evaluate
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro_codegen.functions.catalogue import FUNCTIONS
from moro_codegen.functions.system import System
from moro_codegen.graph.derivatives import directional, gradient, jacobian
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, count, schedule
from moro_codegen.graph.precise import vanishing
from moro_codegen.program import generate

#: no inertia resists joint 6 of the UR5 as it is published: it has no forward dynamics
DYNAMIC = [name for name in NAMES if name != "ur5"]


def assert_derivatives(results, inputs):
    """Column by column, along a direction, and of a weighted sum."""
    variables, rng = list(inputs), np.random.default_rng(0)
    expected = differences(results, inputs, variables)

    def equal(nodes, values):
        found = list(map(float, evaluate(nodes, inputs)))
        np.testing.assert_allclose(found, values, rtol=1e-12, atol=1e-12)

    for row, values in zip(jacobian(results, variables), expected, strict=True):
        equal(row, values)
    graph = results[0].graph
    dx, w = rng.integers(-5, 5, len(variables)), rng.integers(-5, 5, len(results))
    direction = dict(zip(variables, map(graph.constant, dx.tolist()), strict=True))
    equal(directional(results, direction), expected @ dx)
    equal(gradient(results, list(map(graph.constant, w.tolist())), variables), w @ expected)


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
    results += [g.call(name, *pair) for name in ("fmax", "fmin") for pair in ((x, y), (y, x))]
    assert_derivatives(results, {x: 0.7, y: -0.4, z: 1.3})


def test_what_does_not_depend_costs_nothing():
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    ((dx, dy),) = jacobian([g.sin(x) * 3 + 1], [x, y])
    assert dy is g.zero
    assert dx is g.cos(x) * 3
    assert gradient([g.sin(x) * 3 + 1], [g.one], [x, y]) == [dx, dy]
    assert jacobian([], [x]) == gradient([], [], [x]) == directional([], {x: y}) == []


def test_what_cancels_vanishes():
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    one = g.sin(x) * g.sin(x) + g.cos(x) * g.cos(x)
    known, small = (one - 1) * y, g.constant(1e-30) * x
    assert vanishing([known, small, one, g.zero, x - y]) == {known, g.zero}
    assert vanishing([known, x / (one - 1)]) == set()


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


def routines(robot, *names):
    program = generate(robot, names)
    return {routine.function.name: routine for routine in program.routines}


def assert_derivatives_of(function, robot, seed=0):
    """All blocks of <function>_derivatives against differences of the function itself."""
    by_name = routines(robot, function, f"{function}_derivatives")
    rng, n = np.random.default_rng(seed), robot.dof
    plain, derived = by_name[function], by_name[f"{function}_derivatives"]
    graph = next(iter(plain.schedule)).graph
    arguments = [[graph.input(a.name, k) for k in range(n)] for a in plain.inputs]
    inputs = {x: float(rng.uniform(-2, 2)) for argument in arguments for x in argument}
    found = np.array(list(map(float, evaluate(derived.results, inputs)))).reshape(3, n, n)
    for block, variables in zip(found, arguments, strict=True):
        expected = differences(plain.results, inputs, variables)
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(block / scale, expected / scale, rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", NAMES)
def test_tau_derivatives(name):
    assert_derivatives_of("tau", mr.load(name))


@pytest.mark.parametrize("name", DYNAMIC)
def test_forward_dynamics_derivatives(name):
    assert_derivatives_of("forward_dynamics", mr.load(name))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("function", ["tau", "forward_dynamics"])
def test_derivatives_of_random_arms(function, seed):
    rng = random.Random(seed)
    robot = random_robot(rng, rng.randint(1, 5), rng.choice(["dh", "mdh"]))
    robot.viscous_friction = [sp.Rational(i, 3) for i in range(robot.dof)]
    robot.coulomb_friction = [(2, 1)] * robot.dof
    robot.rotor_inertias = [sp.Rational(1, i + 2) for i in range(robot.dof)]
    assert_derivatives_of(function, robot, seed)


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_kernels_of_derivatives_hold_together(backend, tmp_path):
    """dtau_dqdd is M, dqdd_dtau its inverse, and dqdd = -dqdd_dtau dtau at the same state."""
    robot = mr.load("stanford_arm")
    functions = ("tau", "tau_derivatives", "forward_dynamics_derivatives")
    kernel = mc.compile(robot, functions, directory=tmp_path, backend=backend)
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 5, 6))
    by_q, by_qd, M = kernel.tau_derivatives(q, qd, qdd)
    tau = kernel.tau(q, qd, qdd)
    a_by_q, a_by_qd, inverse = kernel.forward_dynamics_derivatives(q, qd, tau)
    np.testing.assert_allclose(inverse @ M, np.broadcast_to(np.eye(6), M.shape), atol=1e-9)
    np.testing.assert_allclose(a_by_q, -inverse @ by_q, atol=1e-7)
    np.testing.assert_allclose(a_by_qd, -inverse @ by_qd, atol=1e-7)
    linear = sp.Matrix.hstack(*robot.linearize(*map(list, (q[0], qd[0], tau[0]))))[6:, :]
    found = np.hstack([a_by_q[0], a_by_qd[0], inverse[0]])
    np.testing.assert_allclose(found, np.array(linear, dtype=float), rtol=1e-9, atol=1e-9)


#: second derivatives, and the function whose results they are the derivatives of, by its inputs
SECOND = {
    "tau_second_derivatives": ("tau_derivatives", [(0, "q"), (0, "qd"), (1, "qd"), (2, "q")]),
    "tau_hessian": ("tau_vjp", [(0, "q"), (0, "qd"), (1, "qd"), (0, "qdd")]),
    "forward_dynamics_hessian": (
        "forward_dynamics_vjp",
        [(0, "q"), (0, "qd"), (1, "qd"), (0, "tau")],
    ),
}


@pytest.mark.parametrize("name", SECOND)
@pytest.mark.parametrize("seed", range(2))
def test_second_derivatives(name, seed):
    """Every block against differences of the first derivatives in high precision."""
    rng = random.Random(seed)
    robot = random_robot(rng, 3, rng.choice(["dh", "mdh"]))
    robot.rotor_inertias = [sp.Rational(1, i + 2) for i in range(3)]
    first, blocks = SECOND[name]
    by_name = routines(robot, first, name)
    plain, derived = by_name[first], by_name[name]
    graph = next(iter(plain.schedule)).graph
    inputs = {
        graph.input(a.name, k): rng.uniform(-2, 2) for a in derived.inputs for k in range(a.size)
    }
    found = np.array(list(map(float, evaluate(derived.results, inputs)))).reshape(4, -1, 3)
    thirds = np.split(np.array(plain.results, object), 3)
    for block, (part, by) in zip(found, blocks, strict=True):
        variables = [graph.input(by, k) for k in range(3)]
        expected = differences(list(thirds[part]), inputs, variables)
        scale = max(1.0, np.abs(expected).max())
        np.testing.assert_allclose(block / scale, expected / scale, rtol=0, atol=1e-10)
