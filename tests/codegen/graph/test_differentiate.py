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
from moro_codegen.graph.derivatives import gradient, jacobian
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, count, schedule
from moro_codegen.graph.precise import vanishing
from moro_codegen.program import generate

#: no inertia resists joint 6 of the UR5 as it is published: it has no forward dynamics
DYNAMIC = [name for name in NAMES if name != "ur5"]


def assert_derivatives(results, inputs):
    variables = list(inputs)
    exact = [list(map(float, evaluate(row, inputs))) for row in jacobian(results, variables)]
    expected = differences(results, inputs, variables)
    np.testing.assert_allclose(exact, expected, rtol=1e-12, atol=1e-12)
    weights = [k - 2.5 for k in range(len(results))]
    sums = gradient(results, [variables[0].graph.constant(w) for w in weights], variables)
    found = list(map(float, evaluate(sums, inputs)))
    np.testing.assert_allclose(found, weights @ expected, rtol=1e-12, atol=1e-12)


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
    assert gradient([g.sin(x) * 3 + 1], [g.one], [x, y]) == [dx, dy]
    assert jacobian([], [x]) == gradient([], [], [x]) == []


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
