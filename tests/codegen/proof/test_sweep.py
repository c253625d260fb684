"""Every function, through every backend, of every packaged arm and of random ones up to 12 joints.

Long tests: `make sweep` runs them, `make test` leaves them out.
"""

import random
import subprocess
import sys

import numpy as np
import pytest
from arms import NAMES
from functions import KINDS
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro_codegen.proof.verification import INVERTING, SymbolicRoute

pytestmark = pytest.mark.sweep

#: no inertia resists joint 6 of the UR5 as it is published
NO_FORWARD_DYNAMICS = {"ur5"}


def functions_of(robot):
    singular = robot.name in NO_FORWARD_DYNAMICS
    return tuple(name for name in KINDS if not (singular and name in INVERTING))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("sweep")


# by NumPy in test_verify; building the Cython package of a longer arm takes as long as all the rest
BUILDS = [*(("c", name) for name in NAMES), ("cython", "two_link")]


@pytest.mark.parametrize(("backend", "name"), BUILDS)
def test_packaged_arms(backend, name, folder):
    robot = mr.load(name)
    kernel = mc.compile(robot, functions_of(robot), directory=folder, backend=backend)
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors
    assert set(verification.max_errors) == set(functions_of(robot))
    assert verification.max_error < 1e-12


@pytest.mark.parametrize("joints", [1, 2, 3, 5, 6, 9, 12])
def test_random_arms(joints, folder):
    rng, convention = random.Random(joints), ["dh", "mdh"][joints % 2]
    robot = random_robot(rng, joints, convention)
    robot.name = f"{convention}_{joints}"
    robot.viscous_friction = [rng.randint(0, 3) for _ in range(joints)]
    robot.coulomb_friction = [(rng.randint(0, 3), rng.randint(0, 3)) for _ in range(joints)]
    robot.rotor_inertias = [rng.randint(1, 3) for _ in range(joints)]
    names = functions_of(robot)
    if joints > 6:  # the derivatives of long arms are compared with differences elsewhere
        names = tuple(x for x in names if "derivatives" not in x and not x.endswith("vp"))
    kernel = mc.compile(robot, names, directory=folder, backend="numpy")
    verification = mc.verify(kernel, robot, route=SymbolicRoute(robot, time_limit=1))
    assert verification.passed, verification.max_errors


@pytest.mark.parametrize("joints", [1, 4, 8])
def test_compiled_random_arms_equal_the_numpy_backend(joints, folder):
    rng = random.Random(1000 + joints)
    robot = random_robot(rng, joints, rng.choice(["dh", "mdh"]))
    robot.name = f"compiled_{joints}"
    robot.rotor_inertias = [1] * joints
    names = (
        "tau",
        "inertia_matrix",
        "coriolis_matrix",
        "forward_dynamics",
        "jacobian",
        "regressor",
    )
    compiled, in_numpy = (
        mc.compile(robot, names, directory=folder, backend=backend) for backend in ("c", "numpy")
    )
    states = np.random.default_rng(joints).uniform(-2, 2, (3, 50, joints))
    for name in names:
        given = states[: len(compiled.signatures[name].given)]
        found, expected = (np.atleast_1d(getattr(k, name)(*given)[0]) for k in (compiled, in_numpy))
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("joints", [12, 30, 60])
def test_the_command_on_long_arms(joints, tmp_path):
    """The whole job, timing and all, where the equations are too long for a closed form."""
    rng = random.Random(joints)
    links = [
        f"  - {{joint: revolute, a: {rng.randint(1, 9) / 50}, alpha: {rng.choice(['pi/2', 0])}, "
        f"d: {rng.randint(0, 9) / 50}, theta: 0, mass: {rng.randint(1, 9) / 4}, "
        f"com: [{rng.randint(-9, 9) / 100}, 0.02, 0.01], inertia: [0.1, 0.12, 0.11]}}"
        for _ in range(joints)
    ]
    text = "\n".join(["name: arm", "convention: dh", "gravity: [0, 0, -9.81]", "links:", *links])
    (tmp_path / "long.yaml").write_text(text)
    command = [sys.executable, "-m", "moro_codegen", "long.yaml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for words in ("too long to write out", "verified: ", "the equations take it too long"):
        assert words in done.stdout
