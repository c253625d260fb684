"""What does not go together in a robot file: one message each, with line and field."""

import pytest

import moro as mr
from moro import Robot
from moro.formats.errors import Problem, RobotFileError

ROW = "  - {joint: revolute, a: 0, alpha: 0, d: 0, theta: 0"
EYE = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"
MOMENT = "first_moment: [0, 0, 0]"
LINK = {"joint": "revolute", "axis": "z"}
BODY = "mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]"
PLACED = "  - {joint: revolute, axis: z"


def row(more=""):
    return f"{ROW}{', ' * bool(more)}{more}}}\n"


def turned(theta, more=""):
    return row(more).replace("theta: 0", f"theta: {theta}")


def placed(more="", joint="revolute"):
    return f"{PLACED.replace('revolute', joint)}{', ' * bool(more)}{more}}}\n"


def fixed(more):
    return f"  - {{joint: fixed, {more}}}\n"


@pytest.fixture
def problem(tmp_path):
    def problem(links: str, *top: str) -> Problem:
        path = tmp_path / "arm.yaml"
        path.write_text("".join(f"{line}\n" for line in top) + "links:\n" + links)
        with pytest.raises(RobotFileError) as caught:
            mr.load(path)
        (only,) = caught.value.problems
        return only

    return problem


@pytest.mark.parametrize(
    ("links", "line", "field", "said"),
    [
        # rows and placements
        (placed("a: 0"), 2, "a", "is of a row of DH parameters"),
        (placed("d: 1"), 2, "d", "this link is placed by `xyz`, `rpy` or `R`"),
        (placed("theta: 1", "prismatic"), 2, "theta", "this link is placed by"),
        (placed(f"rpy: [0, 0, 0], R: {EYE}"), 2, "R", "by `rpy` already"),
        (placed("xyz: [0, 0, 1], placement: [{xyz: [0, 0, 1]}]"), 2, "xyz", "into `placement`"),
        (placed("placement: [{xyz: [0, 0, 1], axis: x}]"), 2, "placement[1].axis", "unknown field"),
        (placed("R: [[1, 0, 0], [0, 2, 0], [0, 0, 1]]"), 2, "R", "must be a rotation matrix"),
        (placed("R: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]"), 2, "R", "this one reflects"),
        (placed("R: [[1, 0], [0, 1]]"), 2, "R", "expected 3 rows of 3"),
        (placed("R: [1, 2, 3]"), 2, "R", "expected 3 rows of 3"),
        (placed().replace("z", "[0, 0, 0]"), 2, "axis", "must be a direction, not the zero vector"),
        (placed().replace("z", "w"), 2, "axis", "found `w`; expected [x, y, z], or `x`"),
        (placed("rpy: [0, 0]"), 2, "rpy", "expected [roll, pitch, yaw] in rad"),
        (placed("xyz: 3"), 2, "xyz", "expected [x, y, z] in m"),
        # helical and fixed joints
        (placed(joint="helical"), 2, "pitch", "missing; expected how far it slides"),
        (placed("pitch: 0", joint="helical"), 2, "pitch", "must not be 0"),
        (placed("pitch: 1"), 2, "pitch", "is of a helical joint"),
        (row() + fixed("xyz: [0, 0, 1], limits: [0, 1]"), 3, "limits", "this one is fixed"),
        (row() + fixed("xyz: [0, 0, 1], axis: x"), 3, "axis", "this one is fixed"),
        (row() + fixed("a: 0, alpha: 0, d: 0"), 3, "theta", "missing"),
        (row() + fixed("a: 0, alpha: 0, d: q1, theta: 0"), 3, "d", "must be constant, not q1"),
        (fixed("xyz: [0, 0, 1]"), 1, "", "no link moves"),
        # bodies
        (row(BODY) + placed("mass: 1, com: [0, 0, 0]"), 3, "inertia", "for all links or for none"),
        (row(BODY) + placed("bodies: [{mass: 1, inertia: [1, 1, 1]}]"), 3, "bodies[1].com", "miss"),
        (row(f"mass: 1, {MOMENT}, inertia: [1, 1, 1]"), 2, "inertia_about", "`origin`"),
        (row(f"{BODY}, {MOMENT}, inertia_about: origin"), 2, "first_moment", "times"),
        (row("bodies: 3"), 2, "bodies", "found `3`; expected a list of mappings"),
        (row(BODY + ", inertia_about: base"), 2, "inertia_about", "expected `com` or `origin`"),
        # drives
        (row("motor_inertia: 1"), 2, "gear_ratio", "missing; expected the turns of the motor"),
        (row("gear_ratio: 1"), 2, "gear_ratio", "counts for `motor_inertia`"),
        (row("gear_ratio: 0, motor_inertia: 1"), 2, "gear_ratio", "must not be 0"),
        (row("gear_ratio: -5, motor_inertia: 1"), 2, "gear_ratio", "must not be negative"),
        (row("friction: {viscous: 1, side: motor}"), 2, "gear_ratio", "missing"),
        (row("friction: {viscous: 1, side: left}"), 2, "friction.side", "expected `link` or `mo"),
        (
            row("motor_inertia: 1, rotor_inertia: 1, gear_ratio: 2"),
            2,
            "motor_inertia",
            "is `rotor_inertia`, before the gear",
        ),
        (row("rest: 1"), 2, "rest", "expected its `stiffness` too"),
        (row("friction: {static: 1}"), 2, "friction.static", "needs `stribeck_velocity` too"),
        (row("friction: {smooth: 0}"), 2, "friction.smooth", "must not be 0"),
        # names
        (row("name: 3"), 2, "name", "`3` is a number, which joints have in their order"),
        (row("name: ''"), 2, "name", "expected a name"),
        (row("name: a") + row("name: a"), 3, "name", "`a` is what links[1] is called"),
        (row("frames: {a: {}}") + row("name: a"), 3, "name", "is what a frame of links[1] is"),
        (row("name: arm") + row("parent: amr"), 3, "parent", "no link above is called `amr`; did"),
        (row("parent: 2") + row(), 2, "parent", "no link above is called `2`"),
        # joint variables
        (turned("q1*q1"), 2, "theta", "must be a sum of joint variables"),
        (row().replace("d: 0", "d: q1"), 2, "d", "must be constant, not q1"),
        (row() + turned("q3"), 3, "theta", "there can be `q1` to `q2`"),
        (turned("q2") + row(), 2, "theta", "moved by q2, and no joint by q1"),
        (
            turned("q1 + q2") + turned("q1 + q2"),
            2,
            "theta",
            "q1 and q2 move joints only together",
        ),
        (
            row() + turned("-q1", "rotor_inertia: 1"),
            3,
            "rotor_inertia",
            "is of a joint that q1 moves",
        ),
    ],
)  # fmt: skip
def test_what_does_not_go_together(problem, links, line, field, said):
    found = problem(links)
    assert found.line == line
    where = f"links[{line - 1}].{field}" if field else "links"
    assert found.field == where
    assert said in found.message


@pytest.mark.parametrize(
    ("top", "field", "said"),
    [
        ("tool: 3", "tool", "found `3`; expected a mapping: xyz, rpy, R, placement, link"),
        ("tool: {link: amr}", "tool.link", "no link is called `amr`; did you mean `arm`?"),
        ("tip: hand", "tip", "no link is called `hand`"),
        ("base: {xyz: [1, 2]}", "base.xyz", "found a list of 2 values"),
        ("base: {axis: z}", "base.axis", "unknown field"),
        ("coordinates: {q2: {rotor_inertia: 1}}", "coordinates.q2", "moves no joint"),
        ("coordinates: {x: {rotor_inertia: 1}}", "coordinates.x", "`x` is no joint variable"),
        ("coordinates: {q1: {rotor_inertia: 1}}", "coordinates.q1.rotor_inertia", "given twice"),
        ("coordinates: {q1: {rest: 1}}", "coordinates.q1.rest", "expected its `stiffness` too"),
    ],
)
def test_beside_the_links(problem, top, field, said):
    found = problem(row("name: arm, rotor_inertia: 2"), top)
    assert (found.line, found.field) == (1, field)
    assert said in found.message


def test_names_of_the_base_and_the_tool(problem):
    assert "is what the base is called" in problem(row("name: base"), "base: {}").message
    assert "is what the tool is called" in problem(row("name: tool"), "tool: {}").message


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({}, "links: missing; expected a list with one entry"),
        ({"links": []}, "links: no links"),
        ({"links": [LINK | {"mas": 1}]}, "links[1].mas: unknown field"),
        ({"links": [LINK | {"mass": True}]}, "links[1].mass: found `True`"),
        ({"links": [LINK | {"mass": 2j}]}, "links[1].mass: must be real"),
        ({"links": [{"joint": "revolut", "axis": "z"}]}, "links[1].joint: found `revolut`"),
    ],
)  # fmt: skip
def test_dictionaries_are_refused_in_the_same_words(fields, said):
    with pytest.raises(RobotFileError) as caught:
        Robot.of(fields)
    assert said in str(caught.value)


def test_functions_that_are_no_joint_variables():
    from moro.abc import q1, t

    for x in (q1.diff(t), q1.func(2 * t), q1.func.__class__("phi")(t)):
        link = {"joint": "revolute", "axis": "z", "theta": x}
        with pytest.raises(RobotFileError, match=r"links\[1\].theta: "):
            Robot.of({"links": [link]})


def test_what_is_probably_not_meant():
    link = {"joint": "revolute", "axis": "z", "rpy": [1.5708, 0, 0]}
    with pytest.warns(UserWarning, match=r"^links\[1\].rpy: 1.5708 is close to pi/2"):
        Robot.of({"links": [link]})
    link = {"joint": "revolute", "axis": "z", "xyz": [300, 0, 0]}
    with pytest.warns(UserWarning, match=r"^links\[1\].xyz: 300 m is long"):
        Robot.of({"links": [link]})
