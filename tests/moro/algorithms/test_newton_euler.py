"""Recursive Newton-Euler against numbers from outside, and exactly against point masses."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from arms import (
    NAMES,
    numeric,
    random_model,
    random_state,
    reference_model,
    reference_states,
    sincos,
)
from exact import exact_arm, exact_state, point_torques, rational
from recursion import inverse_dynamics

from moro.algorithms.drives import Functions, drive_torques
from moro.model import Body, Coordinate, Drive


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model = numeric(reference_model(name))
    for state in reference_states(name):
        q, qd, qdd = (np.array(state[key]) for key in ("q", "qd", "qdd"))
        rigid = np.array(inverse_dynamics(model, q, qd, qdd, sincos(model, q)))
        full = rigid + drive_torques(model, qd, qdd, Functions(np.sign, np.tanh, np.exp))
        for tau, key in ((rigid, "tau_rigid"), (full, "tau")):
            expected = np.array(state[key])
            assert np.abs(tau - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("tree", [False, True])
@pytest.mark.parametrize("seed", range(10))
def test_point_masses(seed, tree):
    """Exact equality with d'Alembert's principle for points, for every joint type and placement."""
    rng = np.random.default_rng(seed)
    model, points = exact_arm(rng, int(rng.integers(1, 6)), tree)
    pairs, q, qd, qdd = exact_state(rng, model.dof)
    tau = inverse_dynamics(model, q, qd, qdd, pairs)
    assert list(tau) == point_torques(model, points, pairs, q, qd, qdd)
    assert any(tau)


@pytest.mark.parametrize("seed", range(5))
def test_mass_matrix(seed):
    """M, column by column from unit accelerations, is symmetric, and positive where mass moves."""
    rng = np.random.default_rng(seed)
    model, _ = exact_arm(rng, 5, tree=True)
    model = replace(model, gravity=(0, 0, 0))
    pairs, q, _, _ = exact_state(rng, 5)
    eye = np.eye(5, dtype=int).tolist()
    M = [inverse_dynamics(model, q, [0] * 5, unit, pairs) for unit in eye]
    assert all(M[i][j] == M[j][i] for i in range(5) for j in range(5))
    assert np.linalg.eigvalsh(np.array(M, float)).min() > -1e-9


def test_linear_in_the_bodies():
    rng = np.random.default_rng(3)
    model, _ = exact_arm(rng, 5, tree=True)
    other, _ = exact_arm(rng, 5)
    pairs, q, qd, qdd = exact_state(rng, 5)
    a, b = rational(rng), rational(rng)

    def tau(bodies):
        return inverse_dynamics(replace(model, bodies=bodies), q, qd, qdd, pairs)

    mixed = tuple(combined(a, x, b, y) for x, y in zip(model.bodies, other.bodies, strict=True))
    separate = zip(tau(model.bodies), tau(other.bodies), strict=True)
    assert list(tau(mixed)) == [a * x + b * y for x, y in separate]


def combined(a, x, b, y):
    return Body(
        a * x.mass + b * y.mass,
        tuple(a * u + b * v for u, v in zip(x.first_moment, y.first_moment, strict=True)),
        tuple(
            tuple(a * u + b * v for u, v in zip(r, s, strict=True))
            for r, s in zip(x.inertia, y.inertia, strict=True)
        ),
    )


def test_arrays_of_samples():
    rng = np.random.default_rng(0)
    model = numeric(random_model(rng, 6, tree=True))
    states = rng.uniform(-2, 2, (3, 6, 4, 3))
    q, qd, qdd = states
    tau = inverse_dynamics(model, q, qd, qdd, sincos(model, q))
    for sample in np.ndindex(4, 3):
        x, v, a = (part[(slice(None), *sample)] for part in states)
        single = inverse_dynamics(model, x, v, a, sincos(model, x))
        np.testing.assert_allclose([t[sample] for t in tau], single, rtol=1e-13, atol=1e-13)


def test_wrong_number_of_positions():
    model = numeric(random_model(np.random.default_rng(1), 3))
    q, qd, qdd = random_state(np.random.default_rng(1), 3)
    with pytest.raises(ValueError, match="2 values for 3 coordinates"):
        inverse_dynamics(model, q[:2], qd, qdd, sincos(model, q))


def test_drives():
    """Rotor inertia, viscous friction, and Coulomb's, different in the two directions."""
    model, _ = exact_arm(np.random.default_rng(2), 1)
    drive = Drive(2, 3, (Fraction(5), Fraction(7)))
    model = replace(model, coordinates=(Coordinate(drive=drive),))
    functions = Functions(lambda x: (x > 0) - (x < 0), math.tanh, math.exp)

    def torque(qd):
        (tau,) = drive_torques(model, [qd], [Fraction(1, 2)], functions)
        return tau - 1

    assert torque(4) == 12 + 5
    assert torque(-4) == -12 - 7
    assert torque(0) == 0
