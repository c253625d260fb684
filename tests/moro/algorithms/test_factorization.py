"""L^T D L is M, exactly and without fill-in; solutions solve."""

import numpy as np
import pytest
from dynamics import exact_case
from exact import rational
from recursion import forward_dynamics

from moro.algorithms.factorization import factorized, inverse, inverse_of_symmetric, solution
from moro.algorithms.posture import posture


def arm(case):
    return posture(case.model, case.q, case.sincos)


@pytest.mark.parametrize("seed", range(1, 12, 2))
def test_exact(seed):
    case = exact_case(seed, massive=True)
    M, n = case.M, case.n
    factors = factorized(M, arm(case))
    L = [[factors.L[i][j] if j < i else int(i == j) for j in range(n)] for i in range(n)]
    D = [1 / x for x in factors.reciprocals]
    product = [
        [sum(L[k][i] * D[k] * L[k][j] for k in range(n)) for j in range(n)] for i in range(n)
    ]
    assert product == M
    assert all(L[j][i] == 0 for j in range(n) for i in range(j) if i not in factors.inner[j])
    b = [rational(np.random.default_rng(seed)) for _ in range(n)]
    x = solution(factors, b)
    assert [sum(m * y for m, y in zip(row, x, strict=True)) for row in M] == b


@pytest.mark.parametrize("seed", range(4))
def test_accelerations(seed):
    """The same accelerations as by articulated bodies."""
    case = exact_case(seed, massive=True)
    tau = [rational(np.random.default_rng(seed)) for _ in range(case.n)]
    bias = case.torques(case.qd, [0] * case.n)
    left = [x - y for x, y in zip(tau, bias, strict=True)]
    expected = forward_dynamics(case.model, case.q, case.qd, tau, case.sincos)
    assert solution(factorized(case.M, arm(case)), left) == expected


@pytest.mark.parametrize("seed", range(1, 8))
def test_inverses(seed):
    case = exact_case(seed, massive=True)
    M, unit = case.M, np.eye(case.n, dtype=int).tolist()
    for found in (inverse(factorized(M, arm(case))), inverse_of_symmetric(M)):
        assert (np.array(found, object) @ np.array(M, object)).tolist() == unit
