"""Torques against an external wrench: exactly the virtual work."""

import numpy as np
import pytest
from dynamics import exact_case
from exact import moving_points, rational
from recursion import forward_kinematics, inverse_dynamics_in_contact, jacobian


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    case = exact_case(seed)
    w = [rational(np.random.default_rng(seed)) for _ in range(6)]
    state = case.model, case.q, case.qd, case.qdd
    J = jacobian(case.model, case.q, case.sincos)
    taken = [sum(row[j] * x for row, x in zip(J, w, strict=True)) for j in range(case.n)]
    rigid = inverse_dynamics_in_contact(*state, [0] * 6, case.sincos)
    assert [x + r * a for x, r, a in zip(rigid, case.rotors, case.qdd, strict=True)] == (
        case.torques(case.qd, case.qdd)
    )
    tau = inverse_dynamics_in_contact(*state, w, case.sincos)
    assert [x - y for x, y in zip(rigid, tau, strict=True)] == taken


@pytest.mark.parametrize("seed", range(4))
def test_force_on_a_point(seed):
    """A force f on a point of the last link is f and r x f about the origin of frame n."""
    case = exact_case(seed)
    rng = np.random.default_rng(seed)
    f, place = ([rational(rng) for _ in range(3)] for _ in range(2))
    points = [[] for _ in range(case.n - 1)] + [[(1, tuple(place))]]

    def velocity(qd):
        ((_, r),) = moving_points(case.model, points, case.sincos, case.q, qd, [0] * case.n)
        return [x.c[0] for x in r], [x.c[1] for x in r]

    r, _ = velocity([0] * case.n)
    origin = forward_kinematics(case.model, case.q, case.sincos).p
    moment = np.cross([x - y for x, y in zip(r, origin, strict=True)], f)
    state = case.model, case.q, case.qd, case.qdd
    free = inverse_dynamics_in_contact(*state, [0] * 6, case.sincos)
    tau = inverse_dynamics_in_contact(*state, [*f, *moment], case.sincos)
    for j in range(case.n):
        _, v = velocity([int(i == j) for i in range(case.n)])
        assert free[j] - tau[j] == sum(x * y for x, y in zip(f, v, strict=True))
