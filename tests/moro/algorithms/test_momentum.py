"""Momentum: exactly M qd; and what changes it: exactly C^T qd, the gradient of the energy."""

import pytest
from dynamics import exact_case
from exact import moving_points

from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.momentum import joint_momentum, transposed_coriolis_product
from moro.algorithms.posture import posture


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    case = exact_case(seed)
    arm = posture(case.model, case.q, case.sincos)
    M = case.M
    p = [sum(m * v for m, v in zip(row, case.qd, strict=True)) for row in M]
    assert joint_momentum(arm, case.rotors, case.qd) == p
    C = joint_coriolis(arm, case.qd)
    rows = zip(*C, strict=True)
    product = [sum(c * v for c, v in zip(row, case.qd, strict=True)) for row in rows]
    assert transposed_coriolis_product(arm, case.qd) == product


@pytest.mark.parametrize("seed", range(4))
def test_momenta_of_points(seed):
    """p_i is the sum of m dr/dt . r'_i over the points of the bodies, and the rotor's."""
    case = exact_case(seed)
    arm, still = posture(case.model, case.q, case.sincos), [0] * case.n
    moving = moving_points(case.model, case.points, case.sincos, case.q, case.qd, still)
    for i, p in enumerate(joint_momentum(arm, case.rotors, case.qd)):
        unit = [int(k == i) for k in range(case.n)]
        varied = moving_points(case.model, case.points, case.sincos, case.q, unit, still)
        assert p == case.rotors[i] * case.qd[i] + sum(
            m * x.c[1] * dx.c[1]
            for (m, r), (_, dr) in zip(moving, varied, strict=True)
            for x, dx in zip(r, dr, strict=True)
        )
