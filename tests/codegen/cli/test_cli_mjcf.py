"""moro-codegen of a MuJoCo model: the whole job; what is wrong with one."""

import json

from command import run
from mjcfs import BALL, body, inertial, joint, robot, written

CRANE = robot(
    body(
        "mast",
        joint("slew", 'axis="0 0 1" damping="0.5" armature="0.1"'),
        inertial(8),
        body("boom", joint("luff/1", 'axis="0 -1 0" frictionloss="2"'), inertial(4, "0.5 0 0")),
        more='pos="0 0 1" euler="1.5708 0 0"',
    ),
    name="crane",
)


def test_the_whole_job(tmp_path):
    path = written(tmp_path, CRANE, "crane.xml")
    done = run(path, "-f", "tau,jacobian@mast", "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for text in (
        "crane: tau(q, qd, qdd)",
        "damping and friction of slew, luff/1",
        "1.5708 0 0 as Rx(pi/2)",
        "verified: 84 states",
    ):
        assert text in done.stdout
    manifest = json.loads((tmp_path / "build/crane/manifest.json").read_text())
    assert manifest["input"]["file"] == "crane.xml"


def test_what_is_refused(tmp_path):
    path = written(tmp_path, robot(body("a", "<freejoint/>", BALL, body("b", joint("q"), BALL))))
    done = run(path, cwd=tmp_path)
    assert done.returncode == 2
    assert f"moro-codegen: error: {path}:3: body a: moves freely" in done.stderr
    assert run(path, "--root", "a", "--no-benchmark", cwd=tmp_path).returncode == 0
