"""Rows that move by joint variables of other rows, by several, or by multiples."""

import pytest
import sympy as sp

import moro as mr
from moro import Robot
from moro.abc import d1, g, l1, l2, q1, q2, q3, q4, q5, t

r = sp.Symbol("r")


def arm(*thetas):
    """Links of length 1 with masses at their ends, turning about axes that are not all parallel."""
    twists = [sp.pi / 2, 0, 0, -sp.pi / 2, 0]
    robot = Robot(*((1, twist, d1, theta) for twist, theta in zip(twists, thetas, strict=False)))
    n = len(thetas)
    robot.masses = sp.symbols(f"m_1:{n + 1}")
    robot.cm_positions = [[0, 0, k] for k in range(n)]
    robot.inertia_tensors = [[1, 2, 2]] * n
    robot.gravity = [0, 0, -g]
    return robot


def test_torques_are_those_of_the_free_arm_at_the_joint_variables():
    """tau = A^T tau_x for x = A q: a palletizer, whose fourth joint turns back what two have."""
    free, coupled = arm(q1, q2, q3, q4, q5), arm(q1, q2, q3, -q2 - q3, q4)
    assert (coupled.dof, len(coupled.masses)) == (4, 5)
    A = sp.Matrix(5, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, -1, 0, 0, 0, 0, 1])
    there = dict(zip(free.qs, A * sp.Matrix(coupled.qs), strict=True))
    tau = sp.Matrix([equation.lhs for equation in free.dynamic_model()])
    expected = A.T * tau.subs(there, simultaneous=True).doit()
    found = sp.Matrix([equation.lhs for equation in coupled.dynamic_model()])
    assert coupled.simplify(found - expected).is_zero_matrix
    N = coupled.inertia_matrix().diff(t) - 2 * coupled.coriolis_matrix()
    assert coupled.simplify(N + N.T).is_zero_matrix


def test_joints_that_count_the_other_way():
    up, down = arm(q1, q2), arm(q1, -q2)
    turned = up.inertia_matrix().subs(q2, -q2)
    assert down.inertia_matrix()[1, 1] == turned[1, 1]
    assert down.simplify(down.inertia_matrix()[0, 1] + turned[0, 1]) == 0
    slide = Robot((0, 0, sp.Rational("0.246") - q1, 0, "p"))
    assert slide.T[2, 3] == sp.Rational("0.246") - q1


def test_ratios_in_symbols_are_parameters():
    robot = arm(q1, r * q2)
    assert r in robot.parameters
    assert (
        robot.simplify(robot.inertia_matrix()[1, 1] - r**2 * arm(q1, q2).inertia_matrix()[1, 1])
        == 0
    )
    assert r not in robot.with_parameters({r: 2}).parameters


def test_what_is_per_row_and_what_per_joint_variable():
    robot = arm(q1, q2, -q1 - q2)
    robot.rotor_inertias, robot.joint_limits = [1, 2], [(0, 1), None]
    assert robot.inertia_matrix()[0, 0] - arm(q1, q2, -q1 - q2).inertia_matrix()[0, 0] == 1
    assert robot.joint_limits == [(0, 1), (-sp.pi, sp.pi)]
    assert robot.qs == [q1, q2]
    assert "-q_1(t) - q_2(t)" in str(robot.dh_table)
    with pytest.raises(ValueError, match="masses must have 3 values, one for each link, not 2"):
        robot.masses = [1, 2]
    with pytest.raises(ValueError, match="rotor_inertias must have 2 values, one for each joint"):
        robot.rotor_inertias = [1, 2, 3]


def test_order_is_that_of_the_rows():
    assert Robot((l1, 0, 0, q2), (l2, 0, 0, q1 + q2)).qs == [q2, q1]


def test_joint_variables_that_cannot_be_told_apart():
    with pytest.raises(ValueError, match="too many by one"):
        Robot((1, 0, 0, q1 + q2), (1, 0, 0, 2 * q1 + 2 * q2))
    differential = Robot((1, 0, 0, q1 + q2), (1, 0, 0, q1 - q2))
    assert differential.dof == 2


def test_saved_and_loaded(tmp_path):
    robot = arm(q1, q2, q3, -q2 - q3, q4 + sp.pi / 2)
    robot.rotor_inertias = [0, 1, 2, 3]
    robot.save(tmp_path / "arm.yaml")
    assert "theta: -q2 - q3\n" in (tmp_path / "arm.yaml").read_text()
    same = mr.load(tmp_path / "arm.yaml")
    assert same.model() == robot.model()
    assert same.convention == "dh"
    assert same.rotor_inertias == [0, 1, 2, 3]


NAMED = """\
name: named
convention: dh
gravity: [0, 0, -9.81]
links:
  - joint: revolute
    name: upper
    joint_name: shoulder
    a: 1
    alpha: pi/2
    d: 0
    theta: 0
  - joint: revolute
    a: 1
    alpha: 0
    d: 0
    theta: 0
  - joint: revolute
    name: hand
    joint_name: wrist
    a: 1
    alpha: 0
    d: 0
    theta: -q1 - q2
"""


def test_rows_with_names_stay_rows(tmp_path):
    (tmp_path / "named.yaml").write_text(NAMED)
    robot = mr.load(tmp_path / "named.yaml")
    robot.masses = None  # as of Robot(row, ..)
    assert robot.convention == "dh"
    assert robot.joint_names == ["shoulder", "joint2"]
    assert robot.T_i0("upper") == robot.T_i0(1)
    assert robot.T_i0("hand") == robot.T
    assert [x.name for x in robot.model().joints] == ["shoulder", "", "wrist"]
    again = mr.load(tmp_path / "named.yaml")
    again.save(tmp_path / "again.yaml")
    assert (tmp_path / "again.yaml").read_text() == NAMED
    assert robot.with_parameters({"m_1": 1}).joint_names == robot.joint_names
