"""Robot files that are legal and probably wrong."""

from __future__ import annotations

import warnings

import pytest

from moro import Robot, load
from moro.abc import q1, q2
from moro.formats.loading import RobotFileWarning, packaged

LINK = {
    "joint": "revolute",
    "a": "0.5",
    "alpha": "pi/2",
    "d": "0",
    "theta": "0",
    "mass": "1",
    "com": "[0, 0, 0.1]",
    "inertia": "[1, 1, 1]",
    "limits": "[-pi, pi]",
}


@pytest.fixture
def read_with(tmp_path):
    def read_with(head: str = "", **changes: str) -> list[str]:
        fields = "\n    ".join(f"{key}: {value}" for key, value in {**LINK, **changes}.items())
        path = tmp_path / "arm.yaml"
        path.write_text(f"{head}links:\n  - {fields}\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            assert load(path).dof == 1
        assert all(each.category is RobotFileWarning for each in caught)
        assert all(each.filename == __file__ for each in caught)
        return [str(each.message).replace(f"{path}:", "") for each in caught]

    return read_with


def test_a_plain_arm_gives_no_warning(read_with):
    assert read_with() == []


@pytest.mark.parametrize("inertia", ["[1, 1, 2]", "[0, 0, 0]", "[0.33333, 0.33333, 0.66667]"])
def test_inertias_of_rods_plates_points_and_rounded_ones_are_physical(read_with, inertia):
    assert read_with(inertia=inertia) == []


@pytest.mark.parametrize(
    ("inertia", "reason"),
    [
        ("[0, 0.35, 0]", "a principal moment is above the sum of the other two (0, 0, 0.35)"),
        ("[1, 1, 2.01]", "a principal moment is above the sum of the other two (1, 1, 2.01)"),
        ("[1, 1, -0.5]", "a principal moment is negative (-0.5, 1, 1)"),
        ("[1, 1, 1, 2, 0, 0]", "a principal moment is negative (-1, 1, 3)"),
        ("[[2, 0, 1], [0, 2, 0], [1, 0, 0]]", "a principal moment is negative (-0.414214, 2, 2.4"),
    ],
)
def test_an_inertia_that_no_body_has(read_with, inertia, reason):
    (message,) = read_with(inertia=inertia)
    assert message.startswith(f"9: links[1].inertia: not physical: {reason}")


def test_inertias_with_parameters_are_not_judged(read_with):
    assert read_with("parameters: {x: 9}\n", inertia="[x, 1, 1]") == []


@pytest.mark.parametrize(
    ("alpha", "suggested"),
    [
        ("1.5707963", "pi/2"),
        ("1.5708", "pi/2"),
        ("1.57", "pi/2"),
        ("-1.571", "-pi/2"),
        ("3.14159", "pi"),
        ("-3.14", "-pi"),
        ("4.712389", "3*pi/2"),
        ("6.2832", "2*pi"),
        ("6.123e-17", "0"),
    ],
)
def test_quarter_turns_typed_as_decimals(read_with, alpha, suggested):
    (message,) = read_with(alpha=alpha)
    assert message.startswith("4: links[1].alpha: ")
    assert f"write `{suggested}`: exact zeros make short equations" in message


@pytest.mark.parametrize("alpha", ["0", "1.58", "1.5", "0.01", "-3", "3", "pi/3", "5*pi/2"])
def test_other_angles_pass(read_with, alpha):
    assert read_with(alpha=alpha) == []


def test_degrees(read_with):
    (message,) = read_with(theta="-90")
    assert message == (
        "6: links[1].theta: -90 rad is more than a turn; angles are in radians,"
        " -90 degrees are `-pi/2`"
    )
    (message,) = read_with(limits="[-180, 180]")
    assert message.startswith("10: links[1].limits: is more than two turns; angles are in radians")
    assert read_with(joint="prismatic", limits="[0, 50]") == []


def test_millimetres(read_with):
    (message,) = read_with(a="431.8")
    assert message == "3: links[1].a: 431.8 m is long for a link; lengths are in m"
    (message,) = read_with(com="[0, 0, 120]")
    assert message.startswith("8: links[1].com: is far from the link")


def test_sliding_limits_in_millimetres(read_with):
    (message,) = read_with(joint="prismatic", limits="[0, 1270]")
    assert message == "10: links[1].limits: is far for a joint to slide; lengths are in m"


@pytest.mark.parametrize(
    ("inertia", "unit"),
    [
        ("[17085955.96, 16299848.40, 6028717.92]", "g mm^2"),
        ("[8000, 8000, 9000]", "kg mm^2"),
        ("[200, 200, 200]", "kg cm^2"),
        ("[100000, 100000, 100000]", "g cm^2"),
    ],
)
def test_inertias_in_other_units(read_with, inertia, unit):
    (message,) = read_with(inertia=inertia)
    assert message.startswith("9: links[1].inertia: has a radius of gyration sqrt(I/m) of ")
    assert message.endswith(
        f"an arm that is 0.6 m long; inertias are in kg m^2, and this looks like {unit}"
    )


def test_masses_in_grams(read_with):
    (message,) = read_with(mass="1200", inertia="[0.004, 0.004, 0.004]")
    assert message.startswith("7: links[1].mass: the links weigh 1200 kg in all, much for an arm")
    assert message.endswith("masses are in kg, and these look like g")


@pytest.mark.parametrize(
    ("gravity", "unit"),
    [("[0, 0, -9810]", "mm/s^2"), ("[0, 981, 0]", "cm/s^2"), ("[0, 0, 32.17]", "ft/s^2")],
)
def test_gravity_in_other_units(read_with, gravity, unit):
    (message,) = read_with(f"gravity: {gravity}\n")
    assert message.startswith("1: gravity: ")
    assert f"is what gravity is in {unit}; it is given in m/s^2, 9.81" in message


@pytest.mark.parametrize("gravity", ["[0, 0, 1.62]", "[0, 0, 24.8]", "[0, 0, 0]"])
def test_gravity_of_other_places_passes(read_with, gravity):
    assert read_with(f"gravity: {gravity}\n") == []


@pytest.mark.parametrize(
    ("inertia", "order"),
    [
        ("[1, 0.1, 0.1, 1, 0.1, 1]", "Ixx, Ixy, Ixz, Iyy, Iyz, Izz"),
        ("[3, 2, 1.2, 0, 1.2, 0]", "Ixx, Iyy, Izz, Ixy, Iyz, Ixz"),
    ],
)
def test_six_values_in_another_order(read_with, inertia, order):
    (message,) = read_with(inertia=inertia)
    assert message.startswith("9: links[1].inertia: not physical: ")
    assert f"would be physical as {order}: name them, {{xx: ..., yy: ...}}" in message


def test_python_gets_the_same_warnings():
    """Each once, when it comes up."""

    def warnings_of(action):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            action()
        assert all(each.filename == __file__ for each in caught)
        return [str(each.message) for each in caught]

    robot = Robot((0.4, 0, 0, q1), (0.3, 0, 0, q2))
    (said,) = warnings_of(lambda: Robot((0.4, 90, 0, q1)))
    assert said.startswith("alpha of row 1: 90 rad is more than a turn; angles are in radians")
    for name, values, start in (
        ("joint_limits", [(-90, 90), (-1, 1)], "limits of joint 1: is more than two turns"),
        ("gravity", [0, 0, -9810], "gravity: 9810 is what gravity is in mm/s^2"),
        ("masses", [1200, 900], "masses: the links weigh 2100 kg in all"),
        ("cm_positions", [[0, 0, 0], [-150, 0, 0]], "cm_positions of link 2: is far from"),
        ("inertia_tensors", [[1, 1, 3], [1, 1, 1]], "inertia tensor of link 1: not physical"),
    ):
        (said,) = warnings_of(lambda name=name, values=values: setattr(robot, name, values))
        assert said.startswith(start)
    assert warnings_of(lambda: robot.with_parameters({})) == []


@pytest.mark.parametrize(
    ("default", "value", "at"),
    [
        ("0", "1/x", "x = 0"),
        ("1", "y/(x - 1)", "x = 1"),
        ("0", "log(x)", "x = 0"),
        ("-4", "2 + sqrt(x)", "x = -4"),
        ("2", "asin(x)", "x = 2"),
        ("1", "1/x", None),
        ("null", "1/x", None),
    ],
)
def test_defaults_at_which_a_value_is_no_number(read_with, default, value, at):
    head = f"parameters: {{x: {default}, y: null}}\ngravity: [0, 0, -y]\n"
    for field in ({"a": value}, {"mass": value}, {"com": f"[0, {value}, 0]"}):
        messages = [x for x in read_with(head, **field) if "not a real, finite number" in x]
        (name,) = field
        assert len(messages) == (at is not None)
        for message in messages:
            assert f": links[1].{name}: `" in message
            assert message.endswith(f"is not a real, finite number at the default {at}")


def test_parameters_that_nothing_uses(read_with):
    messages = read_with("parameters: {x: 1, y: 2, z: 3}\ngravity: [0, 0, -z]\n", mass="2*y")
    assert messages == ["1: parameters.x: this parameter is not used in the file"]


def test_several_warnings(read_with):
    assert len(read_with(alpha="90", theta="1.57", inertia="[0, 0, 1]")) == 3


@pytest.mark.parametrize("name", packaged())
def test_packaged_arms_are_known_data(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load(name)
