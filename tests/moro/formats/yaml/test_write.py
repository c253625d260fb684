"""Robots that are saved: the same model comes back, in a file that a person could have written."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from arms import NAMES, random_model
from assemblies import X, joint
from assemblies import arm as assembled_arm
from assemblies import robot as links_of
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import complete
from trees import planar_tree

import moro as mr
from moro import Robot
from moro.abc import l1, m1, q1, q2, q3
from moro.formats.assembled import Assembled
from moro.formats.loading import packaged
from moro.model import Shift

pytestmark = pytest.mark.filterwarnings("ignore::moro.io.RobotFileWarning")
SEEDS = st.integers(0, 2**32 - 1)


def again(robot, path):
    robot.save(path)
    return mr.load(path)


@pytest.mark.parametrize("name", packaged())
def test_packaged_robots_are_saved_as_they_are(name, tmp_path):
    assert again(mr.load(name), tmp_path / "arm.yaml").model() == mr.load(name).model()


@pytest.mark.parametrize("name", [*NAMES, "ur5e"])
def test_rows_stay_rows(name, tmp_path):
    robot = mr.load(name)
    assert again(robot, tmp_path / "arm.yaml").model() == robot.model()
    text = (tmp_path / "arm.yaml").read_text()
    assert "alpha: " in text
    assert "xyz" not in text
    assert again(mr.load(tmp_path / "arm.yaml"), tmp_path / "b.yaml").model() == robot.model()
    assert (tmp_path / "b.yaml").read_text() == text


def test_decimals_stay_as_they_are_given(tmp_path):
    mr.load("puma560").save(tmp_path / "puma.yaml")
    text = (tmp_path / "puma.yaml").read_text()
    for value in ("0.67183", "pi/2", "[-0.3638, 0.006, 0.2275]", "[24.7313845, 27.2358285]"):
        assert value in text


FILE = """\
name: all_of_it
convention: dh
gravity: [0, 0, -9.81]
parameters: {m_p: 2, h: ~}
base: {xyz: [0, 0, h], rpy: [pi, 0, 0]}
tool: {link: upper, xyz: [0, 0, 0.1]}
coordinates: {q4: {rotor_inertia: 2, limits: [-1, 1]}}
links:
  - joint: revolute
    name: upper
    joint_name: shoulder
    a: 0.5
    alpha: pi/2
    d: 0
    theta: -q1 + pi/4
    mass: m_p + 1.5
    com: [0, 0.1*m_p, 0]
    inertia: {xx: 1, yy: 2, zz: 2, xy: 0.1}
    bodies:
      - mass: m_p
        com: [0, 0, 0]
        inertia: [0, 0, 0]
        xyz: [0, 0, 0.25]
        rpy: [0, 0.3, 0]
      - mass: 0
        first_moment: [1, 0, 0]
        inertia: [0, 0, 1]
        inertia_about: origin
    frames: {camera: {xyz: [0.1, 0, 0], rpy: [0, pi/2, 0]}}
    rotor_inertia: 3
    friction: {viscous: 0.1, coulomb: [1, 2], static: 3, stribeck_velocity: 0.1, smooth: 0.01}
    stiffness: 10
    rest: 0.1
    limits: [-pi, pi]
  - joint: helical
    xyz: [0, 0, 1]
    axis: y
    pitch: 0.01
    bodies: []
  - joint: fixed
    name: flange
    a: 0
    alpha: 0
    d: 0.05
    theta: 0
    mass: 1
    com: [0, 0, 0]
    inertia: [1, 1, 1]
  - joint: prismatic
    parent: upper
    a: 0
    alpha: 0
    d: 2*q3 + q4
    theta: pi/2
    bodies: []
  - joint: revolute
    axis: [1, 2, 2]
    theta: q3 - q4
    bodies: []
"""


def test_a_file_with_all_there_is_comes_back_as_it_was(tmp_path):
    path = tmp_path / "all.yaml"
    path.write_text(FILE)
    robot = mr.load(path)
    same = again(robot, tmp_path / "again.yaml")
    text = (tmp_path / "again.yaml").read_text()
    for line in FILE.splitlines():
        assert line in text.splitlines(), line
    again(same, tmp_path / "third.yaml")
    assert (tmp_path / "third.yaml").read_text() == text
    close(robot.model(), same.model())


def number(x):
    values = {s: (hash(str(s)) % 97 + 50) / 100 for s in sp.sympify(x).free_symbols}
    return float(sp.sympify(x).subs(values))


def numbers(*values):
    return np.array([[number(x) for x in np.ravel(np.array(v, dtype=object))] for v in values])


def close(one, other):
    """Two models are the same, to rounding."""
    assert len(one.joints) == len(other.joints)
    for a, b in zip(one.joints, other.joints, strict=True):
        assert (a.type, a.parent, a.terms, a.name) == (b.type, b.parent, b.terms, b.name)
        assert np.allclose(
            numbers(a.placement.R, a.placement.R), numbers(b.placement.R, b.placement.R)
        )
        assert np.allclose(numbers(a.placement.p), numbers(b.placement.p), rtol=1e-13)
        assert number(a.offset - b.offset) == pytest.approx(0, abs=1e-13)
    for a, b in zip(one.bodies, other.bodies, strict=True):
        assert number(a.mass - b.mass) == 0
        assert np.allclose(numbers(a.first_moment), numbers(b.first_moment), rtol=1e-12)
        assert np.allclose(numbers(a.inertia), numbers(b.inertia), rtol=1e-12, atol=1e-13)
    assert [x.drive for x in one.coordinates] == [x.drive for x in other.coordinates]
    assert [x.limits for x in one.coordinates] == [x.limits for x in other.coordinates]
    assert one.gravity == other.gravity
    assert (one.tip.name == "tip") or one.tip.name == other.tip.name
    assert one.tip.link == other.tip.link
    assert np.allclose(numbers(one.tip.placement.p), numbers(other.tip.placement.p))
    known = {frame.name: frame.link for frame in other.frames}
    assert all(known.get(frame.name) == frame.link for frame in one.frames)


@pytest.mark.sweep
@settings(deadline=None, max_examples=15)
@given(seed=SEEDS, tree=st.booleans())
def test_random_robots(tmp_path_factory, seed, tree):
    rng = np.random.default_rng(seed)
    model = random_model(rng, int(rng.integers(1, 6)), tree=tree)
    robot = Robot.of(model)
    same = again(robot, tmp_path_factory.mktemp("saved") / "robot.yaml")
    close(robot.model(), same.model())


def test_hand_made_trees_and_assemblies(tmp_path):
    tree = Robot.of(planar_tree())
    same = again(tree, tmp_path / "tree.yaml")
    assert same.inertia_matrix() == tree.inertia_matrix()
    made = Robot.of(Assembled(assembled_arm()))
    close(made.model(), again(made, tmp_path / "arm.yaml").model())
    text = (tmp_path / "arm.yaml").read_text()
    assert "name: upper" in text
    assert "joint_name: upper_joint" in text
    assert "  - joint: fixed\n    name: camera\n    parent: upper\n    xyz: [1, 0, 1]\n" in text


def test_rows_in_symbols_get_names_that_a_file_can_hold(tmp_path):
    robot = complete()
    same = again(robot, tmp_path / "robot.yaml")
    text = (tmp_path / "robot.yaml").read_text()
    assert "# I_x_1x_1: I_{x_1x_1}" in text
    names = {s: sp.Symbol(str(s).replace("{", "").replace("}", "")) for s in robot.parameters}
    assert robot.simplify(robot.inertia_matrix().subs(names) - same.inertia_matrix()).is_zero_matrix
    assert same.convention == "dh"


def test_coupled_coordinates(tmp_path):
    links = [
        {"joint": "revolute", "a": 1, "alpha": 0, "d": 0, "theta": theta, "bodies": []}
        for theta in (0, 0, -q1 - q2, q3)
    ]
    robot = Robot.of({"links": links})
    close(robot.model(), again(robot, tmp_path / "robot.yaml").model())
    assert "theta: -q1 - q2\n" in (tmp_path / "robot.yaml").read_text()


def test_what_was_not_set_is_not_set(tmp_path):
    bare = Robot((l1, 0, 0, q1))
    same = again(bare, tmp_path / "bare.yaml")
    assert same.model().not_set == bare.model().not_set
    assert same.gravity is None


def test_what_no_file_can_hold_leaves_the_file_as_it_was(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text("as it was")
    robot = Robot((l1, 0, 0, q1))
    robot.masses = [m1]
    with pytest.raises(ValueError, match=r"robot cannot be saved: .*cm_positions.* not set"):
        robot.save(path)
    robot = Robot((sp.sinh(l1), 0, 0, q1))
    with pytest.raises(ValueError, match=r"sinh\(l_1\) cannot be written in a robot file"):
        robot.save(path)
    robot = Robot((l1, 0, 0, q1))
    with pytest.raises(FileNotFoundError):
        robot.save(tmp_path / "no" / "robot.yaml")
    assert [x.name for x in tmp_path.iterdir()] == ["robot.yaml"]
    assert path.read_text() == "as it was"
    robot.save(path)
    assert path.read_text() != "as it was"
    assert [x.name for x in tmp_path.iterdir()] == ["robot.yaml"]


def test_parameters_that_are_put_in(tmp_path):
    path = tmp_path / "all.yaml"
    path.write_text(FILE)
    robot = mr.load(path).with_parameters({"m_p": 3, "h": sp.Rational(1, 3)})
    same = again(robot, tmp_path / "again.yaml")
    assert same.parameters == {}
    close(robot.model(), same.model())
    assert "xyz: [0, 0, 1/3]" in (tmp_path / "again.yaml").read_text()


def test_names_that_files_have_to_quote(tmp_path):
    link = {"joint": "revolute", "axis": "z", "bodies": []}
    links = [link | {"name": name} for name in ("left arm: #1", "on", "it's", "a/b-c.d")]
    robot = Robot.of({"links": links})
    same = again(robot, tmp_path / "robot.yaml")
    assert [x.name for x in same.model().frames] == [x.name for x in robot.model().frames]
    assert replace(same.model(), frames=()) == replace(robot.model(), frames=())
    assert NAMES


def test_a_frame_shifted_by_nothing_is_on_its_axis(tmp_path):
    """As the joints of MuJoCo's bodies, whose anchors are their origins."""
    only = joint("cart", None, (0, 0, 1), X)
    nowhere = Shift((sp.Integer(0),) * 3)
    made = Robot.of(Assembled(links_of(replace(only, path=(*only.path, nowhere)))))
    same = again(made, tmp_path / "robot.yaml")
    assert same.model() == made.model()
    assert "    xyz: [0, 0, 1]\n    axis: x\n" in (tmp_path / "robot.yaml").read_text()
