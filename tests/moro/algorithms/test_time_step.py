"""Steps with dry friction: the minimum that they are, and rest that is exact."""

import numpy as np
import pytest

from moro.algorithms.time_step import SWEEPS, velocities_after


def convex(M, b, bounds):
    """The v that minimizes 1/2 v M v - b v + sum of max(upper v, lower v), by all active sets."""
    n, best, least = len(b), None, np.inf
    for signs in np.ndindex(*[3] * n):
        slide = np.array(signs) - 1
        p = np.array([(0, hi, lo)[s] for s, (lo, hi) in zip(slide, bounds, strict=True)])
        v, moves = np.zeros(n), slide != 0
        v[moves] = np.linalg.solve(M[np.ix_(moves, moves)], (b - p)[moves])
        dissipated = [max(hi * x, lo * x) for x, (lo, hi) in zip(v, bounds, strict=True)]
        value = v @ M @ v / 2 - b @ v + sum(dissipated)
        if value < least:
            best, least = v, value
    return best


def random_case(rng, n):
    A = rng.normal(size=(n, n))
    M = A @ A.T + np.eye(n)
    bounds = [(-lo, hi) for lo, hi in rng.uniform(0.1, 1, (n, 2))]
    return M, rng.normal(size=n) * 1.5, bounds


def after(M, b, bounds):
    v = velocities_after(np.linalg.inv(M).tolist(), list(b), bounds, np.clip)
    return np.array(v, dtype=float)


@pytest.mark.parametrize("seed", range(30))
def test_against_all_active_sets(seed):
    rng = np.random.default_rng(seed)
    M, b, bounds = random_case(rng, 3)
    exact = convex(M, b, bounds)
    free = np.linalg.solve(M, b)
    np.testing.assert_allclose(after(M, b, bounds), exact, atol=0.02 * np.abs(free).max())
    M = np.diag(np.diag(M))  # without coupling, the first sweep is the solution
    np.testing.assert_allclose(after(M, b, bounds), convex(M, b, bounds), atol=1e-15)


def test_more_sweeps_come_nearer(monkeypatch):
    monkeypatch.setattr("moro.algorithms.time_step.SWEEPS", 40 * SWEEPS)
    for seed in range(10):
        M, b, bounds = random_case(np.random.default_rng(seed), 3)
        np.testing.assert_allclose(after(M, b, bounds), convex(M, b, bounds), atol=1e-9)


def test_rest_is_exact():
    rng = np.random.default_rng(0)
    for _ in range(20):
        M, b, _ = random_case(rng, 5)
        bounds = [(-abs(x) - 1e-3, abs(x)) for x in b]
        assert (after(M, b, bounds) == 0).all()
        bounds[2] = (-abs(b[2]) / 2, abs(b[2]) / 2)
        assert (after(M, b, bounds) != 0).any()


def test_without_dry_friction():
    M, b, _ = random_case(np.random.default_rng(1), 4)
    np.testing.assert_allclose(after(M, b, [None] * 4), np.linalg.solve(M, b), rtol=1e-12)
