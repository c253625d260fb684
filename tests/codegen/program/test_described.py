"""Headers, modules and manifests say the frames, gravity, and what run-time parameters are."""

import pytest
import sympy as sp
from programs import everything_program

import moro as mr
import moro_codegen as mc
from moro.abc import l1, l2, q1, q2
from moro.formats.dh.meanings import meanings
from moro_codegen.backends.c_text import emit as emit_c
from moro_codegen.backends.numpy import emit as emit_numpy
from moro_codegen.program import generate

M2, G, V, C, IZ = sp.symbols("m_2 g v c I_z")


def arm(convention="dh"):
    robot = mr.Robot((l1, 0, 0, q1), (l2, 0, 0, q2), convention=convention, name="arm")
    robot.masses = [1, M2]
    robot.cm_positions = [[-l1 / 2, 0, 0], [-l2 / 2, 0, l1]]
    robot.inertia_tensors = [sp.diag(0, IZ, IZ)] * 2
    robot.gravity = [0, -G, sp.Rational("0.25")]
    robot.viscous_friction = [V, 0]
    robot.coulomb_friction = [(C, C), (1, 2 * C)]
    robot.rotor_inertias = [0, V]
    robot.parameters = {G: sp.Rational("9.81"), M2: 3}
    return robot


def test_meanings():
    assert meanings(arm().arm) == {
        "g": "in gravity y",
        "m_2": "mass of link 2",
        "l_1": "a of row 1, in com x of link 1, com z of link 2",
        "l_2": "a of row 2, in com x of link 2",
        "I_z": "Iyy of links 1 and 2, Izz of links 1 and 2",
        "v": "rotor inertia of joint 2, viscous friction of joint 1",
        "c": "Coulomb friction of joint 1, in Coulomb friction where qd < 0 of joint 2",
    }


def test_only_what_is_there_has_a_meaning():
    robot = mr.Robot((l1, 0, l2, q1), name="bare")
    assert meanings(robot.arm) == {"l_1": "a of row 1", "l_2": "d of row 1"}
    program = generate(robot, ("jacobian",))
    assert program.gravity is None
    assert not any("Gravity" in text for text in emit_c(program).values())


@pytest.mark.parametrize(("convention", "name"), [("dh", "standard"), ("mdh", "modified")])
def test_texts(convention, name):
    robot = arm(convention)
    program = generate(robot, ("tau",))
    for text in (emit_c(program)["arm.h"], emit_numpy(program)["arm.py"]):
        assert f"Frames 0 (the base) to 2: {name} Denavit-Hartenberg convention." in text
        assert "Gravity, in frame 0: (0, -g, 0.25) m/s^2." in text
        assert "parameters[0]  g, default 9.81: in gravity y\n" in text
        assert "parameters[1]  m_2, default 3.0: mass of link 2\n" in text
        assert max(map(len, text.split("tau")[0].splitlines())) <= 100
    assert program.parameters[0].default == 9.81


def test_kernels_say_it(tmp_path):
    kernel = mc.compile(arm(), directory=tmp_path, backend="numpy")
    assert kernel.manifest["convention"] == "dh"
    assert kernel.manifest["gravity"] == ["0", "-g", "0.25"]
    assert kernel.manifest["parameters"][1]["description"] == "mass of link 2"
    assert "m_2  (default 3.0)  mass of link 2" in kernel.tau.__doc__
    puma = mc.compile(mr.load("puma560"), directory=tmp_path)
    assert "Gravity, in frame 0: (0, 0, -9.81) m/s^2." in puma.header.read_text()


def test_lambdify_says_it():
    assert "m_2  (default 3.0)  mass of link 2" in mc.lambdify(M2 * q1, arm()).__doc__


def test_programs_without_a_robot_say_nothing_of_it():
    for text in emit_c(everything_program()).values():
        assert "Denavit" not in text
        assert "Gravity" not in text
