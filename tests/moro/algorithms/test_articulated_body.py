"""Forward dynamics undoes inverse dynamics, exactly."""

from dataclasses import replace

import numpy as np
import pytest
from arms import NAMES
from dynamics import exact_case, reference_case
from exact import body
from recursion import forward_dynamics, without_rotors
from recursion import rotors as rotors_of

from moro.model import Coordinate


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    undone(exact_case(seed, massive=True))


@pytest.mark.parametrize("seed", [2, 3, 4, 6, 33, 39])  # bodies enough
def test_without_rotors(seed):
    case = exact_case(seed)
    undone(replace(case, model=without_rotors(case.model)))


def undone(case):
    tau = case.torques(case.qd, case.qdd)
    assert forward_dynamics(case.model, case.q, case.qd, tau, case.sincos) == case.qdd


def test_joint_that_moves_nothing():
    case = exact_case(0, massive=True)
    model = replace(
        case.model,
        coordinates=(*case.model.coordinates[:-1], Coordinate()),
        bodies=(*case.model.bodies[:-1], body([])),
    )
    with pytest.raises(ZeroDivisionError):
        forward_dynamics(model, case.q, case.qd, case.qdd, case.sincos)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "ur5"])
def test_reference(name):
    """The torques of Pinocchio give back the accelerations, to what their rounding comes to.

    Not so for the UR5: its last link, a point on the axis, has no inertia.
    """
    model, pairs, state = reference_case(name)
    q, qd, qdd = (state[key].T for key in ("q", "qd", "qdd"))
    rotors = np.array(rotors_of(model))
    tau = state["tau_rigid"].T + rotors[:, None] * qdd
    found = forward_dynamics(model, q, qd, list(tau), pairs)
    rounding = 1e-14 * np.abs(tau).max(axis=0)
    least = np.linalg.eigvalsh(state["M_rigid"] + np.diag(rotors)).min(axis=-1)
    assert (np.linalg.norm(found - qdd, axis=0) <= rounding / least).all()
