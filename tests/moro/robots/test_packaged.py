"""Packaged robots that are no plain arms, against Pinocchio's numbers for the same parameters."""

import json
from pathlib import Path

import numpy as np
import pytest

import moro as mr
import moro_codegen as mc

REFERENCE = Path(__file__).parents[2] / "reference"


@pytest.mark.parametrize("name", ["cobra600", "palletizer"])
def test_against_reference_numbers(name, tmp_path):
    robot = mr.load(name)
    functions = ("tau", "inertia_matrix", "gravity_vector", "forward_kinematics")
    kernel = mc.compile(robot, functions, directory=tmp_path, backend="numpy")
    states = json.loads((REFERENCE / f"{name}.json").read_text())["states"]
    names = ("q", "qd", "qdd", "tau", "M", "G", "T")
    q, qd, qdd, tau, M, G, T = (np.array([state[x] for state in states]) for x in names)
    assert q.shape[1] == robot.dof
    close = {"rtol": 1e-12, "atol": 1e-13}
    assert np.allclose(kernel.tau(q, qd, qdd), tau, **close)
    assert np.allclose(kernel.inertia_matrix(q), M, **close)
    assert np.allclose(kernel.gravity_vector(q), G, **close)
    found = kernel.forward_kinematics(q)
    assert np.allclose(found, T[:, : found.shape[1]], **close)


def test_a_palletizer_keeps_its_flange_level():
    assert list(mr.load("palletizer").T[:3, 2]) == [0, 0, 1]
