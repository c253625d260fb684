"""Linear models by the closed form, against differences of the recursion's forward dynamics.

The recursion is evaluated in 60 digits: nothing is shared but the model.
"""

import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from precise import differences
from robots import random_robot

import moro as mr
from moro import Robot
from moro.model import Drive
from moro_codegen.program import generate


def assert_linear_models_agree(robot, state):
    """``state``: q, qd and tau; the friction of joints at rest is no matter of slopes."""
    (routine,) = generate(robot, ("forward_dynamics",)).routines
    n, graph = robot.dof, next(iter(routine.schedule)).graph
    arguments = [[graph.input(a.name, k) for k in range(n)] for a in routine.inputs]
    values = [x for argument in arguments for x in argument]
    inputs = dict(zip(values, map(float, np.concatenate(state)), strict=True))
    expected = differences(routine.results, inputs, values)
    found = sp.Matrix.hstack(*robot.linearize(*map(list, state)))[n:, :]
    np.testing.assert_allclose(np.array(found, dtype=float), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["two_link", "puma560", "palletizer"])
def test_packaged_robots(name):
    robot = mr.load(name)
    robot = robot.with_parameters(robot.parameters)
    state = np.random.default_rng(1).uniform(-1, 1, (3, robot.dof))
    assert_linear_models_agree(robot, state)


@pytest.mark.parametrize("seed", range(4))
def test_random_robots_with_drives(seed):
    rng = random.Random(seed)
    model = random_robot(rng, 3, rng.choice(["dh", "mdh"])).model()
    friction = {"coulomb": (2, 1), "static": (3, 2), "viscous": sp.Rational(1, 2)}
    drives = [
        Drive(stiffness=3, rest=sp.Rational(1, 3), rotor_inertia=1),
        Drive(**friction, width=sp.Rational(1, 2)),
        Drive(**friction, stribeck_velocity=sp.Rational(1, 5)),
    ]
    parts = zip(model.coordinates, drives, strict=True)
    model = replace(model, coordinates=tuple(replace(x, drive=drive) for x, drive in parts))
    model = replace(model, not_set=frozenset())
    state = np.array([[rng.uniform(-1, 1) for _ in range(3)] for _ in range(3)])
    assert_linear_models_agree(Robot.of(model), state)
