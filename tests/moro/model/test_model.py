"""The model: the texts' matrices against what rows make of it, and trees of every kind."""

import itertools
import random

import numpy as np
import pytest
import sympy as sp
from dynamics import exact_case
from recursion import inertia_matrix, inverse_dynamics
from robots import random_robot
from trees import planar_tree, sympified

from moro import Model
from moro.abc import joint_variable, symbol
from moro.closed_form import ClosedForm, Geometry
from moro.model import (
    PRISMATIC,
    REVOLUTE,
    Body,
    Frame,
    Joint,
    Placement,
    Rotation,
    Shift,
    Turn,
)
from moro.scalars.dual import DualRing
from moro.scalars.trig import TrigRing


def matrix(R=((1, 0, 0), (0, 1, 0), (0, 0, 1)), p=(0, 0, 0)):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.array(R, float), np.array(p, float)
    return T


def turn(axis, angle):
    s, c = np.sin(angle), np.cos(angle)
    if axis == "x":
        return matrix([[1, 0, 0], [0, c, -s], [0, s, c]])
    return matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def shift(x=0, z=0):
    return matrix(p=(x, 0, z))


class TestRows:
    @pytest.mark.parametrize("seed", range(12))
    def test_are_the_matrices_of_the_texts(self, seed):
        """Rz Tz Tx Rx (Denavit & Hartenberg), Rx Tx Rz Tz (Craig), multiplied here, in numbers."""
        rng = random.Random(seed)
        convention = ["dh", "mdh"][seed % 2]
        robot = random_robot(rng, 5, convention)
        values = {q: rng.uniform(-3, 3) for q in robot.qs}
        model, T = robot.model(), matrix()
        poses = [matrix()]
        for joint, q in zip(model.joints, robot.qs, strict=True):
            x = float(values[q] + joint.offset)
            moved = turn("z", x) if joint.type == REVOLUTE else shift(z=x)
            poses.append(poses[-1] @ matrix(joint.placement.R, joint.placement.p) @ moved)
        for row, frame in zip(robot.dh_parameters, model.frames, strict=True):
            a, alpha, d, theta = (float(sp.sympify(x).subs(values)) for x in row[:4])
            if convention == "dh":
                T = T @ turn("z", theta) @ shift(z=d) @ shift(x=a) @ turn("x", alpha)
            else:
                T = T @ turn("x", alpha) @ shift(x=a) @ turn("z", theta) @ shift(z=d)
            found = poses[frame.link + 1] @ matrix(frame.placement.R, frame.placement.p)
            np.testing.assert_allclose(found, T, atol=1e-12)

    @pytest.mark.parametrize("convention", ["dh", "mdh"])
    def test_bodies_are_about_the_origins_of_the_joints_frames(self, convention):
        robot = random_robot(random.Random(3), 3, convention)
        model = robot.model()
        for i, (body, frame) in enumerate(zip(model.bodies, model.frames, strict=True), 1):
            m, R = robot.m(i), np.array(frame.placement.R, float)
            c = (
                np.array(frame.placement.p, float)
                + R @ np.array(robot.cm_positions[i - 1], float)[:, 0]
            )
            J = R @ np.array(robot.I_cm(i), float) @ R.T
            J += float(m) * (c @ c * np.eye(3) - np.outer(c, c))
            np.testing.assert_allclose(np.array(body.first_moment, float), float(m) * c, atol=1e-12)
            np.testing.assert_allclose(np.array(body.inertia, float), J, atol=1e-12)


class TestPlacement:
    def test_every_rotation_by_quarter_turns_is_taken_apart(self):
        quarters = [k * sp.pi / 2 for k in range(4)]
        for a, b, c in itertools.product(quarters, repeat=3):
            R = Placement.by(Turn("z", a), Turn("x", b), Turn("z", c)).R
            placement = Placement(R, (1, 2, 3))
            assert not any(isinstance(step, Rotation) for step in placement.steps)
            again = Placement.by(*placement.steps)
            assert (again.R, again.p) == (R, (1, 2, 3))

    def test_any_other_rotation_stays_as_it_is(self):
        R = Placement.by(Turn("x", sp.pi / 3)).R
        assert Placement(R, (0, 0, 0)).steps == (Shift((0, 0, 0)), Rotation(R))


class TestPlanarTree:
    def test_prints_as_a_text_would(self):
        ring = TrigRing()
        form = ClosedForm(planar_tree(), ring)
        q1, _, q3, q4, q5 = map(joint_variable, range(1, 6))
        M = [[ring.expanded(x) for x in row] for row in form.inertia_matrix]
        assert M[1][3] == M[1][4] == M[2][3] == M[2][4] == 0
        m3, l2, lc3, I3 = sp.symbols("m_3 l_2 l_c3 I_3")
        assert M[2][2] == sp.expand(I3 + m3 * lc3**2)
        assert ring.convert(M[1][2]) == ring.convert(I3 + m3 * lc3**2 + m3 * l2 * lc3 * sp.cos(q3))
        g, m5, lc5 = sp.symbols("g m_5 l_c5")
        G5 = g * m5 * lc5 * sp.cos(q1 + q4 + q5)
        assert form.gravity_vector[4] == ring.convert(G5)

    def test_angles_of_both_arms_add_to_the_trunks(self):
        ring = TrigRing()
        ClosedForm(planar_tree(), ring)
        q1, q2, q3, q4, q5 = map(joint_variable, range(1, 6))
        assert set(ring.pairs) == {q1, q1 + q2, q1 + q2 + q3, q1 + q4, q1 + q4 + q5}
        assert ring.convert(sp.cos(q1 + q4)).terms == ring.convert(sp.cos(q4 + q1)).terms
        between = ring.convert(sp.sin(q2 - q4))
        assert between == ring.convert(sp.sin((q1 + q2) - (q1 + q4)))


def both_routes(form, ring):
    """M, C and G as they come from the Lagrangian, and from Jacobians and Christoffel symbols."""
    n = form.n
    qd, qdd = ([sp.Symbol(f"{x}_{i}") for i in range(n)] for x in ("v", "a"))
    equations = form.euler_lagrange(qd, qdd)
    rates = [ring.convert(x) for x in qd]
    C = form.coriolis_matrix(rates)
    torques = [
        sum(
            (
                form.inertia_matrix[i][j] * ring.convert(qdd[j]) + C[i][j] * rates[j]
                for j in range(n)
            ),
            form.gravity_vector[i],
        )
        for i in range(n)
    ]
    return equations, torques, C, rates


@pytest.mark.parametrize("seed", [1, 3, 5, 9])
def test_both_routes_agree_exactly_on_trees_of_any_rotations(seed):
    model = sympified(exact_case(seed, tree=True).model)
    ring = TrigRing()
    form = ClosedForm(replace_joints(model, 4), ring)
    equations, torques, C, rates = both_routes(form, ring)
    assert equations == torques
    M, n = form.inertia_matrix, form.n
    for i, j in itertools.product(range(n), repeat=2):
        dM = sum(
            (ring.diff(M[i][j], q) * v for q, v in zip(form.qs, rates, strict=True)), ring.zero
        )
        assert dM == C[i][j] + C[j][i]


def replace_joints(model, n):
    """The first n joints of a model."""
    n = min(n, model.dof)
    tip = Frame("tip", n - 1, Placement())
    return Model(model.name, model.joints[:n], model.bodies[:n], model.gravity, (tip,))


@pytest.mark.parametrize("seed", range(1, 12, 2))
def test_the_recursion_agrees_with_jacobians_on_trees(seed):
    case = exact_case(seed)
    model = sympified(case.model)
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2, 2, (model.dof, 3))
    ring = DualRing(model.qs, dict(zip(model.qs, q, strict=True)))
    form = ClosedForm(model, ring)
    floats = model.map(float)
    pairs = [
        (np.sin(x + j.offset), np.cos(x + j.offset)) for x, j in zip(q, floats.joints, strict=True)
    ]
    M = np.array(
        [[np.broadcast_to(x, 3) for x in row] for row in inertia_matrix(floats, q, pairs)], float
    )
    expected = np.array([[x.value for x in row] for row in form.inertia_matrix])
    np.testing.assert_allclose(M, expected, atol=1e-9 * max(1, np.abs(expected).max()))
    still = np.zeros_like(q)
    G = np.array(
        [np.broadcast_to(x, 3) for x in inverse_dynamics(floats, q, still, still, pairs)], float
    )
    expected = np.array([x.value for x in form.gravity_vector])
    np.testing.assert_allclose(G, expected, atol=1e-9 * max(1, np.abs(expected).max()))


def test_frames_on_different_branches_are_seen_from_each_other():
    model, ring = planar_tree(), TrigRing()
    geometry = Geometry(model, ring)
    zero, l3, l5 = sp.Integer(0), symbol("l", 3), symbol("l", 5)
    hand, other = (
        Frame("hand", link, Placement.by(Shift((length, zero, zero))))
        for link, length in ((2, l3), (4, l5))
    )
    R, p = geometry.relative(hand, other)
    A, a = geometry.pose(hand)
    B, b = geometry.pose(other)
    back = [
        [sum((B[k][i] * A[k][j] for k in range(3)), ring.zero) for j in range(3)] for i in range(3)
    ]
    assert [list(row) for row in R] == back
    assert list(p) == [
        sum((B[k][i] * (a[k] - b[k]) for k in range(3)), ring.zero) for i in range(3)
    ]


def test_a_sliding_joint_on_a_branch_has_no_part_in_the_other():
    zero = sp.Integer(0)
    joints = (
        Joint(REVOLUTE, -1, Placement()),
        Joint(PRISMATIC, 0, Placement.by(Turn("x", sp.pi / 2))),
        Joint(REVOLUTE, 0, Placement.by(Shift((symbol("l"), zero, zero)))),
    )
    body = Body(symbol("m"), (zero, zero, zero), ((zero,) * 3,) * 3)
    ring = TrigRing()
    form = ClosedForm(Model("fork", joints, (body,) * 3, (zero, zero, zero)), ring)
    assert not form.inertia_matrix[1][2]
    assert ring.expanded(form.inertia_matrix[1][1]) == symbol("m")
