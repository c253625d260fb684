"""Robots that are a Model made by hand, trees among them; and what Robot holds."""

import copy
import pickle
from dataclasses import replace

import pytest
import sympy as sp
from robots import planar, symbolic
from trees import planar_tree

import moro as mr
from moro import Robot
from moro.abc import g, joint_variable, l1, m1, q1, q2, t
from moro.formats.loading import packaged
from moro.model import (
    REVOLUTE,
    Body,
    Central,
    Coordinate,
    Drive,
    Frame,
    Joint,
    Model,
    Parameter,
    Placement,
    Shift,
    Turn,
)

ZEROS = ((0, 0, 0), (0, 0, 0), (0, 0, 0))
l2, l4, m5 = sp.symbols("l_2 l_4 m_5")


def tree(**changes):
    hand = Frame("hand", 2, Placement.by(Shift((sp.Symbol("h"), 0, 0))))
    camera = Frame("camera", -1, Placement.by(Shift((0, 0, 2)), Turn("x", sp.pi)))
    return replace(planar_tree(), frames=(camera, hand), **changes)


def one(**changes):
    """A pendulum in plain numbers, floats among them."""
    placement = Placement.by(Turn("x", 1.5707963267948966), Shift((0, 0, 0.1)))
    given = {"type": REVOLUTE, "parent": -1, "placement": placement, "offset": 0.5}

    def changed(kind, **given):
        known = kind.__dataclass_fields__
        return kind(**(given | {k: x for k, x in changes.items() if k in known}))

    joint, coordinate = changed(Joint, **given), changed(Coordinate, drive=changed(Drive))
    body = Body(2, (0.2, 0, 0), ((0, 0, 0), (0, 1, 0), (0, 0, 1)))
    pendulum = Model("pendulum", (joint,), (body,), (0, 0, -9.81), coordinates=(coordinate,))
    rest = {k: x for k, x in changes.items() if k in Model.__dataclass_fields__ and k != "name"}
    return replace(pendulum, **rest)


class TestTree:
    def test_frames_by_number_and_by_name(self):
        robot, q = Robot.of(tree()), [joint_variable(i) for i in range(6)]
        assert robot.T_i0(5)[0, 3] == l1 * sp.cos(q[1]) + l4 * sp.cos(q[1] + q[4])
        assert robot.T_i0("hand") == robot.T
        assert robot.T_ij("hand", 3) == robot.T_ij(3, "hand").inv()
        assert robot.T_ij("hand", 3)[0, 3] == sp.Symbol("h")
        assert robot.r_o("camera") == sp.Matrix([0, 0, 2])
        assert robot.T_i0("5") == robot.T_i0(5)
        assert robot.T_i0("0") == robot.T_i0(0) == sp.eye(4)
        assert robot.Ts[3] == robot.T_ij(4, 1)
        with pytest.raises(ValueError, match=r"no frame is called 'hnd'; .*did you mean \"hand\""):
            robot.T_i0("hnd")
        with pytest.raises(IndexError, match=r"frame index must be 0\.\.5, not 6"):
            robot.T_i0(6)

    def test_jacobians_are_the_derivatives_of_positions(self):
        robot = Robot.of(tree())
        assert robot.J_i0("hand") == robot.J
        assert robot.J_point([0, 0, 0], "camera") == robot.J_i0("camera") == sp.zeros(6, 5)
        for i in ("hand", 5, 3, 0):
            J, r = robot.J_i0(i), robot.r_o(i)
            assert robot.simplify(J[:3, :] - r.jacobian(robot.qs)) == sp.zeros(3, 5)
        assert robot.J_i0(5)[5, :] == sp.Matrix([[1, 0, 0, 1, 1]])
        for i in range(1, 6):
            assert robot.Jv_cm_i(i) == robot.simplify(robot.r_cm(i).jacobian(robot.qs))
            assert robot.v_cm(i) == robot.simplify(robot.r_cm(i).diff(t))

    def test_velocities_go_along_the_branch(self):
        robot = Robot.of(tree())
        rates = [q.diff(t) for q in robot.qs]
        assert robot.w(5)[2] == rates[0] + rates[3] + rates[4]
        assert robot.w_rel0(4)[2] == rates[3]

    def test_both_routes_agree_and_other_branches_do_not_matter(self):
        robot = Robot.of(tree())
        M, C, G = robot.inertia_matrix(), robot.coriolis_matrix(), robot.gravity_vector()
        assert M[1, 3] == M[2, 4] == 0
        qd, qdd = (sp.Matrix([q.diff(t, k) for q in robot.qs]) for k in (1, 2))
        left = sp.Matrix([equation.lhs for equation in robot.dynamic_model()])
        assert robot.simplify(left - M * qdd - C * qd - G) == sp.zeros(5, 1)
        assert robot.christoffel_symbols(1, 2, 4, M) == 0
        assert robot.kinetic_energy() == robot.simplify((qd.T * M * qd)[0] / 2)

    def test_everything_else_goes_through(self):
        robot = Robot.of(tree())
        M = robot.inertia_matrix(collect=True)
        assert robot.simplify(M.expand() - robot.inertia_matrix()) == sp.zeros(5, 5)
        Y, p = robot.regressor()
        left = sp.Matrix([equation.lhs for equation in robot.dynamic_model()])
        assert robot.simplify(Y * p - left) == sp.zeros(5, 1)
        assert [x.symbol for x in robot.base_parameters()][:2] == list(sp.symbols("ZZR_1 MXR_1"))
        tex, html = robot.report("tex"), robot.report("html")
        assert "Frame hand" in tex
        assert "link $i$ is moved by joint".lower() in tex.lower()
        assert "<math" in html
        assert robot.latex(robot.T)
        assert "m_5" in map(str, robot.parameters)

    def test_values_are_put_in(self):
        robot = Robot.of(tree(parameters=(Parameter(l2, 2, "length of the arm"), Parameter(g))))
        assert (robot.parameters[l2], robot.parameters[g], robot.parameters[m5]) == (2, None, None)
        new = robot.with_parameters({l4: 0.5, "l_2": 3})
        assert new.T_i0(5)[0, 3].coeff(sp.cos(new.qs[0] + new.qs[3])) == 0.5
        assert not {l2, l4} & set(new.parameters)
        assert [x.meaning for x in robot.model().parameters][:1] == ["length of the arm"]
        assert robot.parameters[l2] == 2


class TestQuantities:
    def test_come_from_the_bodies(self):
        robot = Robot.of(one())
        assert robot.masses == [2]
        assert robot.cm_positions == [sp.Matrix([sp.Rational(1, 10), 0, 0])]
        assert robot.I_cm(1)[1, 1] == 1 - 2 * sp.Rational(1, 100)
        assert robot.gravity[2] == -sp.Rational("9.81")
        assert robot.joint_limits == [(-sp.pi, sp.pi)]
        assert robot.T[2, 3] == 0  # the angle next to pi/2 counts as pi/2
        assert robot.T[1, 3] == -0.1
        summary = {row[0]: row[1] for row in robot.model_summary()}
        assert (summary["masses"], summary["joint_limits"]) == ("given", "assumed")
        assert repr(robot) == "<Robot pendulum: 1 joints R, made of a Model>"

    def test_that_are_not_set_are_missed(self):
        robot = Robot.of(one(not_set=frozenset({"masses", "gravity"})))
        assert robot.masses is robot.gravity is None
        with pytest.raises(ValueError, match="masses not set: pendulum is made of a Model"):
            robot.inertia_matrix()

    def test_as_a_body_was_given(self):
        central = Central((0, l1, 0), ZEROS, Placement.by(Shift((1, 0, 0))))
        model = one(bodies=(Body(m1, (m1, m1 * l1, 0), ZEROS, central=central),))
        robot = Robot.of(model)
        assert robot.cm_positions == [sp.Matrix([0, l1, 0])]
        assert robot.r_cm(1) == (robot.T_i0(1) * sp.Matrix([1, l1, 0, 1]))[:3, :]

    def test_a_body_without_mass_has_its_centre_at_the_origin(self):
        robot = Robot.of(one(bodies=(Body(0, (0, 0, 0), ZEROS),)))
        assert robot.r_cm(1) == robot.r_o(1)

    @pytest.mark.parametrize(
        "name", ["masses", "gravity", "joint_limits", "cm_positions", "viscous_friction"]
    )
    def test_are_set_in_the_model(self, name):
        with pytest.raises(AttributeError, match=f"{name} of pendulum cannot be set: .* Model"):
            setattr(Robot.of(one()), name, None)

    @pytest.mark.parametrize("name", ["dh_parameters", "dh_table", "arm"])
    def test_rows_are_missing(self, name):
        with pytest.raises(AttributeError, match=f"pendulum has no {name}: that is of DH rows"):
            getattr(Robot.of(one()), name)

    def test_name_and_defaults_are_set(self):
        robot = Robot.of(tree())
        robot.name, robot.parameters = "other", {"l_1": 2}
        assert robot.model().name == "other"
        assert robot.model().defaults[l1] == 2


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"joints": ()}, ValueError, "at least one joint"),
        ({"bodies": ()}, ValueError, "a body for each joint: 1, not 0"),
        ({"parent": 0}, ValueError, "parent of joint 1 must be -1, the base.*not 0"),
        ({"type": "revolute"}, TypeError, "joint 1 must be a Joint of a JointType"),
        ({"variable": l1 * q1}, ValueError, "variable of joint 1 must be q1"),
        ({"offset": q1}, ValueError, r"offset of joint 1 must be constant, not q_1\(t\)"),
        ({"offset": "1"}, TypeError, "offset of joint 1 must be a number"),
        ({"viscous": -1}, ValueError, "viscous friction of joint 1 must not be negative"),
        ({"limits": (1, 0)}, ValueError, "limits of joint 1 must be"),
        ({"gravity": (0, 1)}, ValueError, "gravity must have 3 components, not 2"),
        ({"bodies": (Body(-1, (0, 0, 0), ZEROS),)}, ValueError, "mass of body 1 must not be neg"),
        (
            {"bodies": (Body(1, (0, 0, 0), ((0, 1, 0), *ZEROS[1:])),)},
            ValueError,
            "inertia of body 1 must be symmetric: entry 1,2 is 1, entry 2,1 is 0",
        ),
        ({"frames": (Frame("a", 1, Placement()),)}, ValueError, r"link of frame a must be -1\.\.0"),
        ({"frames": (Frame("a", 0, Placement()),) * 2}, ValueError, "two frames are called a"),
    ],
)
def test_wrong_models_are_refused(changes, error, message):
    with pytest.raises(error, match=message):
        Robot.of(one(**changes))


def test_joints_need_variables_of_their_own():
    base = Joint(REVOLUTE, -1, Placement())
    joints, coordinates = (base, replace(base, parent=0)), (Coordinate(q1),) * 2
    body = Body(1, (0, 0, 0), ZEROS)
    with pytest.raises(ValueError, match="joints 1 and 2 have the same variable"):
        Robot.of(Model("twice", joints, (body, body), (0, 0, 0), (), coordinates))


def test_only_models_are_models():
    with pytest.raises(TypeError, match="a robot is made of a Model, not 'two_link'"):
        Robot.of("two_link")


@pytest.mark.parametrize("convention", ["dh", "mdh"])
def test_the_model_of_rows_gives_what_the_rows_give(convention):
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2], kinds="rrp", convention=convention)
    robot.viscous_friction = sp.symbols("b1:4")
    again = Robot.of(robot.model())
    for name in ("T", "J", "Ts", "qs", "masses", "cm_positions", "convention", "parameters"):
        assert getattr(again, name) == getattr(robot, name), name
    methods = "inertia_matrix coriolis_matrix gravity_vector dynamic_model friction_vector"
    for name in f"{methods} lagrangian".split():
        assert getattr(again, name)() == getattr(robot, name)(), name
    for name in ("r_cm", "I_cm0", "J_cm_i", "I_cm", "w", "T_i0"):
        assert getattr(again, name)(2) == getattr(robot, name)(2), name
    assert list(again.base_parameters().values) == list(robot.base_parameters().values)


class Arm(Robot):
    """An arm of its own kind."""

    tool = None

    def __init__(self):
        super().__init__((l1, 0, 0, q1), (l1, 0, 0, q2), name="own")


class TestSubclasses:
    def test_come_from_files_models_and_values(self):
        for robot in (Arm.load("two_link"), Arm.of(one()), Arm().with_parameters({l1: 1})):
            assert type(robot) is Arm
        assert type(mr.load("two_link")) is Robot
        assert Arm().T[0, 3] == l1 * (sp.cos(q1) + sp.cos(q1 + q2))

    def test_have_attributes_of_their_own(self):
        arm = Arm()
        arm.tool, arm.masses = "gripper", [1, 2]
        assert (arm.tool, arm.masses) == ("gripper", [1, 2])
        with pytest.raises(AttributeError, match='a Robot has no mases; did you mean "masses"'):
            arm.mases = [1, 2]


class TestCopies:
    @pytest.mark.parametrize(
        "again",
        [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))],  # noqa: S301
    )
    @pytest.mark.parametrize("used", [False, True])
    def test_stand_alone(self, again, used):
        robot = planar(2)
        robot.parameters = {l1: 1}
        before = robot.inertia_matrix() if used else None
        other = again(robot)
        other.masses, other.parameters, other.name = [3, 4], {l1: 2}, "other"
        assert robot.masses == list(sp.symbols("m_1 m_2"))
        assert (robot.parameters[l1], robot.name) == (1, "robot")
        assert (other.masses, other.parameters[l1]) == ([3, 4], 2)
        assert other.inertia_matrix().free_symbols.isdisjoint(sp.symbols("m_1 m_2"))
        if used:
            assert robot.inertia_matrix() == before

    def test_of_models(self):
        robot = Robot.of(tree())
        other = copy.copy(robot)
        other.name = "other"
        assert robot.name == "two_arms"


def test_what_cannot_be_set_says_so():
    with pytest.raises(AttributeError, match="dh_parameters of a Robot cannot be set"):
        planar(2).dh_parameters = []
    with pytest.raises(AttributeError):
        planar(2).dof = 3


def test_quantities_have_docstrings():
    assert "None if not set" in Robot.masses.__doc__
    assert all(getattr(Robot, x).__doc__ for x in dir(Robot) if not x.startswith("_"))


@pytest.mark.parametrize("name", packaged())
def test_packaged_arms_load_as_any_kind(name):
    assert Arm.load(name).model() == mr.load(name).model()
