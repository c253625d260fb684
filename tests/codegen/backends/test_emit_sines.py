"""Sines and cosines in vector registers, against mpmath: any number of angles, single and batch."""

import mpmath
import numpy as np
import pytest
from programs import program, sines, vector

from moro_codegen.functions.function import Function
from moro_codegen.pipeline import build

COUNTS = range(1, 10)
LIMIT = 1e5


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    return build(program(*map(sines, COUNTS), dof=9), tmp_path_factory.mktemp("sines") / "sines")


def angles():
    """Random angles of every size, and those as close to multiples of pi/4 as doubles come."""
    rng = np.random.default_rng(1)
    with mpmath.workprec(200):
        quarter = mpmath.pi / 4
        multiples = [*range(1, 400), *rng.integers(400, 127_000, 600).tolist()]
        # 29 pi / 2 and its doubles are the closest that any double up to 1e5 comes to one
        multiples += [58 << k for k in range(11)]
        hard = np.array([float(k * quarter) for k in multiples])
    hard = np.concatenate([hard, np.nextafter(hard, 0), np.nextafter(hard, np.inf)])
    return np.concatenate(
        [
            rng.uniform(-4, 4, 3000),
            rng.uniform(-LIMIT, LIMIT, 3000),
            10 ** rng.uniform(-310, 5, 600) * rng.choice([-1, 1], 600),
            hard,
            -hard[::7],
            [0.0, -0.0, 5e-324, LIMIT, -LIMIT],
        ]
    )


def units(found, function, x):
    """Largest error in units in the last place of the true value."""
    with mpmath.workprec(200):
        exact = [function(mpmath.mpf(float(a))) for a in x]
        return max(
            float(abs(mpmath.mpf(float(y)) - e) / mpmath.mpf(float(np.spacing(abs(float(e))))))
            for y, e in zip(found, exact, strict=True)
        )


def test_within_two_units_in_the_last_place(kernel):
    x = angles()
    sine, cosine = kernel.sines_1(x[:, None])
    assert units(sine[:, 0], mpmath.sin, x) < 1.6
    assert units(cosine[:, 0], mpmath.cos, x) < 1.6


@pytest.mark.parametrize("n", COUNTS)
def test_any_number_of_angles_gives_the_same_bits(kernel, n):
    """Packed 4 and 2 at a time, side by side, or one by one."""
    x = angles()
    x = x[: len(x) // n * n].reshape(-1, n)
    one_by_one = kernel.sines_1(x.reshape(-1, 1))
    function = getattr(kernel, f"sines_{n}")
    batch = function(x)
    single = [np.array(rows) for rows in zip(*map(function, x[:200]), strict=True)]
    for k in range(2):
        assert np.array_equal(batch[k].ravel(), one_by_one[k].ravel())
        assert np.array_equal(single[k], batch[k][:200])


@pytest.mark.parametrize("n", COUNTS)
def test_huge_angles_are_left_to_libm(kernel, n):
    """In every lane: the neighbours' results do not change."""
    function = getattr(kernel, f"sines_{n}")
    rng = np.random.default_rng(2)
    x = rng.uniform(-3, 3, (40, n))
    x[rng.random((40, n)) < 0.2] *= 1e12
    batch = function(x)
    single = [np.array(rows) for rows in zip(*map(function, x), strict=True)]
    for y, z, f in zip(batch, single, (np.sin, np.cos), strict=True):
        assert np.array_equal(y, z)
        assert np.abs(y - f(x)).max() < 3e-16


def test_not_a_number_and_infinity(kernel):
    x = np.array([np.nan, np.inf, -np.inf, 1.0, 1e300, -np.nan, 0.5])
    for sine, cosine in (kernel.sines_7(x), kernel.sines_7(np.stack([x] * 11))):
        for y in (sine, cosine):
            assert np.array_equal(np.isnan(y), np.broadcast_to(~np.isfinite(x), y.shape))
    assert np.array_equal(kernel.sines_7(x)[0][3], kernel.sines_1(x[3:4])[0][0])


def test_signed_zeros_and_symmetry(kernel):
    x = angles()[:, None]
    sine, cosine = kernel.sines_1(x)
    mirrored = kernel.sines_1(-x)
    assert np.array_equal(np.signbit(kernel.sines_2(np.array([0.0, -0.0]))[0]), [False, True])
    assert np.array_equal(mirrored[0], -sine)
    assert np.array_equal(mirrored[1], cosine)


def of_a_sum(system, q):
    """A sum of angles, one of its parts in something else, and sines of both."""
    graph, pair = system.graph, q[0] + q[1]
    return [[pair, graph.sin(pair - q[2]), graph.cos(pair), 3 * pair]]


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_sum_of_large_angles_that_is_more_than_an_angle(tmp_path, backend):
    """Its sine is that of the sum as it is, before rounding; what is made of it is not turned."""
    function = Function("f", (vector("q", 3),), (vector("y", 4),), "Of a sum.", of_a_sum)
    kernel = build(program(function), tmp_path / "kernel", backend)
    rng = np.random.default_rng(4)
    q = rng.uniform(-1, 1, (60, 3)) * 10.0 ** rng.integers(0, 9, (60, 3))
    total, sine, cosine, multiple = (kernel.f(q)[..., k] for k in range(4))
    assert np.array_equal(total, q[:, 0] + q[:, 1])
    assert np.allclose(multiple, 3 * total, rtol=1e-15, atol=0)
    with mpmath.workprec(200):
        for k, (a, b, c) in enumerate([[mpmath.mpf(x) for x in row] for row in q.tolist()]):
            assert abs(mpmath.sin(a + b - c) - sine[k]) < 1e-12
            assert abs(mpmath.cos(a + b) - cosine[k]) < 1e-12
