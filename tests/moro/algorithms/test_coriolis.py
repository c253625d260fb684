"""The Coriolis matrix: exactly that of the Christoffel symbols."""

import random
from fractions import Fraction

import numpy as np
import pytest
from arms import NAMES, numeric, sincos
from dynamics import arrays, assert_close, by_formulas, exact_case, numbers, reference_case
from recursion import coriolis_matrix, inertia_matrix
from robots import random_robot


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    """Christoffel's is the only C with C(u) v = C(v) u that gives C(u) u: it follows from that."""
    case = exact_case(seed)
    C = coriolis_matrix(case.model, case.q, case.qd, case.sincos)
    expected = [mixed(case, case.qd, unit(case.n, j)) for j in range(case.n)]
    assert columns(C) == expected


def mixed(case, u, v):
    """Return C(u) v = (C(u + v) (u + v) - C(u) u - C(v) v) / 2, from Newton-Euler."""

    def quadratic(qd):
        return case.torques(qd, [0] * case.n, gravity=False)

    parts = zip(
        quadratic([x + y for x, y in zip(u, v, strict=True)]),
        quadratic(u),
        quadratic(v),
        strict=True,
    )
    return [Fraction(both - a - b) / 2 for both, a, b in parts]


def unit(n, j):
    return [int(i == j) for i in range(n)]


def columns(C):
    return [list(row) for row in zip(*C, strict=True)]


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("n", [1, 4, 7])
def test_christoffel_symbols(n, convention):
    robot = random_robot(random.Random(n), n, convention)
    q, qd = np.random.default_rng(n).uniform(-3, 3, (2, n, 5))
    model = numeric(robot.model())
    form, ring = by_formulas(robot, q)
    expected = numbers(form.coriolis_matrix([ring.constant(v) for v in qd]))
    assert_close(coriolis_matrix(model, q, qd, sincos(model, q)), expected, 1e-11)


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    """C qd is what Pinocchio has, and dM/dt - 2 C is skew, dM/dt by a complex step."""
    model, pairs, state = reference_case(name)
    q, qd = state["q"].T, state["qd"].T
    C = arrays(coriolis_matrix(model, q, qd, pairs), q.shape[1])
    assert_close(list(np.einsum("ijs,js->is", C, qd)), state["Cqd"].T)
    step = q + 1e-30j * qd
    M = inertia_matrix(model, step, sincos(model, step))
    rate = arrays([[np.imag(x) / 1e-30 for x in row] for row in M], q.shape[1])
    skew = rate - 2 * C
    assert np.abs(skew + skew.transpose(1, 0, 2)).max() <= 1e-13 * np.abs(C).max()
