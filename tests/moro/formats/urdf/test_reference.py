"""URDFs against Pinocchio's numbers (benchmarks/urdf_reference.py): one with everything in it, and
those that packaged robots come from."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import moro as mr
import moro_codegen as mc
from moro.algorithms.coordinates import displacements
from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.posture import posture, with_frame
from moro.closed_form import ClosedForm
from moro.scalars.trig import TrigRing

FOLDER = Path(__file__).parents[3] / "reference" / "urdf"
STACKER = FOLDER / "stacker.urdf"
PACKAGED = ("solo12", "xarm7")


@pytest.fixture(scope="module", params=["stacker", *PACKAGED])
def path(request):
    return FOLDER / f"{request.param}.urdf"


@pytest.fixture(scope="module")
def numbers(path):
    return json.loads(path.with_suffix(".json").read_text())


@pytest.fixture(scope="module")
def robot(path):
    return mr.load(path, as_written=True)


def close(found, expected):
    expected = np.array(expected)
    return np.allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_dynamics(robot, numbers, tmp_path):
    functions = ("tau", "bias", "inertia_matrix", "forward_dynamics")
    kernel = mc.compile(robot, functions=functions, backend="numpy", directory=tmp_path)
    assert robot.joint_names == numbers["joints"]
    for state in numbers["states"]:
        q, qd, qdd = (np.array(state[key]) for key in ("q", "qd", "qdd"))
        assert close(kernel.tau(q, qd, qdd), state["tau"])
        assert close(kernel.bias(q, qd), state["bias"])
        assert close(kernel.inertia_matrix(q), state["M"])
        assert close(kernel.forward_dynamics(q, qd, state["tau"]), qdd)


def test_frames(robot, numbers):
    model = robot.model().map(float)
    for state in numbers["states"]:
        sincos = [(np.sin(x), np.cos(x)) for x in displacements(model, state["q"])]
        arm = posture(model, state["q"], sincos)
        for frame in model.frames:
            there = with_frame(arm, frame.link, frame.placement)
            pose = poses(there)[-1]
            assert close(np.column_stack([pose.R, pose.p]), state["T"][frame.name][:3])
            assert close(frame_jacobian(there), state["J"][frame.name])


def test_what_the_decimals_mean_is_near(tmp_path):
    numbers = json.loads(STACKER.with_suffix(".json").read_text())
    meant = mc.compile(mr.load(STACKER), backend="numpy", directory=tmp_path)
    for state in numbers["states"]:
        q, qd, qdd = (np.array(state[key]) for key in ("q", "qd", "qdd"))
        assert np.allclose(meant.tau(q, qd, qdd), state["tau"], rtol=1e-4, atol=1e-3)
        assert not close(meant.tau(q, qd, qdd), state["tau"])


@pytest.mark.parametrize("name", PACKAGED)
def test_packaged_robots_are_those_of_the_urdfs(name):
    """But for limits, where the file says 2 pi for 6.2831853072."""
    found, of_urdf = mr.load(name).model(), mr.load(FOLDER / f"{name}.urdf").model()
    limits = [np.array(model.ranges, dtype=float) for model in (found, of_urdf)]
    assert np.allclose(*limits, rtol=1e-12)
    found, of_urdf = (
        replace(
            model,
            name="",
            coordinates=tuple(replace(x, limits=None) for x in model.coordinates),
        )
        for model in (found, of_urdf)
    )
    assert found == of_urdf


def test_both_symbolic_routes_agree_exactly():
    """Energies and Jacobians, whatever decimals the file has: its rotations are orthogonal."""
    form = ClosedForm(mr.load(FOLDER / "stacker.urdf", as_written=True).model(), TrigRing())
    qd, qdd = sp.symbols(f"v1:{form.n + 1}"), sp.symbols(f"a1:{form.n + 1}")
    v, a = ([form.ring.convert(x) for x in symbols] for symbols in (qd, qdd))
    M, C = form.inertia_matrix, form.coriolis_matrix(v)
    for i, torque in enumerate(form.euler_lagrange(qd, qdd)):
        terms = (M[i][j] * a[j] + C[i][j] * v[j] for j in range(form.n))
        assert torque == sum(terms, form.gravity_vector[i])
