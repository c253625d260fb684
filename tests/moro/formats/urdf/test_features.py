"""What a URDF says, each feature by itself, with values derived by hand."""

import pytest
import sympy as sp
from urdfs import axis, body, joint, link, origin, robot, written

import moro as mr
from moro.abc import joint_variable, t

q1, q2, q3 = (joint_variable(i) for i in (1, 2, 3))
R, pi = sp.Rational, sp.pi
s1, c1 = sp.sin(q1), sp.cos(q1)


def exact(x):
    """The decimals that are printed as the fractions they are."""
    return x.xreplace({each: R(str(each)) for each in x.atoms(sp.Float)})


@pytest.fixture
def load(tmp_path):
    def made(*elements, name="robot", **how):
        return mr.load(written(tmp_path, robot(*elements, name=name)), **how)

    return made


def pendulum(axis_xyz, xyz="0 0 0", rpy="0 0 0", inside="", kind="revolute", mass=2, at="0 0 0"):
    """One joint on the base, a point-like body on it."""
    place = origin(xyz, rpy) + axis(axis_xyz) + inside
    return link("base"), joint("swing", "base", "arm", place, kind), link("arm", body(mass, at))


@pytest.mark.parametrize(
    ("direction", "place"),
    [
        ("0 0 1", [c1, s1, 0]),
        ("0 0 -2", [c1, -s1, 0]),
        ("0 1 0", [c1, 0, -s1]),
        ("0 -1 0", [c1, 0, s1]),
        ("1 0 0", [1, 0, 0]),
        ("0 1 6.12323e-17", [c1, 0, -s1]),
    ],
)
def test_axes(load, direction, place):
    """Where the tip (1, 0, 0) of a link goes that turns about its axis."""
    tip = joint("end", "arm", "tip", origin("1 0 0"), "fixed")
    arm = load(*pendulum(direction), tip, link("tip"))
    assert list(arm.T_i0("tip")[:3, 3]) == place
    assert arm.T_i0("tip") == arm.T


def test_an_axis_between_the_axes(load):
    """A turn by q about (1, 1, 1) takes x to y, y to z and z to x after a third of a turn."""
    arm = load(*pendulum("1 1 1"))
    rotation = arm.R_i0("arm").subs(q1, 2 * pi / 3)
    permutation = sp.Matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    assert all(abs(x) < 1e-15 for x in (rotation - permutation).evalf(30))


def test_gravity_torque_of_a_pendulum(load):
    """m g l cos q about -y, with the mass at l = 0.5 on x."""
    arm = load(*pendulum("0 1 0", at="0.5 0 0"))
    assert exact(arm.gravity_vector()[0]) == -2 * R("9.81") * R(1, 2) * c1
    assert exact(arm.inertia_matrix()[0]) == 1 + 2 * R(1, 4)


def test_roll_pitch_yaw_turn_about_fixed_axes(load):
    """Rz(90) Ry(0) Rx(90) takes z to x, and the axis y of the joint to z."""
    arm = load(*pendulum("0 1 0", "0.1 0.2 0.3", "1.5708 0 1.57079632679"))
    assert arm.T_i0("arm").subs(q1, 0).applyfunc(exact) == sp.Matrix(
        [[0, 0, 1, R(1, 10)], [1, 0, 0, R(1, 5)], [0, 1, 0, R(3, 10)], [0, 0, 0, 1]]
    )
    assert list(arm.z(1)) == [0, 0, 1]


def test_angles_as_they_are_written(load):
    meant, written_so = (load(*pendulum("1 0 0", rpy="0 0 1.5708"), as_written=x) for x in (0, 1))
    assert meant.R_i0("arm")[0, 0] == 0
    found = written_so.R_i0("arm")[0, 0]
    assert float(found) == pytest.approx(float(sp.cos(R("1.5708"))), abs=1e-16)
    assert "1.5708 as pi/2" in str(meant.model_summary())
    assert "1.5708" not in str(written_so.model_summary())


def test_what_computing_left_of_zeros(load):
    tensor = '<inertia ixx="1" ixy="1e-14" ixz="0" iyy="1" iyz="0" izz="1"/>'
    elements = (
        link("base"),
        joint("a", "base", "arm", origin("1e-17 0.5 0", "0 2e-13 0") + axis("0 0 1")),
        link("arm", body(1, "0 -3e-16 0", inertia=tensor)),
    )
    arm = load(*elements)
    assert list(arm.r_o("arm")) == [0, sp.Float(0.5), 0]
    assert arm.cm_positions == [sp.zeros(3, 1)]
    assert arm.inertia_tensors == [sp.eye(3)]
    said = str(arm.model_summary())
    assert all(f"{text} as 0" in said for text in ("1e-17", "2e-13", "-3e-16", "of the largest"))
    assert load(*elements, as_written=True).inertia_tensors[0][0, 1] == R("1e-14")


def test_bodies_in_turned_frames(load):
    """diag(1, 2, 3) turned by 90 degrees about z is diag(2, 1, 3)."""
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/>'
    place = origin() + axis("1 0 0")
    arm = load(
        link("base"),
        joint("roll", "base", "arm", place),
        link("arm", body(5, "0 2 0", "0 0 1.5708", tensor)),
    )
    assert arm.inertia_matrix()[0] == 2 + 5 * 4


def test_prismatic_joints_and_limits(load):
    inside = '<limit lower="-0.1" upper="0.25" effort="1" velocity="1"/>'
    arm = load(*pendulum("0 0 -1", kind="prismatic", inside=inside))
    assert arm.joint_types == ["p"]
    assert list(arm.r_o("arm")) == [0, 0, -q1]
    assert arm.joint_limits == [(R(-1, 10), R(1, 4))]
    assert exact(arm.gravity_vector()[0]) == -2 * R("9.81")


def test_joints_without_limits(load):
    assert load(*pendulum("0 0 1", kind="continuous")).joint_limits == [(-pi, pi)]
    unlimited = load(*pendulum("0 0 1", inside='<limit effort="3" velocity="1"/>'))
    assert unlimited.joint_limits == [(-pi, pi)]
    one = load(*pendulum("0 0 1", inside='<limit upper="1"/>'))
    assert one.joint_limits == [(0, 1)]


def test_friction_is_used_and_said(load):
    arm = load(*pendulum("1 0 0", inside='<dynamics damping="0.5" friction="0.25"/>'))
    qd = q1.diff(t)
    assert exact(arm.friction_vector()[0]) == R(1, 2) * qd + R(1, 4) * sp.sign(qd)
    assert arm.viscous_friction == [R(1, 2)]
    assert arm.coulomb_friction == [(R(1, 4), R(1, 4))]
    assert "damping and friction of swing" in str(arm.model_summary())


def test_mimic_joints(load):
    """x_2 = -2 x_1 + 0.5; two joints about one axis: the second turns by -q_1 + 0.5 in all."""
    arm = load(
        *pendulum("0 0 1", inside='<dynamics damping="1"/>'),
        joint("follow", "arm", "hand", '<axis xyz="0 0 1"/><dynamics damping="3"/>'
              '<mimic joint="swing" multiplier="-2" offset="0.5"/>'),
        link("hand", body(1)),
    )  # fmt: skip
    assert arm.joint_names == ["swing"]
    assert arm.dof == 1
    assert sp.simplify(arm.T_i0("hand")[0, 0] - sp.cos(R(1, 2) - q1)) == 0
    assert arm.inertia_matrix()[0] == 1 + 1  # I qd^2 + I (-qd)^2
    assert arm.viscous_friction == [1 + 3 * 4]


def test_mimics_of_mimics_in_any_order(load):
    arm = load(
        link("a"),
        joint("ab", "a", "b", axis("0 0 1") + '<mimic joint="bc" multiplier="3" offset="1"/>'),
        link("b", body()),
        joint("bc", "b", "c", axis("0 0 1") + '<mimic joint="cd" multiplier="2" offset="-1"/>'),
        link("c", body()),
        joint("cd", "c", "d", axis("0 0 1")),
        link("d", body()),
    )
    assert arm.joint_names == ["cd"]
    # 3 (2 q - 1) + 1, 2 q - 1, q
    assert [x.offset for x in arm.model().joints] == [-2, -1, 0]
    assert [x.terms for x in arm.model().joints] == [((0, 6),), ((0, 2),), ((0, 1),)]
    assert arm.inertia_matrix()[0] == 6**2 + 8**2 + 9**2


def test_what_mimics_a_fixed_joint_stands_still(load):
    arm = load(
        *pendulum("0 0 1"),
        joint("weld", "arm", "a", kind="fixed"),
        link("a"),
        joint("follow", "arm", "b", axis("0 0 1") + '<mimic joint="weld" offset="1.5708"/>'),
        link("b", body()),
    )
    assert arm.joint_names == ["swing"]
    assert float(arm.T_ij("b", "arm")[1, 0]) == pytest.approx(1, abs=1e-9)


def test_planar_joints(load):
    """Two slides in the plane across the axis, and a turn about it."""
    arm = load(*pendulum("0 0 1", kind="planar", at="1 0 0"))
    assert arm.joint_names == ["swing_x", "swing_y", "swing_theta"]
    assert arm.joint_types == ["p", "p", "r"]
    assert list(arm.T_i0("arm")[:3, 3]) == [q1, q2, 0]
    assert arm.T_i0("arm")[0, 0] == sp.cos(q3)
    M = arm.inertia_matrix()
    assert M[:2, :2] == sp.diag(2, 2)
    assert M[2, 2] == 1 + 2
    assert list(M[:2, 2]) == [-2 * sp.sin(q3), 2 * sp.cos(q3)]


def test_fixed_links_and_a_heavy_base(load):
    arm = load(
        link("world"),
        joint("stand", "world", "base", origin("0 0 1", "1.5708 0 0"), "fixed"),
        link("base", body(50)),
        joint("lift", "base", "rod", axis("0 1 0"), "prismatic"),
        link("rod", body(1)),
        joint("weld", "rod", "tool", origin("0 0 1"), "fixed"),
        link("tool", body(2)),
    )
    assert arm.masses == [3]
    assert arm.frames == ["world", "base", "rod", "tool"]
    assert list(arm.r_o("rod")) == [0, 0, 1 + q1]
    assert exact(arm.gravity_vector()[0]) == 3 * R("9.81")


def test_trees_go_depth_first_in_the_order_of_the_file(load):
    names = ["right", "left", "wrist"]
    links = [link(x, body()) for x in ("torso", *(f"{name}_link" for name in names))]
    joints = [
        joint("right", "torso", "right_link"),
        joint("left", "torso", "left_link"),
        joint("wrist", "right_link", "wrist_link"),
    ]
    arm = load(*links, *joints)
    assert arm.joint_names == ["right", "wrist", "left"]
    assert arm.inertia_matrix()[2, :2] == sp.zeros(1, 2)


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("Two-Arm robot!", "Two_Arm_robot"),
        ("7dof", "robot_7dof"),
        ("", "robot"),
        ("int", "robot_int"),
    ],
)
def test_the_name_is_made_an_identifier(load, given, name):
    assert load(*pendulum("0 0 1"), name=given).name == name


def test_closed_forms_of_a_file_are_exact_identities(load):
    """Whatever angles the file holds: dM/dt - 2 C is skew, and M is symmetric."""
    arm = load(
        link("base"),
        joint("a", "base", "b", origin("0.1 0 0", "0.1 0.2 0.3") + axis("1 2 3")),
        link("b", body(2, "0.1 0 0.2", "0.3 0.2 0.1")),
        joint("b", "b", "c", origin("0 0.2 0", "0.4 0 0.7854") + axis("0 1 0")),
        link("c", body(1, "0.1 0 0")),
    )
    M, C = arm.inertia_matrix(), arm.coriolis_matrix()
    N = (M.diff(t) - 2 * C).applyfunc(lambda x: sp.expand(x, trig=False))
    assert (N + N.T).applyfunc(sp.nsimplify).applyfunc(sp.simplify) == sp.zeros(2)
