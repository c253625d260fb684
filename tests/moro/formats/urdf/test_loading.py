"""A URDF from a path to a Robot: what is meant of it, and how formats are told apart."""

import copy
import pickle
import subprocess
import sys

import pytest
import sympy as sp
from urdfs import axis, body, joint, link, origin, robot, written

import moro as mr
from moro.formats.errors import RobotFileError

R = sp.Rational
LEG = (
    link("base", body(9)),
    joint("hip", "base", "thigh", axis("1 0 0") + '<limit lower="-1" upper="1"/>'),
    link("thigh", body(3)),
    joint("knee", "thigh", "shank", origin("0 0 -0.3") + axis("0 1 0")),
    link("shank", body(2)),
    joint("ankle", "shank", "foot", origin("0 0 -0.3"), "fixed"),
    link("foot", body(1)),
    joint("toe", "foot", "toe_link", axis("0 1 0")),
    link("toe_link", body(R(1, 2).evalf())),
)


@pytest.fixture
def leg(tmp_path):
    return written(tmp_path, robot(*LEG, name="leg"))


def test_the_part_that_is_meant(leg):
    shank = mr.load(leg, tip="shank")
    assert shank.joint_names == ["hip", "knee"]
    assert shank.masses == [3, 2]
    foot = mr.load(leg, root="thigh", tip="foot")
    assert foot.joint_names == ["knee"]
    assert foot.masses == [3]
    assert foot.T_i0("foot")[2, 3].subs(foot.q(1), 0) == sp.Float(-0.6)
    assert "without 2 others" in str(foot.model_summary())
    assert "thigh stands still, with its 3 kg" in str(foot.model_summary())


def test_joints_that_stand_still(leg):
    still = mr.load(leg, fix={"toe": 0.25, "hip": 0})
    assert still.joint_names == ["knee"]
    assert still.masses == [R(7, 2)]
    assert "toe = 1/4, hip = 0" in str(still.model_summary())
    quarter = mr.load(leg, fix={"hip": 1.5707963267948966 / 2})
    assert sp.nsimplify(quarter.z("thigh")[2]) == sp.sqrt(2) / 2, "the float next to pi/4 is pi/4"


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"tip": "fot"}, 'tip: no link is called fot; did you mean "foot"'),
        ({"root": "hip"}, r"root: no link is called hip .*there are base, thigh, shank, foot"),
        ({"fix": {"ankle": 0}}, r"joint: no joint of leg that moves is called ankle"),
        ({"fix": {"toe": "x"}}, "fix of toe must be a number"),
        ({"tip": "base"}, "leg has no joint that moves"),
    ],
)
def test_what_cannot_be_meant(leg, how, message):
    with pytest.raises((ValueError, TypeError), match=message):
        mr.load(leg, **how)


def test_a_joint_cannot_stand_beyond_its_limits_unsaid(leg):
    with pytest.warns(UserWarning, match=r"hip is fixed at 3, beyond its limits -1\.\.1"):
        mr.load(leg, fix={"hip": 3})


def test_rows_have_no_parts():
    for how in ({"root": "1"}, {"tip": "x"}, {"fix": {"x": 1}}):
        with pytest.raises(
            ValueError, match=r"(root|tip|fix) of puma560: its links are rows of DH"
        ):
            mr.load("puma560", **how)
    with pytest.raises(ValueError, match="as_written is for a URDF or an MJCF: puma560"):
        mr.load("puma560", as_written=True)


def test_parts_of_a_robot_yaml(tmp_path):
    path = tmp_path / "arms.yaml"
    path.write_text(
        "links:\n"
        "  - {name: trunk, joint: revolute, axis: z, mass: 3, com: [0, 0, 0], inertia: [1, 1, 1]}\n"
        "  - {name: left, parent: trunk, joint: revolute, axis: y, mass: 2, com: [0, 0, 0],"
        " inertia: [1, 1, 1]}\n"
        "  - {name: right, parent: trunk, joint: revolute, axis: y, mass: 1, com: [0, 0, 0],"
        " inertia: [1, 1, 1]}\n"
    )
    whole, part = mr.load(path), mr.load(path, tip="left")
    assert (whole.dof, part.dof) == (3, 2)
    assert part.masses == [3, 2]


@pytest.mark.parametrize("name", ["leg.xml", "leg.txt", "leg"])
def test_a_urdf_is_known_by_its_root(tmp_path, name):
    text = f"<?xml version='1.0'?>\n<!-- <mujoco> -->\n{robot(*LEG)}"
    assert mr.load(tmp_path / written(tmp_path, text, name)).dof == 3


def test_other_formats_are_named(tmp_path):
    expected = r"is SDF, the format of Gazebo; expected a robot\.yaml, a URDF or an MJCF"
    with pytest.raises(RobotFileError, match=expected):
        mr.load(written(tmp_path, "<sdf/>", "arm.xml"))
    with pytest.raises(
        ValueError, match=r"no joint that moves|MuJoCo.s own reader, which is not installed"
    ):
        mr.load(written(tmp_path, "<mujoco/>", "arm.xml"))
    with pytest.raises(RobotFileError, match="expected the root <robot> of a URDF, found <mujoco>"):
        mr.load(written(tmp_path, "<mujoco/>", "arm.urdf"))
    with pytest.raises(RobotFileError, match="no such file"):
        mr.load(tmp_path / "none.urdf")


def test_copies_keep_names_and_readings(leg):
    arm = mr.load(leg)
    for other in (copy.copy(arm), pickle.loads(pickle.dumps(arm))):  # noqa: S301
        assert other.joint_names == arm.joint_names
        assert str(other.model_summary()) == str(arm.model_summary())
        assert other.model() == arm.model()


def test_refusing_needs_no_sympy(tmp_path):
    path = written(tmp_path, "<robot><link></robot>")
    program = (
        "import sys\nfrom moro.formats.loading import description\n"
        f"try: description({str(path)!r})\nexcept ValueError as e: print(e)\n"
        "print('sympy' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "mismatched tag" in done.stdout
    assert done.stdout.endswith("False\n")
