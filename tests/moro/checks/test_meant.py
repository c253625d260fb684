"""What is said of words, values and files that are not known: each names what was meant."""

import re

import pytest
import sympy as sp

import moro as mr
import moro_codegen as mc
from moro import Robot
from moro.abc import l1, l2, q1, q2
from moro.checks.meant import meant
from moro_codegen import FUNCTIONS

ROWS = "links:\n  - {joint: R, alpha: 0, d: 0, theta: 0, "


@pytest.mark.parametrize(
    ("word", "function"),
    [
        ("inverse_dynamics", "tau"),
        ("rnea", "tau"),
        ("mass_matrix", "inertia_matrix"),
        ("crba", "inertia_matrix"),
        ("M", "inertia_matrix"),
        ("coriolis", "coriolis_matrix"),
        ("C", "coriolis_matrix"),
        ("gravity", "gravity_vector"),
        ("G", "gravity_vector"),
        ("aba", "forward_dynamics"),
        ("fkine", "forward_kinematics"),
        ("tua", "tau"),
        ("quaternion", None),
    ],
)
def test_functions_by_the_names_of_the_field(word, function):
    assert meant(word, FUNCTIONS) == function


def test_a_function_that_there_is_not_says_how_to_make_it():
    with pytest.raises(ValueError, match=r'Function\("jacobian_dot", robot.J.diff\(t\)\)'):
        mc.compile(mr.load("two_link"), ("jacobian_dot",), backend="numpy")


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("base", "; frame 0 is the base"),
        ("tool", "; a tool is part of the last link"),
        ("gear_ratio", "; drives are given at the link side"),
        ("mass", '; did you mean "masses"?'),
        ("qlim", '; did you mean "joint_limits"?'),
        ("colour", "$"),
    ],
)
def test_attributes(word, said):
    with pytest.raises(AttributeError, match=rf"a Robot has no {word}{said}".replace("?", r"\?")):
        setattr(Robot((l1, 0, 0, q1)), word, 1)


@pytest.mark.parametrize(
    ("action", "error", "said"),
    [
        (lambda: mc.compile("two_link"), TypeError, "takes a Robot, found str: moro.load('two_l"),
        (lambda: Robot((0, 0, 0, q1), masses=[1]), TypeError, "not masses=; set it afterwards: ro"),
        (lambda: Robot((0, 0, 0, q1), foo=1), TypeError, "rows, convention= and name=, not foo="),
        (lambda: mr.load({}), TypeError, "the path of a robot file or the name of a packaged arm"),
        (lambda: Robot((l1, 0, 0, q1), (l2, 0, 0, 0)), ValueError, "A fixed row, of a tool say"),
        (
            lambda: Robot((0, 0, 0, q1), (0, 0, 0, q1)),
            ValueError,
            "joints that move together are links of Robot.of",
        ),
        (lambda: mc.compile(mr.load("two_link"), (("tau", "tau"),)), ValueError, "asked for twice"),
    ],
)
def test_things(action, error, said):
    with pytest.raises(error, match=re.escape(said)):
        action()


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.urdf", '<?xml version="1.0"?>\n<robot name="a"/>', "there is no <link> in it"),
        ("a.sdf", "<sdf/>", "is SDF, the format of Gazebo"),
        ("a.xacro", "<robot><xacro:a/></robot>", "is xacro, of which ROS makes a URDF"),
        ("a.json", '{"a": 1}', "is JSON; expected a robot.yaml"),
        ("a.yaml", ROWS + "a: 1,5}\n", "links[1].a: `1,5` has a decimal comma; write `1.5`"),
        ("a.yaml", ROWS + "a: payload}\n", "declare it, `parameters: {payload: 1}`"),
        ("a.yaml", ROWS + "a: 1, gear: 3}\n", "did you mean `gear_ratio`?"),
        ("a.yaml", ROWS + "a: 1, flange: 3}\n", "a tool is part of the last link"),
        ("a.yaml", ROWS + "a: 1, armature: 3}\n", "did you mean `rotor_inertia`?"),
        (
            "a.yaml",
            ROWS + "a: 1, mass: 1, com: [0, 0, 0], inertia: {ixx: 1, yy: 1, zz: 1, ab: 3}}\n",
            "links[1].inertia: has an entry ab; its entries are xx, yy, zz, xy, xz, yz",
        ),
    ],
)
def test_files(tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=re.escape(said)):
        mr.load(tmp_path / name)


def test_words_are_read_in_capitals_and_short(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("convention: MDH\n" + ROWS + "a: 1}\n")
    assert mr.load(path).convention == "mdh"


@pytest.mark.parametrize(("dtype", "scalar"), [("float", "float"), ("double", "double")])
def test_scalar_types_by_the_words_of_c(dtype, scalar):
    kernel = mc.compile(mr.load("two_link"), backend="numpy", dtype=dtype)
    assert kernel.manifest["scalar"] == scalar


HIDDEN = sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1


@pytest.mark.parametrize("zero", [HIDDEN, sp.log(HIDDEN + 1), 3 * HIDDEN])
def test_zeros_in_disguise_are_zero(zero):
    robot = Robot((zero, 0, 0, q1), (l1 + l2 * zero, 0, 0, q2))
    assert [row.a for row in robot.arm.rows] == [0, l1]


@pytest.mark.parametrize("value", ["sin(1)**2 + cos(1)**2 - 1", "log(sin(1)**2 + cos(1)**2)"])
def test_zeros_in_disguise_in_files(tmp_path, value):
    path = tmp_path / "arm.yaml"
    path.write_text(ROWS + f"a: 1, mass: {value}, com: [0, 0, 0], inertia: [1, 1, 1]}}\n")
    assert mr.load(path).masses == [0]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (sp.log(HIDDEN), "must be finite"),
        (10**400, "must be 0 or within 1e-300..1e300 in size, not about 1e400"),
        (l1 * 10**400, "must be 0 or within 1e-300..1e300 in size"),
        (sp.exp(1000), "not about 1e434"),
    ],
)
def test_constants_that_no_number_holds(value, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        Robot((value, 0, 0, q1))


def test_other_constants_are_numbers():
    x = sp.Symbol("x")
    value = sp.Integral(sp.exp(-(x**2)), (x, 0, 1)) + sp.zeta(3)
    robot = Robot((value, 0, 0, q1))
    robot.masses, robot.cm_positions, robot.gravity = [value], [[0, 0, 0]], [0, -9.81, 0]
    robot.inertia_tensors, robot.viscous_friction = [[value, 1, value]], [sp.zeta(3)]
    kernel = mc.compile(robot, ("tau", "jacobian"), backend="numpy")
    assert abs(kernel.jacobian([0])[1, 0] - float(value.evalf())) < 1e-15
    assert mc.verify(kernel, robot).passed


def test_a_robots_name_that_is_too_long():
    robot = mr.load("two_link")
    robot.name = "x" * 300
    with pytest.raises(ValueError, match=r"a robot's name of 300 characters .* at most 100"):
        mc.compile(robot, backend="numpy")
