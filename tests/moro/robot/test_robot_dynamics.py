"""The symbolic route: textbook forms, two routes, identities, reference numbers."""

import itertools
import json
import random
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from robots import planar, random_robot, symbolic, symbolic_puma560

import moro as mr
from moro.abc import g, l1, lc1, lc2, m1, m2, q1, q2, t
from moro.closed_form import ClosedForm
from moro.scalars.dual import DualRing
from moro.scalars.trig import TrigRing

REFERENCE = Path(__file__).parents[2] / "reference"
ARMS = ["two_link", "stanford_arm", "puma560", "ur5", "ur5e", "panda"]
I1, I2 = sp.symbols("I_{z_1z_1} I_{z_2z_2}")
qd1, qd2 = q1.diff(t), q2.diff(t)


def equal_and_as_short(found, printed):
    assert sp.expand(sp.expand(found - printed), trig=True) == 0
    assert found.count_ops() <= printed.count_ops(), (found, printed)


class TestPlanar2R:
    """Spong, Hutchinson & Vidyasagar, Robot Modeling and Control, example 7.2 (two-link arm)."""

    robot = planar(2)

    def test_inertia_matrix(self):
        M = self.robot.inertia_matrix()
        m11 = m1 * lc1**2 + m2 * (l1**2 + lc2**2 + 2 * l1 * lc2 * sp.cos(q2)) + I1 + I2
        equal_and_as_short(M[0, 0], m11)
        equal_and_as_short(M[0, 1], m2 * (lc2**2 + l1 * lc2 * sp.cos(q2)) + I2)
        equal_and_as_short(M[1, 1], m2 * lc2**2 + I2)
        assert M[0, 1] == M[1, 0]
        assert M.atoms(sp.sin, sp.cos) == {sp.cos(q2)}

    def test_coriolis_matrix(self):
        C = self.robot.coriolis_matrix()
        h = -m2 * l1 * lc2 * sp.sin(q2)
        printed = [[h * qd2, h * (qd2 + qd1)], [-h * qd1, sp.Integer(0)]]
        for i, j in itertools.product(range(2), repeat=2):
            equal_and_as_short(C[i, j], printed[i][j])

    def test_gravity_vector(self):
        G = self.robot.gravity_vector()
        g2 = m2 * lc2 * g * sp.cos(q1 + q2)
        equal_and_as_short(G[0], (m1 * lc1 + m2 * l1) * g * sp.cos(q1) + g2)
        equal_and_as_short(G[1], g2)

    def test_forward_kinematics(self):
        assert self.robot.T[0, 3] == l1 * sp.cos(q1) + mr.abc.l2 * sp.cos(q1 + q2)


def test_puma_entries_are_in_q2_plus_q3():
    robot = symbolic_puma560()
    angles = {x.args[0] for x in robot.inertia_matrix().atoms(sp.sin, sp.cos)}
    q = robot.qs
    assert angles == {q[1], q[2], q[3], q[4], q[5], q[1] + q[2]}
    gravity = {x.args[0] for x in robot.gravity_vector().atoms(sp.sin, sp.cos)}
    assert gravity == {q[1], q[3], q[4], q[5], q[1] + q[2]}


def test_puma_entry_is_as_short_as_armstrongs():
    """M_22 of an elbow arm: Armstrong, Khatib & Burdick 1986 have no angle there but q3."""
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2])
    M = robot.inertia_matrix()
    angles = {x.args[0] for x in M[1:, 1:].atoms(sp.sin, sp.cos)}
    assert angles == {robot.q(3)}


@pytest.mark.parametrize("convention", ["dh", "mdh"])
def test_both_routes_give_the_identical_form(convention):
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2, 0], kinds="rrpr", convention=convention)
    robot.rotor_inertias = sp.symbols("J1:5")
    assert_routes_agree(robot)


@pytest.mark.sweep
def test_both_routes_agree_for_the_fully_symbolic_puma():
    robot = symbolic_puma560()
    assert_routes_agree(robot)


def assert_routes_agree(robot):
    M, C, G = robot.inertia_matrix(), robot.coriolis_matrix(), robot.gravity_vector()
    qd, qdd = ([q.diff(t, k) for q in robot.qs] for k in (1, 2))
    convert = robot._ring.convert
    for i, equation in enumerate(robot.dynamic_model()):
        left = convert(G[i])
        for j in range(robot.dof):
            left += convert(M[i, j]) * convert(qdd[j]) + convert(C[i, j]) * convert(qd[j])
        assert left - convert(equation.lhs) == 0
        assert robot._show(left) == equation.lhs


def test_mdot_minus_2c_is_exactly_skew():
    robot = symbolic_puma560()
    M, C = robot.inertia_matrix(), robot.coriolis_matrix()
    ring = robot._ring
    rate = [[robot._rate(ring.convert(x)) for x in row] for row in M.tolist()]
    N = [[rate[i][j] - ring.convert(C[i, j]) * 2 for j in range(6)] for i in range(6)]
    assert all(N[i][j] + N[j][i] == 0 for i in range(6) for j in range(6))


def test_simplify_proves_skew_symmetry_to_a_user():
    robot = planar(3)
    N = robot.inertia_matrix().diff(t) - 2 * robot.coriolis_matrix()
    assert robot.simplify(N + N.T) == sp.zeros(3, 3)


@pytest.mark.parametrize("name", ARMS)
def test_against_reference_numbers(name):
    robot = mr.load(name)
    robot.rotor_inertias = None
    reference = json.loads((REFERENCE / f"{name}.json").read_text())["states"]
    q, qd, qdd = (np.array([s[key] for s in reference]).T for key in ("q", "qd", "qdd"))
    form = ClosedForm(robot.model(), TrigRing())
    ring, n = form.ring, robot.dof
    values = dict(zip(robot.qs, q, strict=True))
    M = np.array([[ring.evaluate(x, values) for x in row] for row in form.inertia_matrix])
    G = np.array([ring.evaluate(x, values) for x in form.gravity_vector])
    c = np.zeros_like(G)
    for i, j, k in itertools.product(range(n), repeat=3):
        c[i] += ring.evaluate(form.christoffel(i, j, k), values) * qd[j] * qd[k]
    tau = np.einsum("ijs,js->is", M, qdd) + c + G
    for s, state in enumerate(reference):
        scale = max(np.abs(state["tau_rigid"]).max(), 1e-3)
        np.testing.assert_allclose(tau[:, s], state["tau_rigid"], atol=1e-12 * scale)
        np.testing.assert_allclose(M[..., s], state["M_rigid"], atol=1e-12 * np.abs(M).max())
        np.testing.assert_allclose(G[:, s], state["G"], atol=1e-12 * scale)
        np.testing.assert_allclose(c[:, s], state["Cqd"], atol=1e-12 * scale)
        P = sum(ring.evaluate(x, values)[s] for x in form.potential_energies)
        assert pytest.approx(state["potential_energy"], rel=1e-12, abs=1e-12) == P


@pytest.mark.parametrize("name", ARMS)
def test_forward_kinematics_against_reference(name):
    robot = mr.load(name)
    T = sp.lambdify(robot.qs, robot.T, "numpy")
    for state in json.loads((REFERENCE / f"{name}.json").read_text())["states"]:
        np.testing.assert_allclose(T(*state["q"]), state["T"], atol=1e-14)


@pytest.mark.parametrize("seed", range(8))
def test_random_arms_numbers_agree_with_closed_forms(seed):
    """DualRing runs the same formulas on numbers: every joint type, both conventions."""
    rng = random.Random(seed)
    robot = random_robot(rng, rng.randint(1, 4), rng.choice(["dh", "mdh"]))
    state = {q: rng.uniform(-2, 2) for q in robot.qs}
    exact, numeric = (
        ClosedForm(robot.model(), TrigRing()),
        ClosedForm(robot.model(), DualRing(robot.qs, state)),
    )
    n = robot.dof
    for i, j, k in itertools.product(range(n), repeat=3):
        c = exact.ring.evaluate(exact.christoffel(i, j, k), state)
        assert numeric.christoffel(i, j, k).value == pytest.approx(c, abs=1e-11)
    for x, y in zip(exact.gravity_vector, numeric.gravity_vector, strict=True):
        assert y.value == pytest.approx(exact.ring.evaluate(x, state), abs=1e-11)


@pytest.mark.parametrize("seed", range(6))
def test_random_arms_obey_the_identities(seed):
    rng = random.Random(100 + seed)
    robot = random_robot(rng, rng.randint(2, 3), rng.choice(["dh", "mdh"]))
    assert_routes_agree(robot)
    state = {q: rng.uniform(-2, 2) for q in robot.qs}
    M = np.array(robot.inertia_matrix().subs(state).evalf(), dtype=float)
    np.testing.assert_allclose(M, M.T)
    assert np.linalg.eigvalsh(M).min() > 0


@pytest.mark.parametrize("seed", range(6))
def test_velocities_are_derivatives_of_positions(seed):
    """v_Ci = Jv qd and w_i = Jw qd, by routes that share nothing but the frames."""
    rng = random.Random(200 + seed)
    robot = random_robot(rng, 3, rng.choice(["dh", "mdh"]))
    qd = sp.Matrix([q.diff(t) for q in robot.qs])
    for i in (1, 2, 3):
        assert robot.simplify(robot.r_cm(i).diff(t) - robot.v_cm(i)) == sp.zeros(3, 1)
        assert robot.simplify(robot.Jv_cm_i(i) * qd - robot.v_cm(i)) == sp.zeros(3, 1)
        assert robot.simplify(robot.Jw_cm_i(i) * qd - robot.w(i)) == sp.zeros(3, 1)
        S = robot.simplify(robot.R_i0(i).diff(t) * robot.R_i0(i).T)
        assert robot.simplify(sp.Matrix([S[2, 1], S[0, 2], S[1, 0]]) - robot.w(i)) == sp.zeros(3, 1)


@pytest.mark.parametrize("seed", range(4))
def test_energies_are_those_of_the_texts(seed):
    rng = random.Random(300 + seed)
    robot = random_robot(rng, 2, rng.choice(["dh", "mdh"]))
    for i in (1, 2):
        v, w, I = robot.v_cm(i), robot.w(i), robot.I_cm0(i)
        K = robot.m(i) * v.dot(v) / 2 + w.dot(I * w) / 2
        assert robot.simplify(K - robot.link_kinetic_energy(i)) == 0
        P = -robot.m(i) * robot.gravity.dot(robot.r_cm(i))
        assert robot.simplify(P - robot.link_potential_energy(i)) == 0
    L = robot.kinetic_energy() - robot.potential_energy()
    assert robot.simplify(L - robot.lagrangian()) == 0


def test_christoffel_symbols_of_any_matrix():
    robot = planar(2)
    M = robot.inertia_matrix()
    h = -m2 * l1 * lc2 * sp.sin(q2)
    assert robot.christoffel_symbols(1, 1, 2, M) == h
    assert robot.christoffel_symbols(2, 1, 1, M) == -h
    assert robot.christoffel_symbols(1, 1, 2, sp.Matrix([[q2**2, 0], [0, 1]])) == q2
    for i, j, k in itertools.product((1, 2), repeat=3):
        c = robot.christoffel_symbols(i, j, k, M)
        slope = sp.diff(robot.coriolis_matrix()[i - 1, j - 1], robot.q_dot(k))
        assert robot.simplify(slope - c) == 0


def test_friction_and_rotor_inertia_have_their_places():
    robot = planar(2)
    plain = robot.inertia_matrix()
    robot.rotor_inertias = sp.symbols("J1 J2")
    robot.viscous_friction = sp.symbols("b1 b2")
    robot.coulomb_friction = [(3, 1), sp.Symbol("f2")]
    assert robot.simplify(robot.inertia_matrix() - plain) == sp.diag(*sp.symbols("J1 J2"))
    F = robot.friction_vector()
    assert [F[0].subs(qd1, x) for x in (2, -2, 0)] == [
        sp.Symbol("b1") * 2 + 3,
        -sp.Symbol("b1") * 2 - 1,
        0,
    ]
    assert F[1] == sp.Symbol("b2") * qd2 + sp.Symbol("f2") * sp.sign(qd2)
    for equation in robot.dynamic_model():
        assert equation.lhs.has(sp.sign)
    D = robot.dissipation()
    robot.coulomb_friction = None
    assert robot.friction_vector() == sp.Matrix([D.diff(qd1), D.diff(qd2)])
    assert len(robot.dynamic_model_matrix_form().lhs.args) == 4


def test_matrix_form_is_the_equation_of_the_blocks():
    robot = planar(2)
    equation = robot.dynamic_model_matrix_form()
    left = equation.lhs.doit()
    for i, explicit in enumerate(robot.dynamic_model()):
        assert robot.simplify(left[i] - explicit.lhs) == 0
        assert equation.rhs[i] == explicit.rhs == sp.Symbol(f"tau_{i + 1}")


def test_floats_count_as_decimals_and_print_as_floats():
    robot = mr.Robot((0.1, 0, 0, q1), (0.2, np.pi / 2, 0, q2))
    assert robot.T[0, 3] == 0.2 * sp.cos(q1 + q2) + 0.1 * sp.cos(q1)
    assert robot.T[0, 2] == sp.sin(q1 + q2)
    exact = mr.Robot((sp.Rational(1, 10), 0, 0, q1), (sp.Rational(1, 5), 0, 0, q2))
    assert not exact.T.has(sp.Float)


@pytest.mark.parametrize("name", ARMS)
def test_files_give_no_floats(name):
    robot = mr.load(name)
    for result in (robot.T, robot.J, robot.gravity_vector(), robot.inertia_matrix()):
        assert not result.has(sp.Float)
