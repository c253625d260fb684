"""What the timings of the command are made of; no time is tested."""

import math

import pytest
import sympy as sp

from moro import Robot
from moro.abc import q1
from moro_codegen.benchmark import lambdify_tau


@pytest.mark.parametrize("name", ["m", "sin", "cos", "lambda", "math", "x0", "q1", "not a name"])
def test_lambdify_takes_parameters_of_any_name(name):
    robot = Robot((2, 0, 0, q1))
    robot.masses = [sp.Symbol(name)]
    robot.cm_positions = [[0, 0, 0]]
    robot.inertia_tensors = [[[0, 0, 0]] * 3]
    robot.gravity = [0, -10, 0]
    (tau,) = lambdify_tau(robot)(0.5, 1.0, 3.0, 7.0)
    assert tau == pytest.approx(7 * (4 * 3 + 10 * 2 * math.cos(0.5)))
