"""The canonical form: equal polynomials are identical, and calculus agrees with SymPy's."""

import random

import numpy as np
import pytest
import sympy as sp

from moro.abc import alpha1, l1, q1, q2, q3, q4
from moro.scalars.trig import MAX_EXPONENT, TrigRing

VARIABLES = (q1, q2, q3, q4)


@pytest.fixture
def ring():
    ring = TrigRing()
    ring.declare_angles([(q1, q1)])
    ring.declare_angles([(q2, q2), (q3, q2 + q3), (q4, q2 + q3 - q4 + sp.Rational(1, 3))])
    return ring


def random_expression(rng, depth=3):
    if depth == 0:
        angle = sum(rng.randint(-1, 1) * q for q in VARIABLES) + rng.choice([0, sp.pi / 2, alpha1])
        return rng.choice(
            [sp.sin(angle), sp.cos(angle), l1, sp.Rational(rng.randint(-9, 9), 7), q2]
        )
    a, b = random_expression(rng, depth - 1), random_expression(rng, depth - 1)
    return rng.choice([a + b, a - b, a * b])


def test_pythagoras_is_one(ring):
    for q in VARIABLES:
        assert ring.convert(sp.sin(q) ** 2 + sp.cos(q) ** 2) == 1


def test_zero_is_recognised_by_looking(ring):
    expr = sp.sin(q2 + q3) - sp.sin(q2) * sp.cos(q3) - sp.cos(q2) * sp.sin(q3)
    assert not ring.convert(expr)


@pytest.mark.parametrize("angle", [sp.pi / 6, sp.pi / 4, sp.pi / 3, sp.pi / 12, 5 * sp.pi / 4])
def test_special_angles_are_exact(ring, angle):
    s, c = ring.sincos(angle)
    assert s * s + c * c == 1
    assert ring.expanded(s) == sp.expand(sp.sin(angle))
    double, _ = ring.sincos(2 * angle)
    assert s * c * 2 == double


def test_roots_multiply_through_their_primes(ring):
    assert ring.convert(sp.sqrt(6)) * ring.convert(sp.sqrt(2)) == ring.convert(2 * sp.sqrt(3))


@pytest.mark.parametrize("seed", range(12))
def test_values_and_derivatives_agree_with_sympy(ring, seed):
    rng = random.Random(seed)
    expr = random_expression(rng)
    values = {q: rng.uniform(-3, 3) for q in VARIABLES} | {l1: 0.7, alpha1: 0.3}
    p = ring.convert(expr)
    assert ring.evaluate(p, values) == pytest.approx(float(expr.subs(values)), abs=1e-12)
    for q in VARIABLES:
        slope = float(sp.diff(expr, q).subs(values))
        assert ring.evaluate(ring.diff(p, q), values) == pytest.approx(slope, abs=1e-11)
        assert ring.diff(p, q) == ring.convert(sp.diff(expr, q))


@pytest.mark.parametrize("seed", range(12))
def test_equal_expressions_have_one_form(ring, seed):
    expr = random_expression(random.Random(seed))
    assert ring.convert(expr) == ring.convert(sp.expand(expr))
    assert ring.convert(expr) == ring.convert(sp.expand_trig(expr))
    assert ring.convert(ring.expanded(ring.convert(expr))) == ring.convert(expr)


def test_derivative_of_what_is_no_polynomial(ring):
    expr = sp.exp(q1) * sp.cos(q1) + sp.sqrt(1 + sp.sin(q2))
    for q in (q1, q2):
        assert ring.diff(ring.convert(expr), q) == ring.convert(sp.diff(expr, q))


def test_evaluates_over_arrays_of_states(ring):
    q = np.linspace(-2, 2, 7)
    p = ring.convert(sp.sin(q1) * sp.cos(q1) * l1 + 1)
    np.testing.assert_allclose(ring.evaluate(p, {q1: q, l1: 2.0}), 2 * np.sin(q) * np.cos(q) + 1)
    assert ring.evaluate(ring.zero, {q1: q}).shape == (7,)


def test_floats_count_as_the_decimals_they_print_as(ring):
    assert ring.convert(sp.Float(0.1)) == ring.convert(sp.Rational(1, 10))


def test_exponents_beyond_the_field_are_refused(ring):
    with pytest.raises(OverflowError, match="exponent"):
        ring.convert(l1 ** (MAX_EXPONENT + 1))
    p = ring.convert(l1**100)
    with pytest.raises(OverflowError, match="exponent of l_1"):
        p * p


def test_what_is_not_a_real_number_is_refused(ring):
    with pytest.raises(ValueError, match="not a finite real number"):
        ring.convert(sp.nan)
