"""What is no tree of joints, what MuJoCo refuses, what is hostile: clear errors, nothing else."""

import os
import re
import subprocess
import sys

import pytest
from hypothesis import given, settings
from mjcfs import BALL, IS_4, body, inertial, joint, loaded, robot, written
from slips import slipped

import moro as mr
from moro.formats.errors import RobotFileError
from moro.formats.mjcf.reader import read

ARM = body("a", joint("q1"), BALL, body("b", joint("q2"), BALL))
LAUGHS = '<!DOCTYPE x [<!ENTITY a "a"><!ENTITY b "&a;&a;">]>\n<mujoco model="&b;"/>'


def tendon(more, inside='<joint joint="q1" coef="1"/><joint joint="q2" coef="1"/>'):
    return f'<tendon><fixed name="t" {more}>{inside}</fixed></tendon>'


def equality(text):
    return f"<equality>{text}</equality>"


@pytest.mark.parametrize(
    ("rest", "message"),
    [
        (
            equality('<connect body1="b" body2="world" anchor="0 0 0"/>'),
            "connect: it closes a loop",
        ),
        (equality('<weld body1="a" body2="b"/>'), "weld: it closes a loop, of a and b"),
        (
            equality('<joint joint1="q1" joint2="q2" polycoef="0 1 2 0 0"/>'),
            "equality of joint q1: it follows q2 by a polynomial",
        ),
        (
            equality('<joint joint1="q1" joint2="q2"/><joint joint1="q2" joint2="q1"/>'),
            "equality of joint q2: it is coupled to others already",
        ),
        (equality('<joint joint1="no" joint2="q2"/>'), "there is no joint `no`"),
        (tendon('stiffness="1"'), "tendon t: its stiffness: what acts on several joints at once"),
        (tendon('damping="1" frictionloss="2"'), "its damping and frictionloss: what acts"),
        (
            tendon("", '<joint joint="q1" coef="1"/>') + equality('<tendon tendon1="t"/>'),
            "it holds the length of a tendon",
        ),
    ],
)
def test_what_ties_joints_in_ways_that_are_not_read(tmp_path, rest, message):
    with pytest.raises(RobotFileError, match=message) as error:
        loaded(tmp_path, ARM, rest=rest)
    assert re.search(r"robot\.xml:\d+: ", str(error.value))


def test_a_loop_is_none_where_it_is_cut(tmp_path):
    loop = equality('<connect body1="b" body2="world" anchor="0 0 0"/>')
    assert loaded(tmp_path, ARM, rest=loop, tip="a")[0].joint_names == ["q1"]
    rigid = body("flange", body("a", joint("q1"), BALL), body("b"))
    assert loaded(tmp_path, rigid, rest=equality('<weld body1="b" body2="flange"/>'))[0].dof == 1
    hand = body("c", joint("q3"), BALL)
    tied = equality('<weld body1="a" body2="b"/>')
    assert loaded(tmp_path, ARM, hand, rest=tied, fix={"q2": 0})[0].joint_names == ["q1", "q3"]


def test_a_floating_robot_says_what_can_be_loaded(tmp_path):
    trunk = body("trunk", "<freejoint/>", BALL, body("leg", joint("hip"), BALL))
    with pytest.raises(RobotFileError, match=r":3: body trunk: moves freely: .* root='trunk'"):
        loaded(tmp_path, trunk)
    assert loaded(tmp_path, trunk, root="trunk")[0].joint_names == ["hip"]


def test_a_ball_is_refused_unless_it_is_cut(tmp_path):
    arm = body("a", joint("q1"), BALL, body("b", joint("wrist", kind="ball"), BALL))
    with pytest.raises(RobotFileError, match="body b: turns about three axes at once"):
        loaded(tmp_path, arm)
    assert loaded(tmp_path, arm, tip="a")[0].joint_names == ["q1"]


def test_an_object_that_is_held_is_no_object(tmp_path):
    cube = body("cube", "<freejoint/>", BALL)
    with pytest.raises(RobotFileError, match="it closes a loop, of b and cube"):
        loaded(tmp_path, ARM, cube, rest=equality('<weld body1="b" body2="cube"/>'))
    arm, _ = loaded(tmp_path, ARM, cube)
    assert "objects that move freely: cube" in str(arm.model_summary())
    with pytest.raises(RobotFileError, match="body cube: moves freely"):
        loaded(tmp_path, cube)


def test_what_is_deformable_is_refused_unless_it_is_cut(tmp_path):
    rope = (
        '<flexcomp name="rope" type="grid" count="4 1 1" spacing="0.2 0.2 0.2" dim="1" mass="1"'
        ' radius="0.01"><edge equality="true"/></flexcomp>'
    )
    with pytest.raises(RobotFileError, match=r"flex rope: is deformable"):
        loaded(tmp_path, ARM, rope)
    assert loaded(tmp_path, ARM, rope, root="a")[0].joint_names == ["q2"]


@pytest.mark.skipif(not IS_4, reason="MuJoCo 4 brought them")
@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('stiffness="1 2 0"', "its spring gets stiffer"),
        ('damping="1 0 1"', "its damping grows with speed"),
        ('stiffness="1" springyield="2"', "its spring yields"),
    ],
)
def test_springs_and_dampers_that_are_no_lines(tmp_path, more, message):
    with pytest.raises(RobotFileError, match=f"joint q1: {message}"):
        loaded(tmp_path, body("a", joint("q1", more), BALL))


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<bod/>", ":3: MuJoCo: Schema violation: unrecognized element; Element 'bod'"),
        (body("a", joint("q1")), ":3: MuJoCo: mass and inertia of moving bodies must be larger"),
        (body("a", joint("q1"), inertial(-1)), ":3: MuJoCo: mass and inertia of moving bodies"),
        (body("a", joint("q1"), joint("q1"), BALL), ":4: MuJoCo: repeated name 'q1' in joint"),
        (body("a", joint("q1", 'axis="0 0 0"'), BALL), "MuJoCo: axis too small in joint"),
        (body("a", joint("q1", kind="fixed"), BALL), "MuJoCo: invalid keyword: 'fixed'"),
        (body("a", joint("q1"), BALL, more='pos="1e400 0 0"'), "MuJoCo: number is too large"),
        (body("a", joint("q1"), BALL, more='pos="nan 0 0"'), "holds NaN, which is no number"),
        (body("a", joint("q1"), inertial("1e305")), "expected 0 or numbers within"),
        ('<include file="none.xml"/>', "MuJoCo: Error opening file .*none.xml'"),
        ("", "robot has no joint that moves"),
    ],
)
def test_errors_of_mujoco_are_told_with_the_file(tmp_path, inside, message):
    with pytest.raises(ValueError, match=message):
        loaded(tmp_path, inside)
    assert [x.name for x in tmp_path.iterdir()] == ["robot.xml"]


def test_a_shape_that_is_missing_and_gives_an_inertia(tmp_path):
    bodies = body("a", joint("q1"), '<geom type="mesh" mesh="m"/>')
    message = r"Error opening file '.*none\.stl'.* \(the inertia of a is that of their shapes\)"
    with pytest.raises(RobotFileError, match=message):
        loaded(tmp_path, bodies, rest='<asset><mesh name="m" file="none.stl"/></asset>')


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (LAUGHS, r":1: a document type \(<!DOCTYPE"),
        ("<mujoco>", ":1: not XML: no element found"),
        ("<mujocoinclude/>", "found <mujocoinclude>, the root of files that models include"),
        (robot('<replicate count="1000000000"><body/></replicate>'), "repeats elements to 2e"),
        (
            robot('<replicate count="9999"><replicate count="999"><geom/></replicate></replicate>'),
            "repeats elements",
        ),
        (
            robot(ARM, rest='<size nuser_body="1000000000"/>'),
            r"<size nuser_body>: 10000.* too much",
        ),
        (
            robot(ARM, rest='<asset><mesh builtin="supersphere" params="1e6 1 1"/></asset>'),
            "<mesh params>: 1e6 1 1 is too much",
        ),
        ("<mujoco>" + "<a>" * 200, "more than 100 elements in one another"),
    ],
)
def test_hostile_files(tmp_path, text, message):
    with pytest.raises(RobotFileError, match=message):
        mr.load(written(tmp_path, text))


def test_what_is_included_is_looked_through_too(tmp_path):
    written(tmp_path, LAUGHS, "part.xml")
    with pytest.raises(RobotFileError, match=r"part\.xml:1: a document type"):
        loaded(tmp_path, '<include file="part.xml"/>')
    with (tmp_path / "part.xml").open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(RobotFileError, match=r"part\.xml: is larger than 20 MB"):
        loaded(tmp_path, '<include file="part.xml"/>')


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have names on POSIX only")
def test_pipes_and_devices_are_no_files(tmp_path):
    os.mkfifo(tmp_path / "pipe.xml")
    for other in ("pipe.xml", "/dev/zero"):
        with pytest.raises(RobotFileError, match="is a device or a pipe"):
            loaded(tmp_path, f'<include file="{other}"/>')


def test_a_hundred_megabytes(tmp_path):
    path = written(tmp_path, robot(ARM))
    with path.open("ab") as file:
        file.truncate(100_000_000)
    with pytest.raises(RobotFileError, match="is larger than 20 MB"):
        mr.load(path)


def test_without_mujoco_it_is_said_what_to_install(tmp_path, monkeypatch):
    path = written(tmp_path, robot(ARM))
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(RobotFileError, match=r"pip install 'moro-codegen\[mjcf\]'"):
        mr.load(path)


def test_refusing_needs_no_sympy(tmp_path):
    path = written(tmp_path, robot("<bod/>"))
    program = (
        "import sys\nfrom moro.formats.loading import description\n"
        f"try: description({str(path)!r})\nexcept ValueError as e: print(e)\n"
        "print('sympy' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "unrecognized element" in done.stdout
    assert done.stdout.endswith("False\n")


SAMPLE = robot(
    body("a", joint("q1", 'axis="0 1 0" range="-1 1"'), inertial(2, "0 0 1"), more='pos="0 0 1"'),
    body("b", joint("q2", kind="slide"), BALL, '<site name="s" quat="1 0 0 1"/>'),
    rest=equality('<joint joint1="q2" joint2="q1" polycoef="0 1 0 0 0"/>'),
)


@given(slipped(SAMPLE))
@settings(max_examples=100, deadline=None)
@pytest.mark.filterwarnings("ignore::moro.formats.errors.RobotFileWarning")
def test_any_slip_is_read_or_refused(tmp_path_factory, text):
    problems, built = outcome(written(tmp_path_factory.mktemp("mjcf"), text))
    assert bool(problems) != bool(built)
    assert all(len(problem.message) < 400 for problem in problems)


def outcome(path):
    """Problems that a file has, or its links."""
    try:
        return [], read(path).links
    except RobotFileError as error:
        return error.problems, ()
