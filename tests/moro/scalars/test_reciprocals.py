"""Quotients: equal ones are identical, whatever they are written as."""

import random

import pytest
import sympy as sp
from robots import planar

from moro.abc import g, l1, l2, lc1, lc2, m1, m2, q1, q2
from moro.scalars.random_point import RandomPoint
from moro.scalars.trig import TrigRing

mp, rp, MX = sp.symbols("m_p r_p MX")
s, c = sp.sin(q1), sp.cos(q1)


@pytest.fixture
def ring():
    ring = TrigRing()
    ring.declare_angles([(q1, q1), (q2, q1 + q2)])
    return ring


@pytest.mark.parametrize(
    "zero",
    [
        m1 / (m1 + m2) + m2 / (m1 + m2) - 1,
        1 / (2 * m1 + 2 * m2) - 1 / (m1 + m2) / 2,
        1 / (m2 - m1) + 1 / (m1 - m2),
        1 / (l1 + l2) + 1 / (l1 - l2) - 2 * l1 / (l1**2 - l2**2),
        1 / (m1**2 + m1 * m2) - 1 / m1 / (m1 + m2),
        1 / l1 - 1 / l2 - (l2 - l1) / (l1 * l2),
        1 / (l1 * (1 / l1 + 1 / l2)) - l2 / (l1 + l2),
        1 / (1 + 1 / (1 + 1 / m1)) - (m1 + 1) / (2 * m1 + 1),
        (l1**3 - l2**3) / (l1 - l2) - l1**2 - l1 * l2 - l2**2,
        1 / ((l1 + l2) * (l1 + m1) * (l1 + m2)) * (l1 + m1) - 1 / ((l1 + l2) * (l1 + m2)),
        0.5 / (0.5 * l1 + 0.25) - 2 / (2 * l1 + 1),
        sp.sqrt(2) / (2 * l1) - 1 / (sp.sqrt(2) * l1),
        1 / (sp.sqrt(l1) + 1) * (sp.sqrt(l1) + 1) - 1,
        sp.exp(l1) / sp.exp(l1) - 1,
        1 / c**2 - sp.tan(q1) ** 2 - 1,
        sp.cot(q1) * sp.tan(q1) - 1,
        sp.sec(q1) * s - sp.tan(q1),
        s / (1 + c) - (1 - c) / s,
        (m1 + m2 - m2 * c**2) / (m1 + m2 * s**2) - 1,
        sp.sin(q1 + q2) / sp.cos(q2) - sp.cos(q1) * sp.tan(q2) - s,
    ],
)
def test_what_is_zero_is_zero(ring, zero):
    assert not ring.convert(zero)


@pytest.mark.parametrize("seed", range(3))
def test_equal_quotients_are_identical(ring, seed):
    """Fractions of sums, over one denominator, in partial fractions, in another order."""
    rng = random.Random(seed)
    x, y, z = sp.symbols("x y z")
    pool = [x, x + y, x - y, x + 2 * z, x * y + 1, y - z, x**2 + z]

    def fraction():
        below = sp.Mul(*rng.sample(pool, 2))
        return (rng.choice([x, y, z, 1]) + rng.randint(-2, 2)) / below

    terms = [fraction() for _ in range(3)]
    whole = sp.cancel(sp.Add(*terms))
    found = sum((ring.convert(term) for term in terms), ring.zero)
    assert found == ring.convert(whole)
    assert found == ring.convert(sp.apart(whole, rng.choice([x, y, z])))
    slope = ring.convert(sp.cancel(whole.diff(x)))
    assert ring.diff(found, x) == slope
    values = {x: 0.3, y: 0.7, z: 1.9}
    assert ring.evaluate(found, values) == pytest.approx(float(whole.subs(values)))
    point = RandomPoint(ring, [], 2, seed)
    assert list(point.evaluate(found)) == list(point.convert(whole))


def test_a_division_by_zero_is_said(ring):
    with pytest.raises(ZeroDivisionError, match="by which is divided, is zero"):
        ring.convert(sp.Pow(s**2 + c**2 - 1, -1))


def test_a_lumped_payload_gives_the_polynomial_that_it_is():
    """The README's: its com is (m_1 r_1 + m_p r_p) / (m_1 + m_p)."""
    robot = planar(2)
    robot.masses = [m1 + mp, m2]
    robot.cm_positions = [[(m1 * lc1 + mp * rp) / (m1 + mp) - l1, 0, 0], [lc2 - l2, 0, 0]]
    expected = g * ((m1 * lc1 + mp * rp + m2 * l1) * sp.cos(q1) + m2 * lc2 * sp.cos(q1 + q2))
    found = robot.gravity_vector()[0]
    assert robot.simplify(found - expected) == 0
    assert found.count_ops() <= expected.count_ops() + 1
    robot = planar(2)
    robot.cm_positions = [[MX / m1, 0, 0], [lc2 - l2, 0, 0]]
    still = robot.gravity_vector().subs({m2: 0, q1: 0})[0]
    assert still == g * (MX + l1 * m1)


def test_quotients_are_shown_the_short_way():
    robot = planar(2)
    for short in (l1 / (l1**2 - l2**2), (m1 + m2) ** -2, m1 / (m1 + m2), m1 * m2 / (m1 + m2)):
        assert robot.simplify(sp.apart(short, short.free_symbols.pop())) == short
    assert robot.simplify(sp.tan(q1)) == s / c
