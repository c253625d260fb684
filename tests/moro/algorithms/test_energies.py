"""Energies: exactly those of the points, and their rate is the power of the torques."""

from fractions import Fraction

import numpy as np
import pytest
from arms import NAMES, numeric, random_model, sincos
from dynamics import assert_close, exact_case, reference_case
from exact import moving_points
from recursion import inverse_dynamics, kinetic_energy, potential_energy, rotors, without_rotors


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    case = exact_case(seed)
    moving = moving_points(case.model, case.points, case.sincos, case.q, case.qd, case.qdd)
    K = sum(m * x.c[1] ** 2 for m, r in moving for x in r)
    K += sum(rotor * rate**2 for rotor, rate in zip(case.rotors, case.qd, strict=True))
    P = -sum(m * g * x.c[0] for m, r in moving for g, x in zip(case.model.gravity, r, strict=True))
    assert kinetic_energy(case.model, case.q, case.qd, case.sincos) == Fraction(K) / 2
    assert potential_energy(case.model, case.q, case.sincos) == P


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model, pairs, state = reference_case(name)
    q, qd = state["q"].T, state["qd"].T
    assert_close(
        [kinetic_energy(without_rotors(model), q, qd, pairs)], state["kinetic_energy_rigid"][None]
    )
    assert_close([potential_energy(model, q, pairs)], state["potential_energy"][None])


@pytest.mark.parametrize("seed", range(6))
def test_power(seed):
    """d(K + P)/dt = qd . tau, by a complex step along the motion."""
    rng = np.random.default_rng(seed)
    model = numeric(random_model(rng, 6, tree=bool(seed % 2)))
    q, qd, qdd = rng.uniform(-3, 3, (3, 6))
    tau = inverse_dynamics(model, q, qd, qdd, sincos(model, q)) + np.array(rotors(model)) * qdd
    x, v = q + 1e-30j * qd, qd + 1e-30j * qdd
    pairs = sincos(model, x)
    E = kinetic_energy(model, x, v, pairs) + potential_energy(model, x, pairs)
    scale = np.abs(qd * tau).sum()
    assert abs(np.imag(E) / 1e-30 - qd @ tau) <= 1e-13 * scale
