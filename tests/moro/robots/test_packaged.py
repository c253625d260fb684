"""Packaged robots that are no plain arms, against Pinocchio's numbers for the same parameters."""

import json
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

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


@pytest.mark.parametrize("values", [(0, 1.5, 1), sp.symbols("m h J")])
def test_identified_parameters_of_which_a_mass_is_zero(values, tmp_path):
    """m = 0 and m r != 0, in numbers and at run time: no division comes of it."""
    m, h, J = values
    body = {"mass": m, "first_moment": [h, 0, 0.1], "inertia": {"xx": J, "yy": 2, "zz": 2}}
    link = {"joint": "revolute", "xyz": [0.5, 0, 0], "axis": "y", "inertia_about": "origin"} | body
    given = {"parameters": {"m": 0, "h": 1.5, "J": 1}} if m else {}
    robot = mr.Robot.of({"name": "identified", "links": [link, link], **given})
    functions = ("tau", "inertia_matrix", "gravity_vector", "regressor")
    kernel = mc.compile(robot, functions, directory=tmp_path, backend="numpy")
    assert {name: ops["div"] for name, ops in kernel.ops.items()} == dict.fromkeys(functions, 0)
    assert mc.verify(kernel, robot).passed
    assert kernel.gravity_vector([0, 0]).tolist() == pytest.approx([-9.81 * 3, -9.81 * 1.5])
