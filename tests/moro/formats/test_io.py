"""Good robot files: what is read, exactly, and the Robot that comes of it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
import sympy
import yaml
from arms import NAMES
from sympy import Integer, Matrix, Rational, pi

import moro.formats.loading
from moro import abc, load
from moro.formats.loading import packaged, read

REFERENCE = Path(__file__).parents[2] / "reference"

ARM = """\
name: arm
convention: mdh
gravity: [0, -g, 0]
parameters:
  m_tool: 2.5
  l_tool:
  g: 9.81
links:
  - joint: revolute
    a: 0
    alpha: -pi/2
    d: 0.4318
    theta: pi/2
    mass: 1.5
    com: [1e-3, -0.5, "atan2(1, 1)"]
    inertia: [0.1, 0.2, 0.15]
    rotor_inertia: 0.3
    friction: {viscous: 0.1, coulomb: [0.2, 0.25]}
    limits: [-pi, pi/2]
  - joint: prismatic
    a: l_tool
    alpha: 0
    d: 0.1 + l_tool/2
    theta: 30*pi/180
    mass: 1 + m_tool
    com: [0, 0, sqrt(2)*l_tool]
    inertia: [0.1, 0.2, 0.15, 0.01, -0.02, 0.03]
    friction: {coulomb: 0.5}
"""

KINEMATIC = """\
links:
  - {joint: revolute, a: 1, alpha: 0, d: 0, theta: 0}
  - {joint: prismatic, a: 1, alpha: 0, d: 0.2, theta: 0}
"""


@pytest.fixture
def write(tmp_path):
    def write(text: str, name: str = "arm.yaml") -> Path:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_every_value_is_exact(write):
    file = read(write(ARM))
    g, l_tool, m_tool = (sympy.Symbol(name) for name in ("g", "l_tool", "m_tool"))
    assert (file.name, file.convention) == ("arm", "mdh")
    assert file.gravity == (0, -g, 0)
    assert file.parameters == {m_tool: Rational(5, 2), l_tool: None, g: Rational(981, 100)}
    assert list(file.parameters) == [m_tool, l_tool, g]
    one, two = file.links
    assert (one.joint, two.joint) == ("revolute", "prismatic")
    assert (one.a, one.alpha, one.d, one.theta) == (0, -pi / 2, Rational(2159, 5000), pi / 2)
    assert (two.a, two.d, two.theta) == (l_tool, l_tool / 2 + Rational(1, 10), pi / 6)
    assert (one.mass, two.mass) == (Rational(3, 2), m_tool + 1)
    assert one.com == (Rational(1, 1000), Rational(-1, 2), pi / 4)
    assert two.com == (0, 0, sympy.sqrt(2) * l_tool)
    assert Matrix(one.inertia) == sympy.diag(*map(Rational, ("0.1", "0.2", "0.15")))
    assert Matrix(two.inertia) == Matrix(3, 3, [10, 1, -2, 1, 20, 3, -2, 3, 15]) / 100
    assert (one.rotor_inertia, two.rotor_inertia) == (Rational(3, 10), None)
    assert (one.friction.viscous, two.friction.viscous) == (Rational(1, 10), 0)
    assert one.friction.coulomb == (Rational(1, 5), Rational(1, 4))
    assert two.friction.coulomb == (Rational(1, 2), Rational(1, 2))
    assert (one.limits, two.limits) == ((-pi, pi / 2), None)


def test_robot_of_a_file(write):
    robot = load(write(ARM))
    file = read(write(ARM))
    assert (robot.name, robot.convention, robot.dof) == ("arm", "mdh", 2)
    assert list(robot.joint_types) == ["r", "p"]
    assert list(robot.qs) == [abc.q1, abc.q2]
    one, two = robot.dh_parameters
    assert tuple(one) == (0, -pi / 2, Rational(2159, 5000), abc.q1 + pi / 2)
    assert tuple(two) == (file.links[1].a, 0, abc.q2 + file.links[1].d, pi / 6)
    assert Matrix(robot.gravity) == Matrix(file.gravity)
    assert dict(robot.parameters) == file.parameters
    assert list(robot.masses) == [link.mass for link in file.links]
    assert [tuple(r) for r in robot.cm_positions] == [link.com for link in file.links]
    assert list(robot.inertia_tensors) == [Matrix(link.inertia) for link in file.links]
    assert list(robot.rotor_inertias) == [Rational(3, 10), 0]
    assert list(robot.viscous_friction) == [Rational(1, 10), 0]
    assert list(robot.coulomb_friction) == [
        file.links[0].friction.coulomb,
        (Rational(1, 2), Rational(1, 2)),
    ]
    assert list(robot.joint_limits) == [(-pi, pi / 2), (0, 1000)]
    assert not any(sympy.sympify(x).has(sympy.Float) for x in robot.masses)


def test_what_a_file_leaves_out_is_not_set(write):
    path = write(KINEMATIC, "my arm-2.yaml")
    file = read(path)
    assert (file.name, file.convention) == ("my_arm_2", "dh")
    assert file.gravity == (0, 0, Rational("-9.81"))
    assert file.parameters == {}
    assert file.links[0].mass is file.links[0].com is file.links[0].inertia is None
    robot = load(path)
    assert robot.name == "my_arm_2"
    assert robot.masses is None
    assert robot.cm_positions is None
    assert robot.inertia_tensors is None
    assert robot.rotor_inertias is None
    assert robot.viscous_friction is None
    assert robot.coulomb_friction is None
    assert list(robot.joint_limits) == [(-pi, pi), (0, 1000)]


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("ur-5e", "ur_5e"),
        ("ur5", "ur5"),
        ("Bras n°5 à gauche", "Bras_n5_a_gauche"),
        ("5axis", "robot_5axis"),
        ("for", "robot_for"),
        ("_x_", "x"),
        ("机器人", "robot"),
        ("x" * 60, "x" * 40),
    ],
)
def test_name_of_the_file_becomes_a_name(write, stem, name):
    assert read(write(KINEMATIC, f"{stem}.yaml")).name == name


@pytest.mark.parametrize(
    ("text", "inertia"),
    [
        ("[1, 2, 3]", [1, 0, 0, 0, 2, 0, 0, 0, 3]),
        ("[2, 2, 3, 0.1, 0.2, -0.3]", [2, "0.1", "0.2", "0.1", 2, "-0.3", "0.2", "-0.3", 3]),
        ("[[2, 0.1, 0], [0.1, 2, 0], [0, 0, 3]]", [2, "0.1", 0, "0.1", 2, 0, 0, 0, 3]),
        (
            "[[2, 0.1, 0], [0.10000000000000002, 2, 0], [0, 0, 3]]",
            [2, "0.1", 0, "0.1", 2, 0, 0, 0, 3],
        ),
        ("[[a + b, b*(a + 1), 0], [a*b + b, a, 0], [0, 0, a]]", None),
    ],
)
def test_forms_of_an_inertia(write, text, inertia):
    changed = ARM.replace("[0.1, 0.2, 0.15]", text)
    if inertia is None:
        changed = changed.replace("  g: 9.81", "  g: 9.81\n  a:\n  b: 1")
    found = Matrix(read(write(changed)).links[0].inertia)
    assert sympy.expand(found - found.T) == sympy.zeros(3)
    if inertia is not None:
        assert found == Matrix(3, 3, [Rational(x) for x in inertia])


def test_values_may_be_repeated_by_aliases(write):
    text = ARM.replace("friction: {viscous: 0.1", "friction: &f {viscous: 0.1")
    text = text.replace("friction: {coulomb: 0.5}", "friction: *f")
    one, two = read(write(text)).links
    assert one.friction == two.friction


def test_a_byte_order_mark_and_windows_lines_do_no_harm(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + ARM.replace("\n", "\r\n").encode())
    assert len(read(path).links) == 2


def test_a_hundred_links(write):
    link = KINEMATIC.splitlines()[1]
    robot = load(write("\n".join(["links:", *[link] * 100])))
    assert robot.dof == 100


# --- packaged arms -------------------------------------------------------------------------------


def test_packaged_arms():
    assert packaged() == (
        "cobra600", "palletizer", "panda", "puma560", "solo12", "stanford_arm", "two_link", "ur5",
        "ur5e", "xarm7",
    )  # fmt: skip


@pytest.mark.parametrize("name", [*NAMES, "ur5e"])
def test_packaged_arm_says_what_its_yaml_says(name):
    """Against a plain YAML reader, whose floats print as the decimals of the file."""
    robot = load(name)
    assert robot.name == name
    path = Path(moro.formats.loading.__file__).parent.parent / "robots" / f"{name}.yaml"
    data = yaml.safe_load(path.read_text())
    links = data["links"]
    assert robot.dof == len(links)
    assert robot.convention == data["convention"]
    assert Matrix(robot.gravity) == Matrix([_exact(x) for x in data["gravity"]])
    for i, (link, row) in enumerate(zip(links, robot.dh_parameters, strict=True)):
        q = abc.joint_variable(i + 1)
        moving = {"revolute": 3, "prismatic": 2}[link["joint"]]
        expected = [_exact(link[key]) for key in ("a", "alpha", "d", "theta")]
        expected[moving] += q
        assert list(row[:4]) == expected
        assert robot.masses[i] == _exact(link["mass"])
        assert list(robot.cm_positions[i]) == [_exact(x) for x in link["com"]]
        xx, yy, zz, xy, xz, yz = (_exact(x) for x in link["inertia"])
        assert robot.inertia_tensors[i] == Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if "rotor_inertia" in link:
            assert robot.rotor_inertias[i] == _exact(link["rotor_inertia"])
        if "friction" in link:
            assert robot.viscous_friction[i] == _exact(link["friction"]["viscous"])
            pair = tuple(_exact(x) for x in link["friction"]["coulomb"])
            assert tuple(robot.coulomb_friction[i]) == pair
        if "limits" in link:
            assert tuple(robot.joint_limits[i]) == tuple(_exact(x) for x in link["limits"])
    states = json.loads((REFERENCE / f"{name}.json").read_text())["states"]
    assert {len(state["q"]) for state in states} == {robot.dof}


def _exact(value: object) -> sympy.Expr:
    quarters = {"pi/2": pi / 2, "-pi/2": -pi / 2, "2*pi": 2 * pi, "-2*pi": -2 * pi}
    return quarters[value] if isinstance(value, str) and "pi" in value else Rational(str(value))


def test_a_path_object_is_never_a_packaged_arm():
    with pytest.raises(moro.formats.loading.RobotFileError, match="no such file"):
        load(Path("puma560"))


def test_a_file_next_to_a_packaged_name(write, monkeypatch):
    monkeypatch.chdir(write(KINEMATIC, "ur5").parent)
    assert load("ur5").dof == 6
    assert load("./ur5").dof == 2
    write(KINEMATIC, "mine")
    assert load("mine").dof == 2


def test_importing_moro_io_is_light():
    code = "import sys, moro.io; sys.exit(any(m in sys.modules for m in ('yaml', 'pydantic')))"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_zero_is_exact_zero(write):
    assert read(write(KINEMATIC)).links[0].alpha is Integer(0)
