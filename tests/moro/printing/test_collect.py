"""Named constants: the same values in fewer words, names shared, stable and independent."""

import random
from dataclasses import FrozenInstanceError
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp
from robots import decimal, planar, random_robot, symbolic, symbolic_puma560

import moro as mr
from moro.abc import g, joint_variable, l1, lc1, lc2, m1, m2, q1, q2, t

k1, k2, k3, gamma1, gamma2 = sp.symbols("k_1 k_2 k_3 gamma_1 gamma_2")
qd1, qd2 = q1.diff(t), q2.diff(t)
QUANTITIES = ["inertia_matrix", "coriolis_matrix", "gravity_vector"]


def elbow():
    return symbolic([sp.pi / 2, 0, -sp.pi / 2])


def four_joints():
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2, 0], kinds="rrpr", convention="mdh")
    robot.rotor_inertias = sp.symbols("J1:5")
    return robot


def half_numeric():
    robot = mr.load("puma560")
    robot.masses = None
    return robot


def with_payload():
    """Numbers and one symbol."""
    robot = mr.load("two_link")
    robot.masses = [robot.m(1), robot.m(2) + sp.Symbol("payload")]
    return robot


ARMS = [lambda: planar(3), elbow, four_joints, half_numeric, with_payload]


def collected_equations(robot):
    return robot.dynamic_model(collect=True).equations


class TestPlanar2R:
    """The constants are those that texts pick by hand for this arm."""

    robot = planar(2)

    def test_inertia_matrix(self):
        M = self.robot.inertia_matrix(collect=True)
        I1, I2 = sp.symbols("I_{z_1z_1} I_{z_2z_2}")
        c2 = sp.cos(q2)
        assert M.matrix == sp.Matrix([[k1 + 2 * k2 * c2, k3 + k2 * c2], [k3 + k2 * c2, k3]])
        assert list(M.constants) == [k1, k2, k3]
        assert M.constants == {
            k1: m1 * lc1**2 + m2 * (l1**2 + lc2**2) + I1 + I2,
            k2: m2 * l1 * lc2,
            k3: m2 * lc2**2 + I2,
        }

    def test_coriolis_matrix(self):
        C = self.robot.coriolis_matrix(collect=True)
        h = -k2 * sp.sin(q2)
        assert C.matrix == sp.Matrix([[h * qd2, h * (qd1 + qd2)], [-h * qd1, 0]])
        assert C.constants == {k2: m2 * l1 * lc2}

    def test_gravity_vector(self):
        G = self.robot.gravity_vector(collect=True)
        second = gamma2 * sp.cos(q1 + q2)
        assert G.matrix == sp.Matrix([gamma1 * sp.cos(q1) + second, second])
        assert G.constants == {gamma1: g * (m1 * lc1 + m2 * l1), gamma2: g * m2 * lc2}

    def test_equations_of_motion(self):
        first, second = collected_equations(self.robot)
        qdd1, qdd2 = q1.diff(t, 2), q2.diff(t, 2)
        left = (k3 + k2 * sp.cos(q2)) * qdd1 + k3 * qdd2 + k2 * sp.sin(q2) * qd1**2
        assert second == sp.Eq(left + gamma2 * sp.cos(q1 + q2), sp.Symbol("tau_2"))
        assert first.rhs == sp.Symbol("tau_1")

    def test_prints_itself(self):
        M = self.robot.inertia_matrix(collect=True)
        assert str(M).splitlines()[:3] == [
            "M[1, 1] = k_1 + 2*k_2*cos(q_2(t))",
            "M[1, 2] = k_2*cos(q_2(t)) + k_3",
            "M[2, 2] = k_3",
        ]
        assert "k_2 = l_1*l_c2*m_2" in str(M)
        assert r"M_{12} &= k_{3}+k_{2}\,c_{2} \\" in M.latex()
        assert r"k_{2} &= m_{2}\,l_{1}\,l_{c2} \\" in M.latex()
        assert M._repr_latex_() == f"$\\displaystyle {M.latex()}$"
        cells = ElementTree.fromstring(M.html()).iter("tr")  # noqa: S314
        assert ["".join(row.itertext()) for row in cells][:2] == ["M11=k1+2k2c2", "M12=k3+k2c2"]


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_expands_to_what_it_was(arm, quantity):
    robot = arm()
    assert getattr(robot, quantity)(collect=True).expand() == getattr(robot, quantity)()


@pytest.mark.parametrize("arm", ARMS)
def test_substituting_the_constants_gives_the_same_values(arm):
    """By SymPy alone: whatever ``expand`` does, names and constants say the same."""
    robot = arm()
    rng = random.Random(5)
    for quantity in QUANTITIES:
        collected, plain = getattr(robot, quantity)(collect=True), getattr(robot, quantity)()
        back = collected.matrix.xreplace(dict(collected.constants))
        state = {q.diff(t): decimal(rng) for q in robot.qs}
        state |= {s: decimal(rng) for s in (*robot.qs, *robot.parameters)}
        values = (np.array(x.xreplace(state).evalf(), dtype=float) for x in (back, plain))
        np.testing.assert_allclose(*values, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("arm", ARMS)
def test_equations_are_those_of_euler_and_lagrange(arm):
    """M qdd + C qd + G in names against the energy route without names, friction included."""
    robot = arm()
    robot.viscous_friction = sp.symbols(f"b1:{robot.dof + 1}")
    collected, plain = robot.dynamic_model(collect=True), robot.dynamic_model()
    assert list(collected.expand()) == [equation.lhs for equation in plain]
    assert [x.rhs for x in collected.equations] == [x.rhs for x in plain]


@pytest.mark.sweep
def test_fully_symbolic_puma_is_in_few_words():
    robot = symbolic_puma560()
    M, C = robot.inertia_matrix(collect=True), robot.coriolis_matrix(collect=True)
    assert M.expand() == robot.inertia_matrix()
    assert C.expand() == robot.coriolis_matrix()
    assert len(M.constants) <= 68
    assert set(C.constants) <= set(M.constants)
    assert all(C.constants[k] == M.constants[k] for k in C.constants)
    words = sum(map(sp.count_ops, (*M.matrix, *M.constants.values())))
    assert words < 0.65 * sum(map(sp.count_ops, robot.inertia_matrix()))


@pytest.mark.parametrize("arm", ARMS)
def test_names_are_independent_so_none_is_a_multiple_of_another(arm):
    robot = arm()
    for collected in (robot.inertia_matrix(collect=True), robot.gravity_vector(collect=True)):
        symbols = sorted(robot.parameters, key=str)
        polynomials = [sp.Poly(sp.expand(x), *symbols) for x in collected.constants.values()]
        monomials = sorted({m for p in polynomials for m in p.monoms()})
        coefficients = [[p.coeff_monomial(m) for m in monomials] for p in polynomials]
        assert sp.Matrix(coefficients).rank() == len(polynomials)


@pytest.mark.parametrize("first", QUANTITIES)
def test_names_do_not_depend_on_what_was_asked_for_first(first):
    robot, other = four_joints(), four_joints()
    getattr(other, first)(collect=True)
    for quantity in QUANTITIES:
        assert getattr(robot, quantity)(collect=True) == getattr(other, quantity)(collect=True)
    assert collected_equations(robot) == collected_equations(other)


def test_names_are_numbered_as_they_turn_up():
    M = elbow().inertia_matrix(collect=True)
    assert [str(k) for k in M.constants] == [f"k_{i}" for i in range(1, len(M.constants) + 1)]
    turning_up = [min(i for i, (_, x) in enumerate(M.entries()) if x.has(k)) for k in M.constants]
    assert turning_up == sorted(turning_up)


@pytest.mark.parametrize("name", ["two_link", "puma560", "panda"])
def test_numbers_stay_numbers(name):
    robot = mr.load(name)
    M = robot.inertia_matrix(collect=True)
    assert M.constants == {}
    assert M.matrix == robot.inertia_matrix()


def test_single_symbols_stay_as_they_are():
    """A hoist: m_2 alone moves the second joint, both masses the first."""
    robot = mr.Robot((0, 0, q1, 0, "p"), (0, 0, q2, 0, "p"))
    robot.masses, robot.cm_positions = None, [[0, 0, 0]] * 2
    robot.inertia_tensors = [sp.zeros(3, 3)] * 2
    robot.gravity = [0, 0, -g]
    M = robot.inertia_matrix(collect=True)
    assert M.matrix == sp.Matrix([[k1, m2], [m2, m2]])
    assert M.constants == {k1: m1 + m2}


def test_names_do_not_clash_with_the_models_symbols():
    robot = planar(2)
    robot.masses = [sp.Symbol("k_7"), sp.Symbol("gamma_{3}")]
    assert [str(k) for k in robot.inertia_matrix(collect=True).constants] == [
        "kc_1",
        "kc_2",
        "kc_3",
    ]
    assert [str(k) for k in robot.gravity_vector(collect=True).constants] == [
        "gammac_1",
        "gammac_2",
    ]


def test_is_immutable_and_independent_of_the_robot():
    robot = planar(2)
    M, plain = robot.inertia_matrix(collect=True), robot.inertia_matrix()
    with pytest.raises(FrozenInstanceError):
        M.name = "N"
    with pytest.raises(TypeError):
        M.constants[k1] = 0
    with pytest.raises(TypeError):
        M.matrix[0, 0] = 0
    robot.masses = [1, 2]
    assert M.expand() == plain
    assert robot.inertia_matrix(collect=True) != M


def test_floats_print_as_floats_and_expand_exactly():
    robot = planar(2)
    robot.masses = [0.1, 1.25]
    M = robot.inertia_matrix(collect=True)
    assert any(x.has(sp.Float) for x in M.constants.values())
    assert M.expand() == robot.inertia_matrix()


def test_numbers_have_no_zeros_behind():
    robot = mr.load("two_link").with_parameters({})
    robot.masses = [0.2, 0.4]
    assert str(robot.inertia_matrix(collect=True)).splitlines()[-1] == "M[2, 2] = 0.1"


@pytest.mark.parametrize("seed", range(4))
def test_random_numeric_arms_collect_to_themselves(seed):
    rng = random.Random(seed)
    robot = random_robot(rng, 3, rng.choice(["dh", "mdh"]))
    for quantity in QUANTITIES:
        collected = getattr(robot, quantity)(collect=True)
        assert not collected.constants
        assert collected.expand() == getattr(robot, quantity)()


def test_what_is_not_set_is_asked_for():
    robot = mr.Robot((l1, 0, 0, q1))
    with pytest.raises(ValueError, match="masses not set"):
        robot.inertia_matrix(collect=True)


def test_gravity_needs_no_inertia_tensors():
    robot = mr.Robot((l1, 0, 0, q1))
    robot.masses, robot.cm_positions, robot.gravity = None, [[0, 0, 0]], [0, -g, 0]
    assert robot.gravity_vector(collect=True).matrix == sp.Matrix([gamma1 * sp.cos(q1)])


def test_plain_symbols_warn_and_have_no_velocity():
    robot = mr.Robot((l1, 0, 0, sp.Symbol("q1")))
    robot.masses, robot.cm_positions = None, [[0, 0, 0]]
    robot.inertia_tensors, robot.gravity = None, [0, -g, 0]
    with pytest.warns(UserWarning, match="coriolis_matrix"):
        assert robot.coriolis_matrix(collect=True).matrix == sp.zeros(1, 1)


def test_ten_joints_have_indices_apart():
    robot = mr.Robot(*((0, 0, joint_variable(i), 0, "p") for i in range(1, 11)))
    robot.masses, robot.cm_positions = None, [[0, 0, 0]] * 10
    robot.inertia_tensors = [sp.zeros(3, 3)] * 10
    assert "M_{1,10} &= m_{10}" in robot.inertia_matrix(collect=True).latex()


def test_too_long_for_a_notebook_prints_as_text():
    assert symbolic_puma560().coriolis_matrix(collect=True)._repr_latex_() is None
