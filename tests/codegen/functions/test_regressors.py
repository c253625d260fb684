"""The regressor in base parameters: that of the symbolic route, and Y p = tau."""

import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from arms import NAMES
from programs import evaluate
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro.abc import t
from moro.model import Body
from moro_codegen.functions.regressors import regressor
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph
from moro_codegen.pipeline import build
from moro_codegen.program import generate, routine


def states(n, count=10):
    return np.random.default_rng(n).uniform(-3, 3, (3, count, n))


def program(robot):
    """The program of tau and the regressor."""
    tau = generate(robot)
    graph = Graph()
    symbols = {symbol: graph.input("parameters", k) for k, symbol in enumerate(robot.parameters)}
    system = System(graph, robot.model().map(Converter(graph, symbols)), parameters=symbols)
    return replace(tau, routines=(routine(system, regressor(robot.model())), *tau.routines))


def with_drives(n, convention):
    robot = random_robot(random.Random(n), n, convention)
    robot.rotor_inertias = [sp.Rational(i + 1, 4) for i in range(n)]
    robot.viscous_friction = [i + 2 for i in range(n)]
    robot.coulomb_friction = [(i + 1, 2) for i in range(n)]
    return robot


@pytest.mark.parametrize("name", NAMES)
def test_packaged_arms(name):
    robot = mr.load(name)
    Y, tau = program(robot).routines
    y, p = evaluate(Y, *states(robot.dof))
    (expected,) = evaluate(tau, *states(robot.dof))
    assert y.shape == (10, robot.dof, len(robot.base_parameters()))
    error = np.einsum("sib,sb->si", y, p) - expected
    assert np.abs(error).max() <= 1e-14 * np.abs(expected).max()


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_symbolic_route(n, convention):
    robot = with_drives(n, convention)
    symbolic = robot.regressor()
    q, qd, qdd = states(n, 4)
    variables = [x for k in (2, 1, 0) for x in (v.diff(t, k) if k else v for v in robot.qs)]
    numbers = sp.lambdify(variables, symbolic.Y, "numpy")
    y, p = evaluate(program(robot).routines[0], q, qd, qdd)
    for k in range(4):
        expected = numbers(*qdd[k], *qd[k], *q[k])
        assert np.abs(y[k] - expected).max() <= 1e-13 * np.abs(expected).max()
        np.testing.assert_allclose(p[k], np.array(symbolic.p, float).ravel(), rtol=1e-13)


def test_header_and_docstring_name_the_parameters(tmp_path):
    robot = with_drives(2, "dh")
    kernel = build(program(robot), tmp_path / "kernel", "numpy")
    names = ", ".join(str(x) for x in robot.base_parameters().symbols)
    assert names in kernel.regressor.__doc__
    Y, p = kernel.regressor(*states(2, 5))
    assert Y.shape == (5, 2, p.shape[1])


def test_parameters_at_run_time(tmp_path):
    robot = with_drives(2, "mdh")
    load = sp.Symbol("load")
    robot.masses = [robot.masses[0], load]
    assert list(robot.parameters) == [load]
    kernel = build(program(robot), tmp_path / "kernel", "numpy")
    q, qd, qdd = states(2, 1)[:, 0]
    Y, p = kernel.regressor(q, qd, qdd, parameters={"load": 3.5})
    np.testing.assert_allclose(Y @ p, kernel.tau(q, qd, qdd, parameters={"load": 3.5}), rtol=1e-13)


REQUESTS = (
    *(name for name in mc.FUNCTIONS if name.endswith("regressor")),
    mc.Regressor(of="tau_passivity", standard=True),
    mc.Regressor(of="momentum", standard=True, values=False),
)


def twice(body):
    inertia = tuple(tuple(2 * x for x in row) for row in body.inertia)
    return Body(2 * body.mass, tuple(2 * x for x in body.first_moment), inertia)


@pytest.mark.parametrize("name", ["two_link", "palletizer"])
def test_every_kind_is_verified(name, tmp_path):
    robot = mr.load(name)
    kernel = mc.compile(robot, REQUESTS, tmp_path, "numpy")
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors
    assert len(verification.errors) == len(REQUESTS)
    standard = 10 * len(robot.model().bodies) + robot.dof  # and a rotor each
    assert kernel.standard_regressor(*states(robot.dof)[:, 0])[0].shape == (robot.dof, standard)
    model = robot.model()
    heavier = replace(model, bodies=tuple(twice(body) for body in model.bodies))
    errors = mc.verify(kernel, heavier).max_errors
    assert errors.pop("standard_momentum_regressor") < 1e-12  # whose p is the heavier arm's
    assert min(errors.values()) > 1e-3


@pytest.mark.parametrize("options", [{}, {"zeros": True}, {"standard": True}])
def test_without_values(options, tmp_path):
    """Y alone: p is the robot's, the same for all samples."""
    robot = mr.load("stanford_arm")
    names = mc.Regressor(**options, values=False), ("tau", mc.Regressor(**options))
    kernel = mc.compile(robot, names, tmp_path, "numpy")
    state = states(6)
    name = "standard_regressor" if "standard" in options else "regressor"
    Y, (tau, same, p) = getattr(kernel, name)(*state), getattr(kernel, f"tau_{name}")(*state)
    np.testing.assert_allclose(Y, same, atol=1e-12)
    np.testing.assert_allclose(Y @ p[0], tau, rtol=1e-12, atol=1e-12)
    assert mc.verify(kernel, robot).passed


def test_parameters_that_vary_keep_their_columns(tmp_path):
    """A payload that is nothing by default; a standard parameter that is zero."""
    robot = mr.load("two_link")
    payload = sp.Symbol("payload")
    robot.masses = [1, payload]
    robot.parameters = {payload: 0}
    kernel = mc.compile(robot, ("regressor", "standard_regressor", "tau"), tmp_path, "numpy")
    state = states(2)
    for mass in (0.0, 2.5):
        tau = kernel.tau(*state, {"payload": mass})
        for function in (kernel.regressor, kernel.standard_regressor):
            Y, p = function(*state, {"payload": mass})
            np.testing.assert_allclose(np.einsum("sib,sb->si", Y, p), tau, atol=1e-12)


def test_what_is_wrong_is_said():
    with pytest.raises(ValueError, match="of tau, tau_passivity, momentum, not of 'bias'"):
        mc.Regressor(of="bias")
    with pytest.raises(ValueError, match="has all of them: leave zeros"):
        mc.Regressor(zeros=True, standard=True)
