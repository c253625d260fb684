"""Coordinates that move several joints: exactly what they are by A^T from the free joints."""

import random

import pytest
import sympy as sp
from robots import planar, random_robot, symbolic
from trees import coupled, matrix_of, planar_tree, random_rows

from moro import Robot
from moro.abc import q1, q2, q3, t
from moro.model import PRISMATIC, REVOLUTE, Body, Joint, Model, Placement, Shift, Turn

ZERO = sp.Integer(0)


def free_and_coupled(model, rows, nv):
    """The free robot in its own variables, the coupled one, A, and {x_i: (A q)_i}."""
    free, robot, A = Robot.of(model), Robot.of(coupled(model, rows, nv)), matrix_of(rows, nv)
    moved = A * sp.Matrix(robot.qs)
    x = sp.symbols(f"x1:{len(rows) + 1}")
    at = dict(zip(free.qs, x, strict=True))
    back = dict(zip(x, moved, strict=True))
    return free, robot, A, lambda expr: expr.xreplace(at).xreplace(back)


def equal(robot, found, expected):
    return robot.simplify(sp.Matrix(found) - sp.Matrix(expected)).is_zero_matrix


ARMS = [
    (planar(3), [[(0, 1)], [(1, 1)], [(0, -1), (1, -1)]], 2),  # the last link does not turn
    (planar(3), [[(0, 1)], [(1, 1), (0, -1)], [(2, 1), (1, -1)]], 3),  # angles to the base
    (planar(2), [[(0, -1)], [(0, sp.Rational(1, 2))]], 1),
    (planar(2), [[(0, sp.Rational(2, 3))], [(0, sp.Rational(1, 2)), (1, 1)]], 2),
    (planar(2), [[(0, 1)], [(0, sp.Symbol("r"))]], 1),
    (planar(2), [[(0, 1)], [(0, sp.Rational("1.09")), (1, sp.sqrt(2))]], 2),
    (symbolic([sp.pi / 2, 0, -sp.pi / 2]), [[(0, -1)], [(1, 1)], [(0, 2), (1, -1)]], 2),
    (symbolic([sp.pi / 2, 0, 0], kinds="rpr"), [[(0, 1)], [(0, 3), (1, -1)], [(1, 1)]], 2),
]


@pytest.mark.parametrize(("arm", "rows", "nv"), ARMS)
def test_everything_is_that_of_the_free_joints(arm, rows, nv):
    model = arm.model()
    free, robot, A, at = free_and_coupled(model, rows, nv)
    rotors = sp.diag(*(x.drive.rotor_inertia for x in robot.model().coordinates))
    M, G = at(free.inertia_matrix()), at(free.gravity_vector())
    assert equal(robot, robot.inertia_matrix(), A.T * M * A + rotors)
    assert equal(robot, robot.gravity_vector(), A.T * G)
    assert equal(robot, robot.T, at(free.T))
    assert equal(robot, robot.J, at(free.J) * A)
    rates = A * sp.Matrix([q.diff(t) for q in robot.qs])
    speeds = {q.diff(t): sp.Dummy() for q in free.qs}
    C = at(free.coriolis_matrix().xreplace(speeds))
    C = C.xreplace(dict(zip(speeds.values(), rates, strict=True)))
    assert equal(robot, robot.coriolis_matrix(), A.T * C * A)


@pytest.mark.parametrize(("arm", "rows", "nv"), ARMS)
def test_identities(arm, rows, nv):
    check_identities(Robot.of(coupled(arm.model(), rows, nv)))


@pytest.mark.parametrize("seed", range(8))
def test_identities_of_random_robots(seed):
    rng = random.Random(seed)
    model = random_robot(rng, 3, ["dh", "mdh"][seed % 2]).model()
    check_identities(Robot.of(coupled(model, *random_rows(rng, 3))))


def check_identities(robot):
    """dM/dt - 2C is skew, both routes agree, P's gradient is G, the regressor gives the torques."""
    M, C, G = robot.inertia_matrix(), robot.coriolis_matrix(), robot.gravity_vector()
    skew = robot.simplify(M.diff(t) - 2 * C)
    assert robot.simplify(skew + skew.T).is_zero_matrix
    qd, qdd = (sp.Matrix([q.diff(t, k) for q in robot.qs]) for k in (1, 2))
    friction = robot.friction_vector()
    left = [equation.lhs for equation in robot.dynamic_model()]
    assert equal(robot, left, M * qdd + C * qd + G + friction)
    Y, p = robot.regressor()
    assert equal(robot, Y * p, left)


def test_the_last_link_of_a_palletizer_keeps_its_direction():
    """theta_3 = -q1 - q2: no sine or cosine of the last link is left, nor its moment of inertia."""
    robot = Robot.of(coupled(planar(3).model(), [[(0, 1)], [(1, 1)], [(0, -1), (1, -1)]], 2))
    assert robot.T[:3, :3] == sp.eye(3)
    assert sp.Symbol("I_zz3") not in robot.inertia_matrix().free_symbols


def test_angles_to_the_base_uncouple_the_velocities():
    """With x2 = q2 - q1, M_12 = m2 l1 lc2 cos(q1 - q2), as in texts on parallelograms."""
    robot = Robot.of(coupled(planar(2).model(), [[(0, 1)], [(0, -1), (1, 1)]], 2))
    m2, l1, lc2 = sp.symbols("m_2 l_1 l_c2")
    assert str(robot.inertia_matrix()[0, 1]) == str(m2 * l1 * lc2 * sp.cos(q1 - q2))


def test_a_screw():
    """A helical joint of pitch h turns by q and slides by h q: M = I_zz + m h^2, G = m g h."""
    h, m, g, I = sp.symbols("h m g I")
    bare = Body(ZERO, (ZERO,) * 3, ((ZERO,) * 3,) * 3)
    nut = Body(m, (ZERO,) * 3, ((ZERO,) * 3, (ZERO,) * 3, (ZERO, ZERO, I)))
    joints = (
        Joint(REVOLUTE, -1, Placement(), terms=((0, 1),)),
        Joint(PRISMATIC, 0, Placement(), terms=((0, h),)),
    )
    robot = Robot.of(Model("screw", joints, (bare, nut), (ZERO, ZERO, -g)))
    assert (robot.dof, robot.joint_types) == (1, ["r"])
    assert robot.inertia_matrix() == sp.Matrix([[I + m * h**2]])
    assert robot.gravity_vector() == sp.Matrix([g * m * h])
    assert robot.T[2, 3] == h * q1


def test_arms_on_a_trunk_do_not_feel_each_other():
    """The blocks of M between two arms are zero, exactly; the rest is as a text would print it."""
    M = Robot.of(planar_tree()).inertia_matrix()
    assert M[1:3, 3:5].is_zero_matrix
    m3, l2, lc3, I3 = sp.symbols("m_3 l_2 l_c3 I_3")
    assert M[2, 2] == I3 + m3 * lc3**2
    assert M[1, 2] == I3 + m3 * lc3 * (l2 * sp.cos(q3) + lc3)


def test_a_branch_that_turns_back():
    """A joint off the first axis, coupled with one on another branch."""
    zero, l = sp.Integer(0), sp.Symbol("l")
    joints = (
        Joint(REVOLUTE, -1, Placement()),
        Joint(REVOLUTE, 0, Placement.by(Shift((l, zero, zero)), Turn("x", sp.pi / 2))),
        Joint(REVOLUTE, 0, Placement.by(Shift((zero, l, zero)))),
        Joint(REVOLUTE, 1, Placement.by(Shift((l, zero, zero)))),
    )
    body = Body(sp.Symbol("m"), (l, zero, l), sp.diag(1, 2, 3).tolist())
    model = Model("back", joints, (body,) * 4, (zero, zero, -sp.Symbol("g")))
    rows = [[(0, 1)], [(2, 1), (0, 1)], [(1, 1), (2, -1)], [(1, 1)]]
    check_identities(Robot.of(coupled(model, rows, 3)))
