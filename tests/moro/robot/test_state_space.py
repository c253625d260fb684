"""Accelerations in symbols, and the linear model at a point, against what texts and sums give."""

from dataclasses import replace

import pytest
import sympy as sp
from robots import planar, symbolic
from trees import planar_tree

import moro as mr
from moro import Robot
from moro.abc import g, l1, m1, q1, q2, t
from moro.model import PRISMATIC, Body, Coordinate, Drive, Joint, Model, Placement

HALF = sp.Rational(1, 2)


def double_pendulum():
    """Two point masses m at the ends of rods of length l."""
    robot = Robot((l1, 0, 0, q1), (l1, 0, 0, q2))
    robot.masses, robot.cm_positions = [m1, m1], [[0, 0, 0]] * 2
    robot.inertia_tensors, robot.gravity = [sp.zeros(3, 3)] * 2, [0, -g, 0]
    return robot


def mass_on_a_spring(**drive):
    """A mass m that slides, without gravity."""
    m, zero = sp.Symbol("m"), (sp.Integer(0),) * 3
    body = Body(m, zero, (zero, zero, zero))
    joint = Joint(PRISMATIC, -1, Placement())
    model = Model("mass", (joint,), (body,), zero, coordinates=(Coordinate(drive=Drive(**drive)),))
    return Robot.of(model)


def at_numbers(robot, *results):
    """Results with the left-hand sides of the equations of motion, at a state, to 50 digits."""
    symbols = [*robot.parameters, *sp.symbols(f"tau_1:{robot.dof + 1}")]
    values = {x: sp.Rational(5 + 3 * k, 7 + k) for k, x in enumerate(symbols)}
    q, qd = ([sp.Rational(k + 2, 3 + order) for k in range(robot.dof)] for order in (0, 1))
    found = [robot.substitute(sp.Matrix(x), q, qd).xreplace(values) for x in results]
    return [x.evalf(50) for x in found]


@pytest.mark.parametrize("n", [1, 2])
def test_accelerations_obey_the_equations_of_motion(n):
    robot = planar(n)
    robot.viscous_friction, robot.coulomb_friction = sp.symbols(f"b1:{n + 1}"), [(2, 1)] * n
    accelerations = robot.forward_dynamics()
    left = [x.lhs - x.rhs for x in robot.dynamic_model()]
    moved = robot.substitute(left, qdd=accelerations)
    (missed,) = at_numbers(robot, moved)
    assert max(map(abs, missed)) < 1e-40


def test_the_inverse_is_one():
    robot = planar(2)
    inverse, M = at_numbers(robot, robot.inertia_matrix_inverse(), robot.inertia_matrix())
    assert max(map(abs, inverse * M - sp.eye(2))) < 1e-40


def test_quotients_are_in_lowest_terms():
    """Spong et al., exercise 7: the inertia of two point masses."""
    inverse = double_pendulum().inertia_matrix_inverse()
    below = l1**2 * m1 * (sp.sin(q2) ** 2 + 1)
    assert (inverse[0, 0] - 1 / below).equals(0)
    assert inverse[0, 0].count_ops() <= (1 / below).count_ops()
    assert inverse[0, 1].count_ops() <= ((1 + sp.cos(q2)) / below).count_ops() + 1


def test_the_linear_model_of_the_double_pendulum():
    """Where it hangs: M = m l^2 [[5, 2], [2, 1]], dG/dq = m g l [[3, 1], [1, 1]]."""
    A, B = double_pendulum().linearize([-sp.pi / 2, 0])
    assert A[:2, :] == sp.Matrix([[0, 0, 1, 0], [0, 0, 0, 1]])
    assert A[2:, :] == sp.Matrix([[-1, 1, 0, 0], [1, -3, 0, 0]]) * g / l1
    assert sp.Matrix([[0, 0], [0, 0], [1, -2], [-2, 5]]) / (m1 * l1**2) == B


@pytest.mark.parametrize(
    ("q0", "qd0", "tau0"),
    [
        (None, None, None),
        ([HALF, sp.pi / 3], [HALF, -1], None),
        ([HALF, sp.pi / 3], [2, HALF], [sp.Symbol("T"), 1]),
    ],
)
def test_the_linear_model_is_the_derivative_of_the_accelerations(q0, qd0, tau0):
    robot = double_pendulum()
    robot.viscous_friction, robot.coulomb_friction = [3, 5], [(2, 1), 4]
    f, taus = robot.forward_dynamics(), sp.symbols("tau_1 tau_2")
    rates, u0 = [q.diff(t) for q in robot.qs], tau0
    signs = {sp.sign(x): sp.Dummy() for x in rates}
    if tau0 is None:
        held = [x.lhs for x in robot.dynamic_model()]
        u0 = robot.substitute(held, q0, qd0 or [0, 0], [0, 0])
    model = robot.linearize(q0, qd0, tau0)
    for k, x in enumerate([*robot.qs, *rates, *taus]):
        dummy = sp.Dummy()
        slope = f.xreplace(signs).xreplace({x: dummy}).diff(dummy).xreplace({dummy: x})
        slope = slope.xreplace({y: sign for sign, y in signs.items()})
        slope = robot.substitute(slope, q0, qd0 or [0, 0])
        slope = slope.xreplace(dict(zip(taus, u0, strict=True)))
        found = sp.Matrix.hstack(*model)[2:, k]
        missed = (found - slope).subs(sp.Symbol("T"), 3).subs({l1: 2, m1: 3, g: 10})
        assert max(abs(x.subs({q1: 0.3, q2: 0.7}).evalf(30)) for x in missed) < 1e-14


def test_numbers_where_floats_are_given_exact_values_else():
    robot = mr.load("two_link")
    exact, numbers = robot.linearize([1, sp.pi / 4]), robot.linearize([1.0, sp.pi / 4])
    assert not sp.Matrix.hstack(*exact).has(sp.Float)
    assert not sp.Matrix.hstack(*numbers).atoms(sp.Function)
    assert max(map(abs, exact.A.evalf(20) - numbers.A)) < 1e-12


def test_springs_and_friction_are_in_the_linear_model():
    k, b, f, w, m = sp.symbols("k b f w m")
    A, B = mass_on_a_spring(stiffness=k, rest=HALF, viscous=b).linearize([0])
    assert sp.Matrix([[0, 1], [-k / m, -b / m]]) == A
    assert sp.Matrix([0, 1 / m]) == B
    smooth = mass_on_a_spring(coulomb=(f, f), width=w)
    assert smooth.linearize([0]).A[1, 1] == -f / (m * w)
    sharp = mass_on_a_spring(coulomb=(f, f))
    assert sharp.linearize([0]).A[1, 1] == sharp.linearize([0], [2]).A[1, 1] == 0
    held = mass_on_a_spring(stiffness=k, rest=HALF).equilibrium_torques([2])
    assert sp.expand(held[0] - k * 3 / 2) == 0


def test_what_does_not_hang_together_is_inverted_apart():
    tree = Robot.of(planar_tree())
    drives = [Coordinate(drive=Drive(rotor_inertia=1))] * 3
    zero = (sp.Integer(0),) * 3
    bodies = (Body(sp.Integer(1), zero, (zero,) * 3),) * 3
    joints = tuple(Joint(PRISMATIC, -1, Placement()) for _ in range(3))
    several = Model("masses", joints, bodies, zero, coordinates=tuple(drives))
    assert Robot.of(several).inertia_matrix_inverse() == sp.eye(3) / 2
    assert tree.inertia_matrix()[1, 3] == 0


def test_the_state_space_is_the_equations_of_motion():
    robot = double_pendulum()
    x, u, f = robot.state_space()
    assert list(x) == [q1, q2, q1.diff(t), q2.diff(t)]
    assert list(u) == [*sp.symbols("tau_1 tau_2")]
    assert f[:2, 0] == x[2:, 0]
    assert f[2:, 0] == robot.forward_dynamics()


def test_what_is_not_inverted():
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2])
    for method in (robot.forward_dynamics, robot.inertia_matrix_inverse, robot.linearize):
        with pytest.raises(ValueError, match=f"{method.__name__}: .* more than 400 terms"):
            method()
    idle = mr.load("ur5")
    with pytest.raises(ValueError, match="linearize: M is singular, for some joint moves nothing"):
        idle.linearize([0] * 6)
    idle = planar(1).with_parameters({"m_1": 0, "I_{z_1z_1}": 0})
    with pytest.raises(ValueError, match="forward_dynamics: M is singular"):
        idle.forward_dynamics()


def test_points_that_are_none():
    with pytest.raises(ValueError, match="q0 must have 2 values, one for each joint, not 1"):
        double_pendulum().linearize([1])
    with pytest.raises(ValueError, match="gravity not set"):
        Robot.of(replace(mr.load("two_link").model(), not_set=frozenset({"gravity"}))).linearize()


def test_floats_beside_symbols():
    """A constant angle that is a symbol: sin(q1 + beta) is no number at a point."""
    beta = sp.Symbol("beta")
    robot = Robot((l1, beta, 0, q1), (l1, 0, 0, q2), name="askew")
    robot.masses, robot.cm_positions = [m1, m1], [[0, 0, 0]] * 2
    robot.inertia_tensors, robot.gravity = [sp.eye(3)] * 2, [0, -g, 0]
    exact, numbers = robot.linearize([HALF, 1]), robot.linearize([0.5, 1.0])
    values = {beta: 0.3, l1: 1.5, m1: 2, g: 10}
    assert max(map(abs, (exact.A - numbers.A).subs(values).evalf())) < 1e-12
