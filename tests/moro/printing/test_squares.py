"""Squares and products of sums, and sums that are taken out, where that is shorter."""

import random

import pytest
import sympy as sp
from robots import planar

from moro import Robot
from moro.abc import g, l1, l2, l3, lc1, lc2, lc3, m1, m2, m3, q1, q2, q3, t

c2, c23 = sp.cos(q2), sp.cos(q2 + q3)
qd1, qd2 = q1.diff(t), q2.diff(t)


@pytest.fixture(scope="module")
def robot():
    return planar(3)


@pytest.mark.parametrize(
    "short",
    [
        (l1 + l2) ** 2,
        m1 * (l1 + l2 + l3) ** 2 + m2,
        l3 - 3 * (l1 - 2 * l2) ** 2,
        m2 * (l2 * sp.cos(q1) + l3 * sp.cos(q1 + q2)) ** 2,
        (l1 * qd1 + l2 * qd2) ** 2,
        m1 * (qd1 + qd2) ** 2 / 2,
        m1 * ((l1 - lc1) ** 2 + l2**2),
        (l1 + l2) ** 2 + (l3 - lc1) ** 2,
        l1**2 + 2 * l1 * l2 * sp.cos(q2) + l2**2,
        m1 * (l1**2 + l1 * l2 + l2**2),
        l1 * (m2 + m3) + lc1 * m1,
        (l1 + l2) * (m1 - m2) * (l3 + lc1),
        (m3 + lc1**2 * m1) * (g + lc2**2 * m2),
        (2 * l1 + 3 * l2) * (m1 + m2 + m3),
        (l1 * sp.cos(q1) + l2 * sp.cos(q1 + q2)) * (l1 * m2 + l2 * m3),
        (l1 + l2) * (l1 - l2) * (l1 + l3),
    ],
)
def test_what_is_short_stays_so(robot, short):
    found = robot.simplify(sp.expand(short))
    assert sp.expand(found - short) == 0
    assert found.count_ops() <= short.count_ops()


@pytest.mark.parametrize("seed", range(12))
def test_it_is_the_same_and_never_longer(robot, seed):
    """Sums of random squares and monomials: equal to what they were, and no longer."""
    rng = random.Random(seed)
    symbols = [l1, l2, l3, m1, m2, q1.diff(t), sp.cos(q1), sp.cos(q1 + q2)]

    def monomial():
        return rng.choice([1, 2, -1, 3]) * sp.Mul(*rng.sample(symbols, rng.randint(1, 2)))

    squares = [sum(monomial() for _ in range(rng.randint(2, 3))) ** 2 for _ in range(2)]
    expr = sum(squares) + monomial()
    found = robot.simplify(expr)
    assert robot.simplify(found - expr) == 0
    assert found.count_ops() <= sp.expand(expr).count_ops()


def test_an_elbow_arm():
    """Siciliano et al., section 2.9.4: an anthropomorphic arm of point masses."""
    arm = Robot((0, sp.pi / 2, 0, q1), (l2, 0, 0, q2), (l3, 0, 0, q3))
    arm.masses, arm.cm_positions = [0, 0, m3], [[0, 0, 0]] * 3
    arm.inertia_tensors = [sp.zeros(3, 3)] * 3
    assert arm.inertia_matrix()[0, 0] == m3 * (l2 * c2 + l3 * c23) ** 2


def test_a_slide():
    arm = Robot((0, 0, 0, q1), (0, sp.pi / 2, 0, q2), (0, 0, q3, 0, "p"))
    arm.masses, arm.cm_positions = [0, 0, m3], [[0, 0, 0]] * 2 + [[0, 0, -lc3]]
    arm.inertia_tensors = [sp.zeros(3, 3)] * 3
    (entry,) = {*arm.inertia_matrix()[:2, :2]}
    assert sp.expand(entry - m3 * (q3 - lc3) ** 2) == 0
    assert str(entry) == "m_3*(l_c3 - q_3(t))**2"


def test_masses_that_are_carried_are_taken_out(robot):
    G = robot.gravity_vector()
    assert G[0].has(l1 * (m2 + m3) + lc1 * m1)
    short = g * (lc3 * m3 * sp.cos(q1 + q2 + q3) + (l2 * m3 + lc2 * m2) * sp.cos(q1 + q2))
    assert G[1] == short
