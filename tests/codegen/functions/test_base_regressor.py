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
from moro.abc import t
from moro_codegen.functions.base_regressor import regressor
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
