"""Pose and Jacobian of the last frame: exactly how its points move."""

import random

import numpy as np
import pytest
from arms import NAMES, numeric, sincos
from dynamics import assert_close, by_formulas, exact_case, numbers, reference_case
from exact import moving_points
from recursion import forward_kinematics, jacobian, with_tip
from robots import random_robot

from moro.algorithms.kinematics import frame_acceleration, frame_velocity


def frame_points(case):
    """The origin of the last frame, and a point on each of its axes, as they move."""
    R, p = case.model.tip.placement.R, case.model.tip.placement.p
    ends = [[x + row[k] for x, row in zip(p, R, strict=True)] for k in range(3)]
    points = [[] for _ in range(case.n - 1)] + [[(1, tuple(end)) for end in (p, *ends)]]
    return moving_points(case.model, points, case.sincos, case.q, case.qd, case.qdd)


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    """Four points of frame n: its origin, and one on each axis."""
    case = exact_case(seed)
    (_, origin), *axes = frame_points(case)
    pose = forward_kinematics(case.model, case.q, case.sincos)
    assert list(pose.p) == [x.c[0] for x in origin]
    J = jacobian(case.model, case.q, case.sincos)
    v = [sum(x * rate for x, rate in zip(row, case.qd, strict=True)) for row in J]
    assert v[:3] == [x.c[1] for x in origin]
    for k, (_, end) in enumerate(axes):
        axis = [row[k] for row in pose.R]
        assert axis == [x.c[0] - o.c[0] for x, o in zip(end, origin, strict=True)]
        assert list(np.cross(v[3:], axis)) == [
            x.c[1] - o.c[1] for x, o in zip(end, origin, strict=True)
        ]


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model, pairs, state = reference_case(name)
    pose = forward_kinematics(model, state["q"].T, pairs)
    T = [[*row, x] for row, x in zip(pose.R, pose.p, strict=True)] + [[0, 0, 0, 1]]
    assert_close(T, np.moveaxis(state["T"], 0, -1))


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("n", [1, 3, 7])
def test_symbolic_route(n, convention):
    robot = random_robot(random.Random(n), n, convention)
    q = np.random.default_rng(n).uniform(-3, 3, (n, 5))
    model = numeric(robot.model())
    form, ring = by_formulas(robot, q)
    columns = form.geometry.jacobian(form.model.tip, (ring.zero,) * 3)
    J = [list(row) for row in zip(*columns, strict=True)]
    assert_close(jacobian(model, q, sincos(model, q)), numbers(J))
    pose = forward_kinematics(model, q, sincos(model, q))
    R, p = form.geometry.pose(form.model.tip)
    assert_close(pose.R, numbers(R))
    assert_close(pose.p, numbers(p))


@pytest.mark.parametrize("seed", range(12))
def test_motion_of_the_frame(seed):
    """Of its origin as a point moves; turning as its axes do, which accelerate by U."""
    case = exact_case(seed)
    (_, origin), *axes = frame_points(case)
    arm = with_tip(case.model, case.q, case.sincos)
    (omega, v), (alpha, a) = (
        frame_velocity(arm, case.qd),
        frame_acceleration(arm, case.qd, case.qdd),
    )
    assert list(v) == [x.c[1] for x in origin]
    assert list(a) == [2 * x.c[2] for x in origin]
    for _, end in axes:
        axis, rate, change = (
            [
                f * (x.c[f] - o.c[f]) if f else x.c[0] - o.c[0]
                for x, o in zip(end, origin, strict=True)
            ]
            for f in (0, 1, 2)
        )
        assert list(np.cross(omega, axis)) == rate
        assert list(np.cross(alpha, axis) + np.cross(omega, rate)) == change
