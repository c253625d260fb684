"""FMUs: valid by FMPy, simulated by it in both ways and versions, against an integration here."""

import json
import zipfile

import numpy as np
import pytest
from exports import two_link
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

import moro as mr
import moro_codegen as mc

TORQUE = 3.0
START = {"q[1]": 0.3, "q[2]": -0.5, "qd[2]": 1.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The two-link arm with friction and a payload that is a parameter."""
    robot = two_link(payload=0.5)
    robot.viscous_friction, robot.coulomb_friction = [0.1, 0.2], [0.3, 0]
    (made,) = mc.export(robot, tmp_path_factory.mktemp("out"), ("fmu",))
    return made


@pytest.fixture(scope="module")
def expected():
    """Positions after half a second, by Runge and Kutta's method in fine steps."""
    robot = two_link(payload=0.5)
    robot.viscous_friction = [0.1, 0.2]
    kernel = mc.compile(robot, functions=("forward_dynamics",), backend="numpy")

    def rates(x):
        friction = np.array([0.3 * np.tanh(x[2] / 0.01), 0])
        torque = np.array([TORQUE, 0]) - friction
        return np.concatenate([x[2:], kernel.forward_dynamics(x[:2], x[2:], torque)])

    x, h = np.array([0.3, -0.5, 0, 1.0]), 1e-3
    for _ in range(500):
        k1 = rates(x)
        k2 = rates(x + h / 2 * k1)
        k3 = rates(x + h / 2 * k2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(x + h * k3))
    return x


def simulated(path, kind, **more):
    held = np.array(
        [(0, TORQUE, 0.0), (1, TORQUE, 0.0)], [(x, float) for x in ("time", "tau[1]", "tau[2]")]
    )
    result = simulate_fmu(
        str(path), stop_time=0.5, output_interval=0.01, fmi_type=kind, relative_tolerance=1e-9,
        start_values={**START, **more}, input=held, output=["q[1]", "q[2]", "qd[1]", "qd[2]"],
    )  # fmt: skip
    return np.array([*result[-1]][1:])


@pytest.mark.parametrize("file", ["two_link.fmu", "two_link_fmi2.fmu"])
class TestUnit:
    def test_is_valid(self, folder, file):
        assert validate_fmu(str(folder / file)) == []

    @pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
    def test_moves_as_the_equations_say(self, folder, file, kind, expected):
        assert np.allclose(simulated(folder / file, kind), expected, atol=2e-6)

    def test_parameters_are_those_of_the_kernel(self, folder, file, expected):
        heavier = simulated(folder / file, "CoSimulation", payload=2.0)
        assert np.abs(heavier - expected).max() > 0.01

    def test_says_what_its_variables_are(self, folder, file):
        described = {x.name: x for x in read_model_description(str(folder / file)).modelVariables}
        assert described["tau[2]"].causality == "input"
        assert described["q[1]"].unit == "rad"
        assert described["payload"].start == "0.5"
        assert described["qd[1]"].derivative.name == "q[1]"
        assert described["friction_width"].start == "0.01"


def test_the_same_again(folder, tmp_path):
    robot = two_link(payload=0.5)
    robot.viscous_friction, robot.coulomb_friction = [0.1, 0.2], [0.3, 0]
    (again,) = mc.export(robot, tmp_path, ("fmu",))
    for path in folder.glob("*.fmu"):
        assert path.read_bytes() == (again / path.name).read_bytes()
    assert json.loads((again / "moro.json").read_text())["files"].keys() == {
        "two_link.fmu", "two_link_fmi2.fmu", "README.md",
    }  # fmt: skip


def test_sources_are_in_it(folder):
    with zipfile.ZipFile(folder / "two_link.fmu") as unit:
        names = set(unit.namelist())
    assert {"sources/two_link.c", "sources/fmu.c", "sources/buildDescription.xml"} <= names


def test_what_cannot_be_a_unit_is_refused(tmp_path):
    with pytest.raises(ValueError, match="ur5 has no forward dynamics"):
        mc.export(mr.load("ur5"), tmp_path, ("fmu",))
    robot = two_link(payload=None)
    with pytest.raises(ValueError, match="parameter payload has no default"):
        mc.export(robot, tmp_path, ("fmu",))
    assert not any(tmp_path.iterdir())
