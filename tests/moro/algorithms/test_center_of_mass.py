"""The centre of mass and its velocity: exactly those of the points that make up the bodies."""

import pytest
from dynamics import exact_case
from exact import moving_points

from moro.algorithms.center_of_mass import center_of_mass, center_of_mass_jacobian
from moro.algorithms.posture import posture


@pytest.mark.parametrize("seed", [s for s in range(14) if any(exact_case(s).points)])
def test_exact(seed):
    case = exact_case(seed)
    arm, still = posture(case.model, case.q, case.sincos), [0] * case.n
    points = moving_points(case.model, case.points, case.sincos, case.q, case.qd, still)
    mass = sum(m for m, _ in points)
    J = center_of_mass_jacobian(arm)
    for k, (place, row) in enumerate(zip(center_of_mass(arm), J, strict=True)):
        assert place * mass == sum(m * r[k].c[0] for m, r in points)
        velocity = sum(x * rate for x, rate in zip(row, case.qd, strict=True))
        assert velocity * mass == sum(m * r[k].c[1] for m, r in points)
