"""moro-codegen of a URDF: the whole job, with names; the part that is meant."""

import json

import pytest
from command import run
from urdfs import axis, body, joint, link, origin, robot, written

import moro as mr

HAND = robot(
    link("base", body(9)),
    joint("turn*/", "base", "turret", axis("0 0 1") + '<dynamics damping="0.1" friction="0.2"/>'),
    link("turret", body(3, "0.1 0 0")),
    joint("lift", "turret", "arm", origin("0 0 0.3", "1.5708 0 0") + axis("0 1 0")),
    link("arm", body(2, "0.2 0 0")),
    joint("grip", "arm", "left", origin("0.4 0 0") + axis("0 1 0"), "prismatic"),
    link("left", body(1)),
    joint("follow", "arm", "right", axis("0 -1 0") + '<mimic joint="grip"/>', "prismatic"),
    link("right", body(1)),
    name="hand over",
)


@pytest.fixture
def path(tmp_path):
    return written(tmp_path, HAND, "hand.urdf")


def test_the_whole_job(path, tmp_path):
    functions = "tau,forward_dynamics,jacobian,jacobian@arm"
    done = run(path, "-f", functions, "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for row in (
        "hand_over: tau(q, qd, qdd), forward_dynamics(q, qd, tau)",
        "joints        ",
        "base           ",
        "base stands still, with its 9 kg",
        "damping and friction of turn*/",
        "1.5708 as pi/2; as_written=True takes them as they are",
        "verified: 84 states",
    ):
        assert row in done.stdout
    header = (tmp_path / "build/hand_over/hand_over.h").read_text()
    assert " *   joint 1, turn* /: revolute (rad, torque in N m)\n" in header
    assert " *   joint 3, grip: prismatic (m, force in N)\n" in header
    manifest = json.loads((tmp_path / "build/hand_over/manifest.json").read_text())
    assert manifest["joint_names"] == ["turn*/", "lift", "grip"]
    assert manifest["input"]["file"] == "hand.urdf"
    assert manifest["input"]["read"]["friction"] == "damping and friction of turn*/"


def test_the_part_that_is_meant(path, tmp_path):
    part = ("--root", "base", "--tip", "left", "--fix", "grip=0.01", "--fix", "lift=-pi/4")
    done = run(path, *part, "--as-written", "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    manifest = json.loads((tmp_path / "build/hand_over/manifest.json").read_text())
    assert manifest["joint_names"] == ["turn*/"]
    given = {key: manifest["input"][key] for key in ("root", "tip", "fix", "as_written")}
    assert given == {
        "root": "base",
        "tip": ["left"],
        "fix": {"grip": "1/100", "lift": "-pi/4"},
        "as_written": True,
    }
    assert "decimals" not in manifest["input"]["read"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tip", "lft"], 'tip: no link is called lft; did you mean "left"'),
        (["--fix", "grp=0"], 'no joint of hand_over that moves is called grp; did you mean "grip"'),
        (["--fix", "grip"], "'grip' is no joint=value"),
        (["--fix", "grip=x"], "'grip=x': "),
        (["--fix", "grip=__import__('os')"], "is not understood"),
    ],
)
def test_what_cannot_be_meant(path, tmp_path, arguments, words):
    done = run(path, *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "build").exists()


def test_a_broken_file(tmp_path):
    broken = written(tmp_path, HAND.replace('value="3"', 'value="-3"').replace("0.1 0 0", "x"))
    done = run(broken, cwd=tmp_path)
    assert done.returncode == 2
    for line in (
        "robot.urdf:4: <origin xyz> of link turret: expected 3 numbers, found `x`",
        "robot.urdf:4: <mass value> of link turret: must not be negative, not -3",
    ):
        assert line in done.stderr


def test_a_robot_is_saved(path, tmp_path):
    done = run(path, "--tip", "left", "--save", "hand.yaml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "hand.yaml: written\n")
    whole, saved = mr.load(path, tip="left"), mr.load(tmp_path / "hand.yaml")
    assert saved.model() == whole.model()
    assert not (tmp_path / "build").exists()
    done = run(path, "--save", "no/hand.yaml", cwd=tmp_path)
    assert done.returncode == 2
    assert "No such file or directory" in done.stderr
