"""Torques for a reference velocity: exactly M qdd_r + C qd_r + G, with the Christoffel C."""

import numpy as np
import pytest
from dynamics import exact_case
from exact import rational
from recursion import inverse_dynamics

from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.posture import posture
from moro.algorithms.reference_motion import coriolis_product, reference_torques


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    """M and G by Newton-Euler, C by composite bodies, which test_coriolis compares exactly."""
    case, rng = exact_case(seed), np.random.default_rng(seed)
    arm = posture(case.model, case.q, case.sincos)
    qd_r, qdd_r = ([rational(rng) for _ in range(case.n)] for _ in range(2))
    still = [0] * case.n
    accelerating = inverse_dynamics(case.model, case.q, still, qdd_r, case.sincos)
    C = joint_coriolis(arm, case.qd)
    product = [sum(c * v for c, v in zip(row, qd_r, strict=True)) for row in C]
    assert list(coriolis_product(arm, case.qd, qd_r)) == product
    expected = [x + y for x, y in zip(accelerating, product, strict=True)]
    assert list(reference_torques(arm, case.qd, qd_r, qdd_r)) == expected


@pytest.mark.parametrize("seed", range(6))
def test_the_velocity_as_reference(seed):
    case = exact_case(seed)
    found = reference_torques(posture(case.model, case.q, case.sincos), case.qd, case.qd, case.qdd)
    assert found == inverse_dynamics(case.model, case.q, case.qd, case.qdd, case.sincos)
