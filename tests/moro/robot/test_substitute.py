"""Values put into results, all at once."""

import numpy as np
import pytest
import sympy as sp
from robots import planar

import moro as mr
from moro.abc import g, l1, lc1, lc2, m1, m2, q1, q2, t

qd1, qd2 = q1.diff(t), q2.diff(t)
qdd1, qdd2 = q1.diff(t, 2), q2.diff(t, 2)


@pytest.fixture(scope="module")
def robot():
    return planar(2)


def test_rates_stay_symbols_where_positions_are_numbers(robot):
    C = robot.substitute(robot.coriolis_matrix(), q=[0, sp.pi / 2])
    h = -m2 * l1 * lc2
    assert sp.Matrix([[h * qd2, h * (qd1 + qd2)], [-h * qd1, 0]]) == C
    assert robot.substitute(qd1 + q1 + q2, q=[0.25, None]) == qd1 + 0.25 + q2


def test_numbers_are_exact_or_floats_as_they_are_given(robot):
    G = robot.gravity_vector()
    assert robot.substitute(G, q=[0, sp.pi / 6])[1] == sp.sqrt(3) * g * lc2 * m2 / 2
    values = {"g": 9.81, m1: 1, m2: 1, l1: 1, lc1: 0.5, lc2: 0.5}
    found = robot.substitute(G, q=np.array([0.1, 0.2]), parameters=values)
    expected = [9.81 * (1.5 * np.cos(0.1) + 0.5 * np.cos(0.3)), 9.81 * 0.5 * np.cos(0.3)]
    np.testing.assert_allclose(np.array(found, dtype=float).ravel(), expected)


def test_symbols_change_places_at_once(robot):
    a, b = sp.symbols("a b")
    found = robot.substitute(q1 - 2 * q2 + qd1, q=[q2, q1], qd=[a, b])
    assert found == q2 - 2 * q1 + a


def test_rates_follow_a_trajectory_unless_they_are_given(robot):
    left = sp.Matrix([equation.lhs for equation in robot.dynamic_model()])
    path = [sp.sin(t), 2]
    found = robot.substitute(left, q=path)
    orders = [[sp.diff(x, t, k) for x in path] for k in range(3)]
    assert robot.simplify(found - robot.substitute(left, *orders)) == sp.zeros(2, 1)
    assert not found.atoms(sp.Derivative)
    assert robot.substitute(qdd1 + qd1, q=path, qd=[3, 4]) == 3 + qdd1
    assert robot.substitute(q1.diff(t, 3) + q2.diff(t, 3), qdd=path) == sp.cos(t)


def test_whatever_results_come_as(robot):
    equations = robot.dynamic_model()
    still = robot.substitute(equations, q=[0, 0], qd=[0, 0], qdd=[0, 0])
    assert type(still) is type(equations)
    assert [x.rhs for x in still] == list(sp.symbols("tau_1 tau_2"))
    assert still[1].lhs == g * lc2 * m2
    Y, p = robot.substitute(robot.regressor(), q=[0, 0], qd=[0, 0], qdd=[0, 0])
    assert (Y * p - sp.Matrix([x.lhs for x in still])).expand() == sp.zeros(2, 1)
    M = robot.substitute(robot.inertia_matrix(collect=True), q=[0, 0], parameters={m2: 3})
    k1, k2, *_ = M.constants
    assert M[0, 0] == k1 + 2 * k2
    assert M.constants[k2] == 3 * l1 * lc2
    assert (M.expand() - robot.inertia_matrix().subs({q2: 0, m2: 3})).expand() == sp.zeros(2, 2)
    assert robot.substitute([q1, (q2, 1)], q=[3, 4]) == [3, (4, 1)]


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        ({"q": [1]}, ValueError, "q must have 2 values, one for each joint, not 1"),
        ({"qd": [1, "x"]}, TypeError, "qd of joint 2 must be a number or a SymPy expression"),
        ({"qdd": [1, sp.oo]}, ValueError, "qdd of joint 2 must be finite, not oo"),
        ({"parameters": {"m_3": 1}}, ValueError, 'm_3 is not a symbol .* did you mean "m_1"'),
    ],
)
def test_what_cannot_be_put_in(robot, given, error, said):
    with pytest.raises(error, match=said):
        robot.substitute(q1, **given)


def test_what_nothing_can_be_put_into(robot):
    with pytest.raises(TypeError, match="takes an expression, a matrix, equations, not 'q'"):
        robot.substitute("q", q=[1, 2])


def test_coordinates_that_are_plain_symbols():
    theta = sp.Symbol("theta")
    arm = mr.Robot((l1, 0, 0, theta))
    assert arm.substitute(arm.T, q=[sp.pi / 2])[1, 3] == l1
