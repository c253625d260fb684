"""The regressor: exactly the torques per unit of each parameter."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from arms import NAMES, numeric, reference_model, sincos
from dynamics import assert_close, exact_case, reference_case
from exact import rational
from recursion import inverse_dynamics, parameters, regressor

from moro.algorithms.body_regressor import PARAMETERS, reference_regressor
from moro.algorithms.posture import posture
from moro.algorithms.reference_motion import reference_torques
from moro.model import Body


def unit_body(k):
    """A body with one parameter 1 and all others 0."""
    xx, xy, xz, yy, yz, zz, x, y, z, m = (Fraction(i == k) for i in range(10))
    return Body(m, (x, y, z), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


@pytest.mark.parametrize("seed", range(8))
def test_exact(seed):
    case = exact_case(seed)
    state = case.q, case.qd, case.qdd, case.sincos
    Y = regressor(case.model, *state)
    nothing = unit_body(-1)
    for column in range(10 * case.n):
        i, k = divmod(column, len(PARAMETERS))
        bodies = tuple(unit_body(k) if j == i else nothing for j in range(case.n))
        expected = inverse_dynamics(replace(case.model, bodies=bodies), *state)
        assert [row[column] for row in Y] == list(expected)


def test_parameters():
    case = exact_case(3)
    state = case.q, case.qd, case.qdd, case.sincos
    p = parameters(case.model)
    tau = [sum(y * x for y, x in zip(r, p, strict=True)) for r in regressor(case.model, *state)]
    assert tau == list(inverse_dynamics(case.model, *state))
    names = [body.mass for body in case.model.bodies]
    assert [p[10 * i + PARAMETERS.index("M")] for i in range(case.n)] == names


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model, pairs, state = reference_case(name)
    q, qd, qdd = (state[key].T for key in ("q", "qd", "qdd"))
    Y, p = regressor(model, q, qd, qdd, pairs), parameters(model)
    tau = [sum(y * x for y, x in zip(row, p, strict=True)) for row in Y]
    assert_close(tau, state["tau_rigid"].T)


def test_rank_is_that_of_the_base_parameters():
    """PUMA-like wrist and shoulder: many states, rank 36 of 60 (Khalil & Dombre, ch. 9)."""
    model = numeric(reference_model("puma560"))
    q, qd, qdd = np.random.default_rng(0).uniform(-3, 3, (3, 6, 40))
    Y = regressor(model, q, qd, qdd, sincos(model, q))
    stacked = np.array([[np.broadcast_to(y, 40) for y in row] for row in Y])
    stacked = stacked.transpose(2, 0, 1).reshape(-1, 60)
    assert np.linalg.matrix_rank(stacked, tol=1e-8) == 36


@pytest.mark.parametrize("seed", range(8))
def test_reference_velocities(seed):
    """Exactly the torques for a reference velocity other than the velocity."""
    case, rng = exact_case(seed), np.random.default_rng(seed)
    arm = posture(case.model, case.q, case.sincos)
    qd_r, qdd_r = ([rational(rng) for _ in range(case.n)] for _ in range(2))
    p = parameters(case.model)
    found = [
        sum(y * x for y, x in zip(row, p, strict=True))
        for row in reference_regressor(arm, case.qd, qd_r, qdd_r)
    ]
    assert found == list(reference_torques(arm, case.qd, qd_r, qdd_r))
