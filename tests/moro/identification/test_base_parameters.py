"""Base parameters and the regressor: numbers of the literature, minimality, and tau = Y p.

The independent route is the recursive Newton-Euler algorithm with one standard parameter at a time:
the rank of the regressor stacked over random states is the number of base parameters.
"""

import dataclasses
import random

import numpy as np
import pytest
import sympy as sp
from arms import NAMES as ARMS
from arms import numeric, random_state, sincos
from recursion import inverse_dynamics
from robots import planar, random_robot, symbolic, symbolic_puma560, symbolic_seven

import moro as mr
from moro.abc import g, joint_variable, l1, l2, lc1, lc2, m1, m2, q1, q2, symbol, t
from moro.model import Body
from moro.scalars.random_point import RandomPoint, dependences
from moro.scalars.trig import TrigRing

pi = sp.pi
I1, I2 = sp.symbols("I_{z_1z_1} I_{z_2z_2}")


def bare(name):
    robot = mr.load(name)
    robot.rotor_inertias = robot.viscous_friction = robot.coulomb_friction = None
    return robot


def with_bodies(robot, seed=0):
    """The same geometry with full bodies in numbers."""
    rng = random.Random(seed)
    other = random_robot(rng, robot.dof)
    robot.masses, robot.cm_positions = other.masses, other.cm_positions
    robot.inertia_tensors = other.inertia_tensors
    return robot


def standard_regressor(robot, states=12, seed=0):
    """Regressor in the ten standard parameters of every link, stacked over random states."""
    model = numeric(robot.model())
    rng = np.random.default_rng(seed)
    q, qd, qdd = np.moveaxis([random_state(rng, robot.dof) for _ in range(states)], 0, -1)
    columns = []
    for i in range(robot.dof):
        for k in range(10):
            bodies = [unit_body(k) if j == i else unit_body(None) for j in range(robot.dof)]
            lone = dataclasses.replace(model, bodies=tuple(bodies))
            tau = inverse_dynamics(lone, q, qd, qdd, sincos(lone, q))
            columns.append(np.broadcast_arrays(*tau, q[0])[:-1])
    return np.array(columns).reshape(10 * robot.dof, -1).T


def unit_body(k):
    m, x, y, z, xx, yy, zz, xy, xz, yz = (float(j == k) for j in range(10))
    return Body(m, (x, y, z), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


def rank(A):
    size = np.abs(A).max(axis=0)
    A = A[:, size > 1e-9 * size.max()]
    values = np.linalg.svd(A / np.abs(A).max(axis=0), compute_uv=False)
    return int((values > 1e-9 * values[0]).sum())


def moving(robot):
    return [*robot.qs, *(q.diff(t, k) for k in (1, 2) for q in robot.qs)]


def as_function(expr, robot):
    """NumPy function of q, qd, qdd."""
    plain = {x: sp.Dummy() for x in moving(robot)}
    expr = sp.Matrix(expr).xreplace(plain).tolist()
    return sp.lambdify([plain[x] for x in moving(robot)], sp.flatten(expr))


def exactly_linear(robot):
    """Y p - (M qdd + C qd + G + friction), which must be the zero vector."""
    Y, p = robot.regressor()
    qd, qdd = (sp.Matrix([q.diff(t, k) for q in robot.qs]) for k in (1, 2))
    tau = robot.inertia_matrix() * qdd + robot.coriolis_matrix() * qd + robot.gravity_vector()
    return robot.simplify(Y * p - tau - robot.friction_vector()) == sp.zeros(robot.dof, 1)


class TestPlanar2R:
    """Khalil & Dombre 2002, section 9.4; Siciliano et al. 2009, section 7.3.2 (two-link arm)."""

    def test_groups_are_those_of_the_texts(self):
        parameters = planar(2).base_parameters()
        assert [str(x) for x in parameters.symbols] == ["ZZR_1", "MXR_1", "ZZ_2", "MX_2"]
        printed = [
            I1 + m1 * lc1**2 + m2 * l1**2,
            m1 * lc1 + m2 * l1,
            I2 + m2 * lc2**2,
            m2 * lc2,
        ]
        assert list(parameters.values) == printed
        ZZ1, MX1, ZZ2, MX2, M2 = sp.symbols("ZZ_1 MX_1 ZZ_2 MX_2 M_2")
        groups = [ZZ1 + l1**2 * M2, MX1 + l1 * M2, ZZ2, MX2]
        assert list(parameters.combinations) == groups

    def test_regressor_is_that_of_the_texts(self):
        robot = planar(2)
        Y, _ = robot.regressor()
        (v1, v2), (a1, a2) = ([q.diff(t, k) for q in (q1, q2)] for k in (1, 2))
        c1, c2, c12, s2 = sp.cos(q1), sp.cos(q2), sp.cos(q1 + q2), sp.sin(q2)
        y14 = l1 * c2 * (2 * a1 + a2) - l1 * s2 * (2 * v1 * v2 + v2**2) + g * c12
        y24 = l1 * c2 * a1 + l1 * s2 * v1**2 + g * c12
        printed = sp.Matrix([[a1, g * c1, a1 + a2, y14], [0, 0, a1 + a2, y24]])
        assert robot.simplify(Y - printed) == sp.zeros(2, 4)
        for found, short in zip(Y, printed, strict=True):
            assert found.count_ops() <= short.count_ops()

    def test_in_the_horizontal_plane_first_moments_of_link_1_do_nothing(self):
        robot = planar(2)
        robot.gravity = [0, 0, -g]
        assert [str(x) for x in robot.base_parameters().symbols] == ["ZZR_1", "ZZ_2", "MX_2"]
        assert len(robot.base_parameters(zeros=True)) == 4

    def test_zeros_of_symbols_are_left_out_and_zeros_of_numbers_stay(self):
        robot = planar(2)
        assert len(robot.base_parameters(zeros=True)) == 6
        names = ["l_1", "l_2", "l_c1", "l_c2", "m_1", "m_2", "I_{z_1z_1}", "I_{z_2z_2}"]
        numbers = robot.with_parameters(dict.fromkeys(names, 1))
        assert len(numbers.base_parameters()) == 4  # I_xx and I_yy are symbols still
        assert len(mr.load("two_link").base_parameters(zeros=False)) == 4
        assert len(mr.load("two_link").base_parameters()) == 6


def test_elbow_arm_is_that_of_the_texts():
    """Stäubli RX-90, Khalil & Dombre 2002, section 9.4: all that is grouped, and how."""
    d3, r4 = sp.symbols("D3 RL4")
    twists = [0, pi / 2, 0, -pi / 2, pi / 2, -pi / 2]
    rows = [
        (d3 if i == 3 else 0, alpha, r4 if i == 4 else 0, joint_variable(i))
        for i, alpha in enumerate(twists, 1)
    ]
    robot = mr.Robot(*rows, convention="mdh")
    robot.gravity = [0, 0, -g]
    found = {str(x.symbol): x.combination for x in robot.base_parameters()}
    S = sp.Symbol
    M3456 = sum(S(f"M_{i}") for i in (3, 4, 5, 6))
    M456 = M3456 - S("M_3")
    printed = {
        "ZZR_1": S("ZZ_1") + S("YY_2") + S("YY_3") + d3**2 * M3456,
        "XXR_2": S("XX_2") - S("YY_2") - d3**2 * M3456,
        "XZR_2": S("XZ_2") - d3 * S("MZ_3"),
        "ZZR_2": S("ZZ_2") + d3**2 * M3456,
        "MXR_2": S("MX_2") + d3 * M3456,
        "XXR_3": S("XX_3") - S("YY_3") + S("YY_4") + 2 * r4 * S("MZ_4") + r4**2 * M456,
        "ZZR_3": S("ZZ_3") + S("YY_4") + 2 * r4 * S("MZ_4") + r4**2 * M456,
        "MYR_3": S("MY_3") + S("MZ_4") + r4 * M456,
        "XXR_4": S("XX_4") + S("YY_5") - S("YY_4"),
        "ZZR_4": S("ZZ_4") + S("YY_5"),
        "MYR_4": S("MY_4") - S("MZ_5"),
        "XXR_5": S("XX_5") + S("YY_6") - S("YY_5"),
        "ZZR_5": S("ZZ_5") + S("YY_6"),
        "MYR_5": S("MY_5") + S("MZ_6"),
        "XXR_6": S("XX_6") - S("YY_6"),
    }
    assert len(found) == 36
    assert {name for name in found if "R" in name} == set(printed)
    for name, combination in printed.items():
        assert sp.expand(found[name] - combination) == 0, name


@pytest.mark.parametrize(
    ("name", "count"),
    [("two_link", 6), ("stanford_arm", 33), ("puma560", 36), ("ur5", 36), ("panda", 43)],
)
def test_counts_of_known_arms(name, count):
    """36 for the PUMA 560 and 43 for the Panda as published, all confirmed by the rank."""
    robot = bare(name)
    assert len(robot.base_parameters()) == count
    assert rank(standard_regressor(robot, states=40)) == count


def test_counts_of_symbolic_arms():
    assert len(symbolic_puma560().base_parameters()) == 36
    assert len(symbolic_seven().base_parameters()) == 43
    twists = sp.symbols("alpha1:8")
    assert len(symbolic(twists).base_parameters()) == 43
    oblique = symbolic(twists, convention="mdh")  # axis 1 is not along gravity: MX_1, MY_1
    assert len(oblique.base_parameters()) == 45
    assert len(planar(10).base_parameters(zeros=True)) == 30


@pytest.mark.parametrize("seed", range(16))
def test_random_arms(seed):
    """Minimal: as many as the rank; complete: Y p is the torque; the columns are independent."""
    rng = random.Random(seed)
    convention = rng.choice(["dh", "mdh"])
    robot = random_robot(rng, 1 + seed % 4, convention, gravity=seed % 3 > 0)
    parameters = robot.base_parameters()
    assert len(parameters) == rank(standard_regressor(robot))
    Y = check_torques(robot)
    assert rank(Y.reshape(len(parameters), -1).T) == len(parameters)


@pytest.mark.parametrize("name", ARMS)
def test_regressor_of_packaged_arms(name):
    check_torques(mr.load(name))


def check_torques(robot, states=12):
    """Compare Y p with the recursive algorithm; return the columns of Y at the states."""
    rng = np.random.default_rng(5)
    q, qd, qdd = np.moveaxis([random_state(rng, robot.dof) for _ in range(states)], 0, -1)
    ring, values = robot._ring, dict(zip(moving(robot), np.vstack([q, qd, qdd]), strict=True))
    parameters = robot.base_parameters()
    columns = robot._regressor_columns([x.leader for x in parameters])
    Y = np.array([[ring.evaluate(x, values) for x in column] for column in columns])
    model = numeric(robot.model())
    tau = np.broadcast_arrays(*inverse_dynamics(model, q, qd, qdd, sincos(model, q)), q[0])[:-1]
    tau += np.array([x.drive.rotor_inertia for x in model.coordinates])[:, None] * qdd
    friction = as_function(list(robot.friction_vector()), robot)(*q, *qd, *qdd)
    tau += np.array(np.broadcast_arrays(*friction, q[0])[:-1], dtype=float)
    p = np.array(parameters.values, dtype=float).ravel()
    np.testing.assert_allclose(np.einsum("kis,k->is", Y, p), tau, atol=1e-10 * np.abs(tau).max())
    return Y


def test_printed_regressor_is_the_one_evaluated():
    robot = bare("stanford_arm")
    Y, p = robot.regressor()
    state = np.random.default_rng(1).uniform(-2, 2, 18)
    Y = np.array(as_function(Y[2, :], robot)(*state), dtype=float)
    model = numeric(robot.model())
    q, qd, qdd = state.reshape(3, 6)
    tau = inverse_dynamics(model, q, qd, qdd, sincos(model, q))
    assert Y @ np.array(p, dtype=float) == pytest.approx(tau[2], abs=1e-11)


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize(
    ("twists", "kinds"),
    [
        ([0, 0], "rr"),
        ([pi / 2, 0, -pi / 2], "rrr"),
        ([0, 0, 0], "rpr"),
        ([pi / 2, -pi / 2, pi / 2], "rpr"),
        ([-pi / 2, pi / 2, 0], "prp"),
        ([pi / 2, symbol("alpha"), 0], "rrp"),
    ],
)
def test_exactly_linear_with_everything_symbolic(twists, kinds, convention):
    robot = symbolic(twists, kinds=kinds, convention=convention)
    assert exactly_linear(robot)
    robot.rotor_inertias = sp.symbols(f"J1:{robot.dof + 1}")
    robot.viscous_friction = sp.symbols(f"b1:{robot.dof + 1}")
    robot.coulomb_friction = [(sp.Symbol("p1"), sp.Symbol("n1")), *sp.symbols("f2 f3")][: robot.dof]
    assert exactly_linear(robot)


@pytest.mark.sweep
def test_exactly_linear_for_the_symbolic_puma():
    assert exactly_linear(symbolic_puma560())


def test_both_conventions_have_the_same_groups():
    a, d = sp.symbols("a1:5"), sp.symbols("d1:5")
    twists = [pi / 2, 0, -pi / 2, 0]
    qs = [joint_variable(i) for i in range(1, 5)]
    dh = mr.Robot(*zip(a, twists, d, qs, strict=True))
    before = [(0, 0), *zip(a, twists, strict=True)]
    mdh = mr.Robot(
        *((*x, y, q) for x, y, q in zip(before[:4], d, qs, strict=True)), convention="mdh"
    )
    dh.gravity = mdh.gravity = [0, 0, -g]
    assert dh.base_parameters().symbols == mdh.base_parameters().symbols
    assert dh.base_parameters().combinations == mdh.base_parameters().combinations


@pytest.mark.parametrize("seed", range(4))
def test_values_are_the_combinations_of_standard_parameters(seed):
    """Standard parameters by Steiner's theorem, here, of an arm in modified DH."""
    rng = random.Random(40 + seed)
    robot = random_robot(rng, 3, "mdh")
    standard = {}
    for i in (1, 2, 3):
        m, c, I = robot.m(i), robot.cm_positions[i - 1], robot.I_cm(i)
        J = I + m * (c.dot(c) * sp.eye(3) - c * c.T)
        for name in ("XX", "XY", "XZ", "YY", "YZ", "ZZ"):
            standard[sp.Symbol(f"{name}_{i}")] = J["XYZ".index(name[0]), "XYZ".index(name[1])]
        for k in range(3):
            standard[sp.Symbol(f"M{'XYZ'[k]}_{i}")] = m * c[k]
        standard[sp.Symbol(f"M_{i}")] = m
    for x in robot.base_parameters():
        assert sp.simplify(x.combination.subs(standard) - x.value) == 0


def test_sliding_joint_before_the_second_turning_one_has_two_first_moments():
    """Khalil & Dombre 2002, section 9.4.2.4: one of MX, MY, MZ joins the others, by the twist."""
    alpha = sp.Symbol("alpha")
    robot = symbolic([alpha, pi / 2, 0], kinds="rpr", a=False, d=False)
    found = {str(x.symbol): x.combination for x in robot.base_parameters()}
    assert "MZ_2" not in found
    MY, MZ, MZ3 = sp.symbols("MY_2 MZ_2 MZ_3")
    assert sp.simplify(found["MYR_2"] - (MY - sp.tan(alpha) * MZ - MZ3)) == 0
    across = symbolic([pi / 2, pi / 2, 0], kinds="rpr", a=False, d=False)
    names = {str(x).replace("R", "") for x in across.base_parameters().symbols}
    assert {"MX_2", "MZ_2"} < names
    assert "MY_2" not in names


def test_rotors_join_the_first_joints_and_stand_alone_further_on():
    robot = symbolic([pi / 2, 0, 0])
    robot.rotor_inertias = sp.symbols("J1:4")
    found = {str(x.symbol): x.value for x in robot.base_parameters()}
    assert found["ZZR_1"].has(sp.Symbol("J1"))
    assert found["ZZR_2"].has(sp.Symbol("J2"))  # axis 2 is at right angles to axis 1
    assert found["IA_3"] == sp.Symbol("J3")


def test_friction_is_among_the_parameters():
    robot = planar(2)
    robot.viscous_friction = [sp.Symbol("b1"), 0]
    robot.coulomb_friction = [(3, 1), 2]
    parameters = {str(x.symbol): x for x in robot.base_parameters()}
    assert [x for x in parameters if x.startswith("F")] == ["FV_1", "FC_1", "FD_1", "FC_2"]
    assert [parameters[x].value for x in ("FV_1", "FC_1", "FD_1", "FC_2")] == [
        sp.Symbol("b1"), 2, 1, 2
    ]  # fmt: skip
    assert parameters["FV_1"].unit == "N m s/rad"
    assert len(robot.base_parameters(zeros=True)) == 6 + 2 * 3


def test_bodies_need_not_be_given():
    robot = mr.Robot((l1, 0, 0, q1), (l2, 0, 0, q2))
    with pytest.raises(ValueError, match=r"gravity not set: robot\.gravity = "):
        robot.base_parameters()
    robot.gravity = [0, -g, 0]
    Y, p = robot.regressor()
    assert Y.shape == (2, 6)
    assert p == robot.base_parameters().combinations


def test_plain_symbols_as_joint_variables_have_base_parameters_too():
    x, y = sp.symbols("x y")
    robot = mr.Robot((l1, 0, 0, x), (l2, 0, 0, y))
    robot.gravity = [0, -g, 0]
    assert len(robot.base_parameters()) == 6
    with pytest.warns(UserWarning, match="regressor: velocities are zero, for x, y is no function"):
        Y, _ = robot.regressor()
    assert robot.simplify(Y[1, 4] - g * sp.cos(x + y)) == 0
    assert Y.free_symbols == {g, x, y}


def test_changing_what_is_returned_changes_nothing():
    robot = planar(2)
    Y, p = robot.regressor()
    Y[0, 0] = p[0] = sp.Integer(7)
    again = robot.regressor()
    assert again.Y[0, 0] == q1.diff(t, 2)
    assert again.p[0] != 7
    robot.masses = [1, 2]
    assert robot.regressor().p[3] == 2 * lc2


def test_parameters_print_as_a_table():
    parameters = planar(2).base_parameters()
    text = repr(parameters)
    assert text.splitlines()[0].split() == ["parameter", "combination", "value", "unit"]
    assert "MX_1 + M_2*l_1" in text
    assert r"\begin{array}" in parameters._repr_latex_()
    assert "<table " in parameters._repr_html_()
    assert [x.link for x in parameters] == [1, 1, 2, 2]
    assert [x.unit for x in parameters[:2]] == ["kg m^2", "kg m"]
    assert "0.632*MZ_3" in repr(bare("panda").base_parameters())
    assert "value" not in repr(symbolic_puma560().base_parameters()).splitlines()[0]


def test_a_random_point_respects_sums_and_products():
    ring = TrigRing()
    ring.declare_angles([(q1, q1), (q2, q1 + q2)])
    x, y = (
        ring.convert(e)
        for e in (
            sp.sin(q1) + l1 * sp.cos(q1 + q2) / 3 + sp.sqrt(2) * sp.sqrt(7),
            sp.sin(q1) ** 2 - sp.sqrt(14) * sp.sin(sp.Symbol("alpha")) + sp.cos(q2),
        )
    )
    point = RandomPoint(ring, [q1, q2], states=3)
    a, b = point.evaluate(x), point.evaluate(y)
    assert list(point.evaluate(x * y)) == list(a * b % point.prime)
    assert list(point.evaluate(x - y)) == list((a - b) % point.prime)
    assert len(set(a)) == 3
    assert len(set(point.convert(l1))) == 1


def test_dependences_of_rows():
    rows = [[1, 2, 0], [0, 0, 0], [2, 4, 0], [0, 1, 1], [1, 4, 2], [1, 0, 0]]
    assert dependences(rows, 101) == {1: [], 2: [0], 4: [0, 3]}


def test_dependences_modulo_small_and_large_primes():
    """Whole numbers of 64 bits where products fit, of any size elsewhere."""
    rng = random.Random(1)
    size = 2**31
    rows = [[rng.randrange(size) for _ in range(9)] for _ in range(4)]
    rows.insert(2, [3 * x - 5 * y for x, y in zip(*rows[:2], strict=True)])
    for prime in (2**31 - 1, 2**61 - 1):
        assert dependences([[x % prime for x in row] for row in rows], prime) == {2: [0, 1]}


def test_each_seed_has_its_own_prime():
    for roots in ([2], [2, 10007, 10009]):
        ring = TrigRing()
        values = [ring.convert(sp.sqrt(root)) for root in roots]
        points = [RandomPoint(ring, [], states=1, seed=seed) for seed in range(3)]
        assert len({point.prime for point in points}) == 3
        for point in points:
            for root, value in zip(roots, values, strict=True):
                assert (point.evaluate(value)[0] ** 2 - root) % point.prime == 0
