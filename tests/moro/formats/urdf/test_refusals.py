"""Everything that a URDF can get wrong: file, line, element and attribute are named."""

import pytest
from urdfs import INERTIA, axis, body, joint, link, origin, robot, written

from moro.formats.errors import RobotFileError, RobotFileWarning
from moro.formats.urdf.reader import read

A, B, C = link("a"), link("b"), link("c")
AB = joint("ab", "a", "b")


def refused(tmp_path, *elements):
    with pytest.raises(RobotFileError) as error:
        read(written(tmp_path, robot(*elements)))
    return [
        f"{problem.line}: {problem.field}: {problem.message}" for problem in error.value.problems
    ]


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        (origin("0 0"), "<origin xyz> of joint ab: expected 3 numbers, found `0 0`"),
        (origin("0 0 nan"), "<origin xyz> of joint ab: expected a number, found `nan`"),
        (origin(rpy="0 0 x"), "<origin rpy> of joint ab: expected a number, found `x`"),
        (origin("1e999 0 0"), "<origin xyz> of joint ab: expected 0 or a number within 1e-300..1e300 in size, found `1e999`"),  # noqa: E501
        (origin() * 2, "<origin> of joint ab: is there twice: the first is in line 4"),
        (axis("0 0 0"), "<axis xyz> of joint ab: 0 0 0 is no direction"),
        (axis("0 1"), "<axis xyz> of joint ab: expected 3 numbers, found `0 1`"),
        ("<axis xzy='0 0 1'/>", "<axis xyz> of joint ab: is missing; there is `xzy`"),
        ('<limit lower="1" upper="-1"/>', "<limit> of joint ab: lower must not be above upper: 1 and -1"),  # noqa: E501
        ('<limit lower="x"/>', "<limit lower> of joint ab: expected a number, found `x`"),
        ('<dynamics damping="-1"/>', "<dynamics damping> of joint ab: must not be negative, not -1"),  # noqa: E501
        ('<dynamics friction=""/>', "<dynamics friction> of joint ab: expected a number, found ``"),
        ("<mimic/>", "<mimic joint> of joint ab: is missing"),
        ('<mimic joint="ba"/>', "<mimic joint> of joint ab: there is no joint `ba`; did you mean `ab`?"),  # noqa: E501
        ('<mimic joint="ab"/>', "<mimic joint> of joint ab: follows itself: ab, ab"),
        ('<mimic joint="x" multiplier="y"/>', "<mimic multiplier> of joint ab: expected a number, found `y`"),  # noqa: E501
    ],
)  # fmt: skip
def test_joints(tmp_path, inside, message):
    assert refused(tmp_path, A, B, joint("ab", "a", "b", inside)) == [f"4: {message}"]


@pytest.mark.parametrize(
    ("element", "message"),
    [
        ('<joint type="fixed"/>', "<joint name>: is missing"),
        ('<joint name="" type="fixed"/>', "<joint name>: is empty"),
        ('<joint name="j"><parent link="a"/><child link="b"/></joint>', "<joint type> of joint j: is missing"),  # noqa: E501
        ('<joint name="j" type="fixed"><parent link="a"/></joint>', "<joint> of joint j: there is no <child> in it"),  # noqa: E501
        ('<joint name="j" type="fixed"><parent/><child link="b"/></joint>', "<parent link> of joint j: is missing"),  # noqa: E501
        (joint("j", "a", "b", kind="revolut"), "<joint type> of joint j: no type `revolut`; did you mean `revolute`? (there are revolute, continuous, prismatic, planar, fixed)"),  # noqa: E501
        (joint("j", "a", "x"), "<child link> of joint j: there is no link `x`"),
        (joint("j", "a", "a"), "joint j: parent and child are the same link"),
    ],
)  # fmt: skip
def test_what_a_joint_is(tmp_path, element, message):
    assert f"4: {message}" in refused(tmp_path, A, B, element)


def test_a_floating_base_is_a_matter_of_its_own(tmp_path):
    (message,) = refused(tmp_path, A, B, joint("j", "a", "b", kind="floating"))
    assert message.startswith("4: <joint type> of joint j: a floating base is a matter of its own")


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        (body(-1), "<mass value> of link b: must not be negative, not -1"),
        (body("kg"), "<mass value> of link b: expected a number, found `kg`"),
        (body(inertia=INERTIA.replace('ixx="1"', 'ixx="-1"')), "<inertia ixx> of link b: must not be negative, not -1"),  # noqa: E501
        (body(inertia=INERTIA.replace("ixy", "iyx")), "<inertia ixy> of link b: is missing; there is `iyx`"),  # noqa: E501
        (body(inertia=""), "<inertial> of link b: there is no <inertia> in it"),
        (f"<inertial>{INERTIA}</inertial>", "<inertial> of link b: there is no <mass> in it"),
        (f"<inertial><mass/>{INERTIA}</inertial>", "<mass value> of link b: is missing"),
        (body(xyz="a b c"), "<origin xyz> of link b: expected a number, found `a`"),
        (body() * 2, "<inertial> of link b: is there twice: the first is in line 3"),
    ],
)  # fmt: skip
def test_bodies(tmp_path, inside, message):
    assert refused(tmp_path, A, link("b", inside), AB) == [f"3: {message}"]


@pytest.mark.parametrize(
    ("elements", "messages"),
    [
        ((A, B), ["3: link b: is on no joint, and neither is a (line 2): one root"]),
        ((A, A, B, AB), ["3: <link name>: another link is called `a`, in line 2"]),
        ((A, B, C, AB, joint("ab", "b", "c")), ["6: <joint name>: another joint is called `ab`, in line 5"]),  # noqa: E501
        ((A, B, C, AB, joint("cb", "c", "b")), ["4: link c: is on no joint, and neither is a (line 2): one root", "6: <child link> of joint cb: link b has a parent by joint ab (line 5)"]),  # noqa: E501
        ((A, B, AB, joint("ba", "b", "a")), ["2: link a: carries itself: b, a"]),
        ((A, B, C, joint("bc", "b", "c"), joint("cb", "c", "b")), ["3: link b: carries itself: c, b"]),  # noqa: E501
        ((), ["1: <robot>: there is no <link> in it"]),
        ((A, B, C, joint("p", "a", "b", kind="planar"), joint("p_x", "b", "c")), ["5: joint p: its coordinate p_x is called like the joint in line 6"]),  # noqa: E501
        ((A, B, C, joint("p", "a", "b", kind="planar"), joint("j", "b", "c", '<mimic joint="p"/>')), ["6: <mimic joint> of joint j: p is planar: it has three coordinates, and follows none"]),  # noqa: E501
        (
            (A, B, C, joint("j", "a", "b", '<mimic joint="k"/>'), joint("k", "b", "c", '<mimic joint="j"/>')),  # noqa: E501
            ["5: <mimic joint> of joint j: follows itself: j, k, j", "6: <mimic joint> of joint k: follows itself: k, j, k"],  # noqa: E501
        ),
    ],
)  # fmt: skip
def test_trees(tmp_path, elements, messages):
    assert refused(tmp_path, *elements) == messages


def test_all_that_is_wrong_is_said_at_once(tmp_path):
    found = refused(
        tmp_path, A, link("b", body(-1, "0 0")), joint("ab", "a", "bb", origin("x 0 0")), C
    )
    assert [message.split(":")[0] for message in found] == ["3", "3", "3", "4", "4", "5"]


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ((A, link("b", "<inertail/>"), AB), "3: <inertail> of link b: is passed over; did you mean `inertial`"),  # noqa: E501
        ((A, B, joint("ab", "a", "b", "<axes xyz='0 0 1'/>")), "4: <axes> of joint ab: is passed over; did you mean `axis`"),  # noqa: E501
        ((A, B, joint("ab", "a", "b", "<origin xyz='0 0 1' rpi='0 0 1'/>")), "4: <origin rpi> of joint ab: is passed over; did you mean `rpy`"),  # noqa: E501
        ((A, link("b", body(inertia=INERTIA.replace('ixy="0"', 'ixy="5"'))), AB), "3: <inertia> of link b: not physical: a principal moment is negative"),  # noqa: E501
        ((A, link("b", body(inertia=INERTIA.replace('ixx="1"', 'ixx="5"'))), AB), "3: <inertia> of link b: not physical: a principal moment is above the sum"),  # noqa: E501
    ],
)  # fmt: skip
def test_what_was_probably_not_meant(tmp_path, elements, message):
    with pytest.warns(RobotFileWarning) as warned:
        read(written(tmp_path, robot(*elements)))
    assert [f"robot.urdf:{message}" in str(each.message) for each in warned] == [True]


def test_zeros_that_cad_programs_round_are_no_negative_moments(tmp_path):
    inertia = INERTIA.replace('="1"', '="-5.4e-20"')
    read(written(tmp_path, robot(A, link("b", body(0.5, inertia=inertia)), AB)))


def test_many_remarks_are_counted(tmp_path):
    many = [link(f"l{i}", "<inertail/>") for i in range(30)]
    joints = [joint(f"j{i}", "a", f"l{i}") for i in range(30)]
    with pytest.warns(RobotFileWarning) as warned:
        read(written(tmp_path, robot(A, *many, *joints)))
    assert len(warned) == 11
    assert "and 20 more remarks" in str(warned[-1].message)


def test_shapes_and_what_simulators_add_are_passed_over(tmp_path):
    noise = (
        '<visual><geometry><mesh filename="package://x/y.dae"/></geometry></visual>',
        "<collision><geometry><box size='1 1 1'/></geometry></collision>",
    )
    read(
        written(
            tmp_path,
            robot(
                '<material name="x"><color rgba="0 0 0 1"/></material>',
                link("a", "".join(noise)),
                link("b", "".join(noise)),
                joint(
                    "ab", "a", "b", "<safety_controller k_velocity='1'/><calibration rising='0'/>"
                ),
                "<transmission name='t'><joint name='nonsense'/></transmission>",
                "<gazebo reference='a'><mu1>0.2</mu1><gravity>nonsense</gravity></gazebo>",
                "<ros2_control name='x'><joint name='ab'/></ros2_control>",
            ),
        )
    )
