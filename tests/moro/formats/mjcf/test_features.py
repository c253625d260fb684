"""What an MJCF says, as a text would write it down: values by hand."""

import pytest
import sympy as sp
from mjcfs import BALL, IS_4, body, inertial, joint, loaded, robot, written

import moro as mr
from moro.abc import t
from moro.formats.errors import RobotFileWarning

R, pi = sp.Rational, sp.pi
g = R("9.81")


def drive(model, j=0):
    return model.coordinates[j].drive


def test_a_pendulum_with_all_that_acts_at_its_joint(tmp_path):
    swing = (
        'axis="0 1 0" armature="0.5" damping="0.2" frictionloss="0.3" stiffness="4" springref="0.1"'
    )
    arm, _ = loaded(
        tmp_path, body("rod", joint("swing", swing), inertial(2, "0 0 -0.5")), name="pendulum"
    )
    q = arm.q(1)
    qd, qdd = q.diff(t), q.diff(t, 2)
    expected = (
        (1 + 2 * R(1, 4) + R(1, 2)) * qdd
        + g * sp.sin(q)
        + qd / 5
        + R(3, 10) * sp.sign(qd)
        + 4 * (q - R(1, 10))
    )
    assert sp.simplify(sp.nsimplify(arm.dynamic_model()[0].lhs - expected, rational=True)) == 0
    assert arm.name == "pendulum"
    said = str(arm.model_summary())
    for text in (
        "damping and friction of swing",
        "inertia of what turns with swing",
        "springs of swing",
    ):
        assert text in said


def test_a_joint_at_its_reference_leaves_its_body_where_it_is_placed(tmp_path):
    turn = joint("turn", 'axis="0 0 1" ref="0.4" range="0 1" stiffness="1" springref="0.7"')
    slide = joint("slide", 'axis="1 0 0" ref="0.3"', "slide")
    arm, model = loaded(tmp_path, body("a", turn, slide, BALL, more='pos="1 2 3"'))
    assert arm.joint_limits[0] == (0, 1)
    at = dict(zip(arm.qs, (R(2, 5), R(3, 10)), strict=True))
    assert sp.nsimplify(arm.T_i0("a").subs(at)[:3, 3].T, rational=True) == sp.Matrix([[1, 2, 3]])
    assert drive(model).rest == R(7, 10)


def test_a_joint_turns_about_its_anchor(tmp_path):
    arm, _ = loaded(tmp_path, body("a", joint("turn", 'axis="0 0 1" pos="1 0 0"'), BALL))
    q = arm.q(1)
    assert sp.expand(arm.T_i0("a")[0, 3] - (1 - sp.cos(q))) == 0
    assert sp.expand(arm.T_i0("a")[1, 3] + sp.sin(q)) == 0


def test_several_joints_on_one_body(tmp_path):
    arm, model = loaded(
        tmp_path, body("hip", joint("yaw", 'axis="0 0 1"'), joint("pitch", 'axis="0 1 0"'), BALL)
    )
    assert arm.joint_names == ["yaw", "pitch"]
    assert [x.mass for x in model.bodies] == [0, 1]
    z, x = sp.Matrix([0, 0, 1]), sp.Matrix([1, 0, 0])
    yaw, pitch = (sp.rot_axis3(-arm.q(1)), sp.rot_axis2(-arm.q(2)))
    for v in (z, x):
        assert sp.simplify(arm.T_i0("hip")[:3, :3] * v - yaw * pitch * v) == sp.zeros(3, 1)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ('quat="0.707107 0.707107 0 0"', sp.rot_axis1(-pi / 2)),
        ('quat="0.9239 0 0 0.3827"', sp.rot_axis3(-pi / 4)),
        ('euler="0 1.5708 0"', sp.rot_axis2(-pi / 2)),
        ('euler="1.5708 0 0.5236"', sp.rot_axis1(-pi / 2) * sp.rot_axis3(-pi / 6)),
        ('axisangle="0 0 2 -0.7854"', sp.rot_axis3(pi / 4)),
        ('xyaxes="0 1 0 -1 0 0"', sp.rot_axis3(-pi / 2)),
        ('zaxis="0 1 0"', sp.rot_axis1(pi / 2)),
        ('quat="0.5 0.5 0.5 0.5"', sp.Matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]])),
        ('quat="0.8 0 0.6 0"', sp.Matrix([[7, 0, 24], [0, 25, 0], [-24, 0, 7]]) / 25),
        ('quat="1 1 1 0"', sp.Matrix([[1, 2, 2], [2, 1, -2], [-2, 2, -1]]) / 3),
    ],
)  # fmt: skip
def test_rotations(tmp_path, given, expected):
    fixed = body("flange", BALL, joint("turn"), body("tool", more=given))
    _, model = loaded(tmp_path, fixed)
    tool = next(x for x in model.frames if x.name == "tool")
    found = sp.Matrix(tool.placement.R)
    assert (found - expected).applyfunc(sp.simplify).applyfunc(
        lambda x: 0 if abs(x) < 1e-15 else x
    ) == sp.zeros(3)


def test_what_is_read_as_an_angle_is_said_unless_it_is_taken_as_it_is(tmp_path):
    bodies = body("a", joint("q1", 'axis="0 0.7071 0.7071"'), BALL, more='quat="0.7071 0 0 0.7072"')
    meant, model = loaded(tmp_path, bodies)
    assert "0.7071 0 0 0.7072 as Rz(pi/2)" in str(meant.model_summary())
    root = sp.sqrt(2) / 2  # the axis of the joint, in the frame that is turned by a quarter
    assert [row[2] for row in model.joints[0].placement.R] == [-root, 0, root]
    written_, other = loaded(tmp_path, bodies, as_written=True)
    assert "decimals" not in str(written_.model_summary())
    assert other.joints[0].placement.R != model.joints[0].placement.R


def test_degrees_are_exact(tmp_path):
    hinge = joint("turn", 'axis="0 0 1" range="-90 45"')
    arm, model = loaded(tmp_path, body("a", hinge, BALL, more='euler="90 0 30"'), radian=False)
    assert sp.Matrix(model.joints[0].placement.R) == sp.rot_axis1(-pi / 2)
    assert model.joints[0].offset == pi / 6
    assert [float(x) for x in arm.joint_limits[0]] == [-float(pi / 2), float(pi / 4)]
    assert "decimals" not in str(arm.model_summary())


def test_inertias_as_the_file_gives_them(tmp_path):
    full = 'fullinertia="1 1.1 1.2 0.01 0.02 0.03"'
    turned = 'diaginertia="1 2 2.5" quat="0.707107 0 0 0.707107"'
    arm, _ = loaded(
        tmp_path,
        body("a", joint("q1"), inertial(1.3, "0.1 0 0", full)),
        body("b", joint("q2"), inertial(2, "0 0 0.1", turned)),
    )
    one, two = (sp.nsimplify(I, rational=True) for I in arm.inertia_tensors)
    assert one == sp.Matrix([[100, 1, 2], [1, 110, 3], [2, 3, 120]]) / 100
    assert two == sp.diag(2, 1, R(5, 2))
    assert arm.masses == [R("1.3"), 2]
    assert sp.nsimplify(arm.cm_positions[0], rational=True) == sp.Matrix([R(1, 10), 0, 0])


def test_inertias_of_shapes_are_those_that_mujoco_computes(tmp_path):
    box = '<geom type="box" size="0.1 0.2 0.3" mass="3" pos="0 0 0.5"/>'
    sphere = body("b", joint("q2"), '<geom type="sphere" size="0.5" mass="2"/>')
    arm, _ = loaded(tmp_path, body("a", joint("q1"), box, sphere))
    box = sp.diag(R(4 + 9, 100), R(1 + 9, 100), R(1 + 4, 100))  # m (b^2 + c^2)/3
    assert sp.nsimplify(arm.inertia_tensors[0], rational=True, tolerance=1e-14) == box
    assert sp.nsimplify(arm.inertia_tensors[1], rational=True, tolerance=1e-14) == sp.eye(3) / 5
    assert "computed by MuJoCo from shapes: a, b" in str(arm.model_summary())


def test_bodies_and_sites_are_frames(tmp_path):
    sites = '<site name="tip" pos="0 0 1"/><site name="a" pos="1 0 0"/><site pos="2 0 0"/>'
    arm, _ = loaded(tmp_path, body("a", joint("q1"), BALL, sites))
    assert {*arm.frames} == {"world", "a", "tip", "a_site"}
    assert arm.T_i0("tip")[2, 3] == 1


def test_what_has_no_name_gets_one(tmp_path):
    text = "<body><joint/><joint type='slide'/>" + BALL + "</body>"
    arm, _ = loaded(tmp_path, text, text.replace("<body>", "<body name='body_1_joint'>"))
    assert arm.joint_names == [
        *("body_1_joint", "body_1_joint_2", "body_1_joint_joint", "body_1_joint_joint_2"),
    ]
    unnamed = robot(body("a", joint("q"), BALL)).replace(' model="robot"', "")
    assert mr.load(written(tmp_path, unnamed, "my arm.xml")).name == "my_arm"


PAIR = (
    body("a", joint("lead", 'ref="0.1" range="-1 1"'), BALL),
    body("b", joint("follow", 'ref="0.2" damping="1"'), BALL),
)


@pytest.mark.parametrize(
    ("equality", "ratio", "offset"),
    [
        ('<joint joint1="follow" joint2="lead"/>', 1, R(-1, 10)),
        ('<joint joint1="follow" joint2="lead" polycoef="0.5 -2 0 0 0"/>', -2, R(7, 10)),
    ],
)
def test_joints_that_follow_others(tmp_path, equality, ratio, offset):
    arm, model = loaded(tmp_path, *PAIR, rest=f"<equality>{equality}</equality>")
    assert arm.joint_names == ["lead"]
    assert arm.joint_limits == [(-1, 1)]
    assert model.joints[1].terms == ((0, ratio),)
    assert model.joints[1].offset == offset
    assert drive(model).viscous == ratio**2
    assert model.joints[0].offset == R(-1, 10)


def test_joints_that_follow_followers_or_stand_still(tmp_path):
    third = body("c", joint("third"), BALL)
    chain = (
        '<equality><joint joint1="third" joint2="follow" polycoef="1 3 0 0 0"/>'
        '<joint joint1="follow" joint2="lead" polycoef="0 -1 0 0 0"/></equality>'
    )
    _, model = loaded(tmp_path, *PAIR, third, rest=chain)
    assert model.joints[2].terms == ((0, -3),)
    assert model.joints[2].offset == 1 + R(3, 10)
    still = '<equality><joint joint1="follow" polycoef="0.25 0 0 0 0"/></equality>'
    arm, model = loaded(tmp_path, *PAIR, rest=still)
    assert arm.joint_names == ["lead"]
    b = next(x for x in model.frames if x.name == "b")
    assert abs(float(b.placement.R[1][0]) - float(sp.sin(R(1, 4)))) < 1e-15


def test_a_tendon_of_a_length_couples_two_joints(tmp_path):
    tie = (
        '<tendon><fixed name="t"><joint joint="lead" coef="1"/><joint joint="follow" coef="-2"/>'
        '</fixed></tendon><equality><tendon tendon1="t" polycoef="0.2 0 0 0 0"/></equality>'
    )
    _, model = loaded(tmp_path, *PAIR, rest=tie)
    assert model.joints[1].terms == ((0, R(1, 2)),)
    assert model.joints[1].offset == R(-1, 10) - R(1, 20)


@pytest.mark.parametrize("switch", ['<flag equality="disable"/>', '<flag constraint="disable"/>'])
def test_constraints_that_are_off_couple_nothing(tmp_path, switch):
    off = '<equality><joint joint1="follow" joint2="lead" active="false"/></equality>'
    assert loaded(tmp_path, *PAIR, rest=off)[0].joint_names == ["lead", "follow"]
    on = f"<option>{switch}</option>{off.replace('false', 'true')}"
    assert loaded(tmp_path, *PAIR, rest=on)[0].joint_names == ["lead", "follow"]


def test_gravity_and_what_is_switched_off(tmp_path):
    swing = body("a", joint("q1", 'frictionloss="1" damping="2"'), BALL)
    arm, _ = loaded(tmp_path, swing, rest='<option gravity="0 -1.62 0"/>')
    assert sp.nsimplify(arm.gravity.T, rational=True) == sp.Matrix([[0, R("-1.62"), 0]])
    off = '<option><flag gravity="disable" frictionloss="disable"/></option>'
    arm, model = loaded(tmp_path, swing, rest=off)
    assert arm.gravity == sp.zeros(3, 1)
    assert drive(model).coulomb == (0, 0)
    assert drive(model).viscous == 2


@pytest.mark.skipif(not IS_4, reason="actuators have armature from MuJoCo 4 on")
def test_motors_add_their_inertia_and_damping(tmp_path):
    motors = '<actuator><motor joint="q1" gear="10" armature="0.1" damping="0.2"/></actuator>'
    _, model = loaded(tmp_path, body("a", joint("q1", 'armature="1"'), BALL), rest=motors)
    assert drive(model).rotor_inertia == 11
    assert drive(model).viscous == 20


def test_defaults_includes_and_other_parts(tmp_path):
    written(
        tmp_path, f"<mujocoinclude>{body('hand', joint('q2'), BALL)}</mujocoinclude>", "hand.xml"
    )
    text = robot(
        body("a", joint("q1"), BALL, '<include file="hand.xml"/>'),
        rest='<default><joint damping="7"/></default><sensor><jointpos joint="q1"/></sensor>'
        '<actuator><motor joint="q2"/></actuator><keyframe><key qpos="0 0"/></keyframe>'
        '<contact><exclude body1="a" body2="hand"/></contact>',
    )
    arm = mr.load(written(tmp_path, text))
    assert arm.joint_names == ["q1", "q2"]
    assert arm.viscous_friction == [7, 7]


def test_shapes_that_are_missing_keep_no_body_with_an_inertia_from_being_read(tmp_path):
    mesh = '<geom type="mesh" mesh="m" material="red"/>'
    assets = (
        '<asset><mesh name="m" file="none.stl"/><texture name="t" type="2d" file="none.png"/>'
        '<material name="red" texture="t"/></asset>'
    )
    base = body("base", mesh, body("a", joint("q1"), BALL, mesh))
    assert loaded(tmp_path, base, rest=assets)[0].masses == [1]


def test_what_acts_from_outside_is_passed_over_with_a_warning(tmp_path):
    lifted = body("a", joint("q1", 'axis="0 1 0"'), inertial(1, "1 0 0"), more='gravcomp="1"')
    target = '<body name="target" mocap="true"/>'
    rest = '<option density="1.2"/><equality><weld body1="target" body2="a"/></equality>'
    with pytest.warns(RobotFileWarning) as said:
        arm, _ = loaded(tmp_path, lifted, target, rest=rest)
    texts = " ".join(str(x.message) for x in said)
    assert "gravcomp of a is passed over: the torques bear the whole weight" in texts
    assert "what ties target and a, of which a simulation moves one, is passed over" in texts
    assert "the fluid around the robot (density, viscosity) is passed over" in texts
    assert arm.gravity_vector()[0].subs(arm.q(1), 0) == sp.Float("-9.81")
