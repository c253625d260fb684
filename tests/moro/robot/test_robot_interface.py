"""Robot as a person meets it: what goes in, what comes out, and what a wrong input is told."""

import math
import random

import numpy as np
import pytest
import sympy as sp
from robots import complete, full_tensor, planar, random_robot, two_links

from moro import Robot
from moro.abc import (
    a1,
    alpha,
    alpha1,
    d1,
    d3,
    g,
    joint_variable,
    l1,
    l2,
    m1,
    m2,
    q1,
    q2,
    q3,
    symbol,
    t,
)

pi = sp.pi
x, y = sp.symbols("x y")


class TestCopies:
    def test_changing_lists_changes_nothing(self):
        robot = complete()
        robot.coulomb_friction, robot.rotor_inertias = [(1, 2), 3], [4, 5]
        names = ["joint_types", "qs", "dh_parameters", "masses", "cm_positions", "inertia_tensors"]
        names += ["joint_limits", "coulomb_friction", "rotor_inertias", "Ts"]
        for name in names:
            before = getattr(robot, name)
            changed = getattr(robot, name)
            changed[0] = 0
            changed.append(1)
            assert getattr(robot, name) == before, name
        robot.parameters.clear()
        assert l1 in robot.parameters

    def test_changing_matrices_changes_nothing(self):
        robot = complete()
        robot.cm_positions[0][0] = robot.inertia_tensors[1][2, 2] = robot.gravity[1] = 7
        robot.I_cm(1)[0, 0] = robot.Ts[0][0, 0] = robot.T[0, 0] = robot.J[0, 0] = 7
        assert robot.cm_positions[0] == sp.Matrix([-x, 0, 0])
        assert robot.gravity == sp.Matrix([0, -g, 0])
        assert not (robot.I_cm(2) + robot.I_cm(1)).has(7)
        for method in ("inertia_matrix", "coriolis_matrix", "gravity_vector"):
            before = getattr(robot, method)()
            getattr(robot, method)()[0] = 7
            assert getattr(robot, method)() == before
        for method in ("T_i0", "R_i0", "r_o", "z", "J_cm_i", "r_cm", "I_cm0", "v_cm", "w"):
            before = getattr(robot, method)(1)
            getattr(robot, method)(1)[0] = 7
            assert getattr(robot, method)(1) == before
        before = robot.dynamic_model()
        robot.dynamic_model().clear()
        assert robot.dynamic_model() == before

    def test_what_was_given_comes_back_and_is_exact_inside(self):
        values = {
            "masses": [1.2, x],
            "cm_positions": [sp.Matrix([0.1, 0, 0])] * 2,
            "inertia_tensors": [sp.diag(0.3, 0.3, x)] * 2,
            "gravity": sp.Matrix([0, -9.81, 0]),
            "rotor_inertias": [0.1, 0],
            "viscous_friction": [0.7, x],
            "coulomb_friction": [(0.1, 0.2), (x, 0.3)],
            "joint_limits": [(-1.3, 1.3), (-sp.pi, 0.1)],
        }
        robot = two_links(**values)
        for name, value in values.items():
            assert getattr(robot, name) == value
        assert (robot.m(1), robot.I_cm(2)) == (1.2, values["inertia_tensors"][1])
        assert robot.arm.masses == (sp.Rational("1.2"), x)
        assert robot.arm.gravity[1] == -sp.Rational("9.81")
        again = robot.with_parameters({x: 0.4})
        assert again.masses == [1.2, 0.4]
        assert again.coulomb_friction == [(0.1, 0.2), (0.4, 0.3)]
        assert again.arm.masses[1] == sp.Rational("0.4")

    def test_changing_what_was_given_changes_nothing(self):
        masses, r, I = [m1, m2], sp.Matrix([x, 0, 0]), np.eye(3)
        positions, tensors, row = [r, r], [I, I], [l1, 0, 0, q1]
        robot = Robot(row, (l2, 0, 0, q2))
        robot.masses, robot.cm_positions, robot.inertia_tensors = masses, positions, tensors
        row[0] = masses[0] = r[0] = I[0, 0] = 7
        positions.clear()
        assert robot.masses == [m1, m2]
        assert robot.cm_positions == [sp.Matrix([x, 0, 0])] * 2
        assert robot.I_cm(1) == sp.Matrix(np.eye(3))
        assert robot.dh_parameters[0][0] == l1

    def test_setting_drops_what_was_computed_from_older_values(self):
        methods = ["inertia_matrix", "coriolis_matrix", "gravity_vector", "kinetic_energy"]
        methods += ["potential_energy", "lagrangian", "dynamic_model", "friction_vector"]
        methods += ["base_parameters", "regressor"]
        values = {
            "masses": [3, 4],
            "cm_positions": [[1, 0, 0], [2, 0, 0]],
            "inertia_tensors": [sp.eye(3) * 5] * 2,
            "gravity": [0, 0, -5],
            "rotor_inertias": [6, 7],
            "viscous_friction": [8, 9],
            "coulomb_friction": [1, (2, 3)],
        }
        used, set_so_far = complete(), {}
        for name, value in values.items():
            before = [getattr(used, method)() for method in methods]
            set_so_far[name] = value
            fresh = complete()
            for robot, settings in ((used, {name: value}), (fresh, set_so_far)):
                for key, setting in settings.items():
                    setattr(robot, key, setting)
            after = [getattr(used, method)() for method in methods]
            assert list(map(str, after)) == [str(getattr(fresh, method)()) for method in methods]
            assert list(map(str, after)) != list(map(str, before)), name


# -- warnings -------------------------------------------------------------------------------------

VELOCITY_DEPENDENT = ["v_cm", "w", "w_rel0", "link_kinetic_energy", "q_dot"]
VELOCITY_DEPENDENT_WHOLE = ["kinetic_energy", "lagrangian", "coriolis_matrix", "dynamic_model"]
VELOCITY_DEPENDENT_WHOLE += ["dynamic_model_matrix_form", "friction_vector", "regressor"]


class TestWarnings:
    def robot(self):
        robot = Robot((l1, 0, 0, x), (l2, 0, 0, q2))
        robot.masses = robot.inertia_tensors = None
        robot.cm_positions, robot.gravity = [[0, 0, 0]] * 2, [0, -g, 0]
        robot.viscous_friction = [1, 2]
        return robot

    @pytest.mark.parametrize("method", VELOCITY_DEPENDENT + VELOCITY_DEPENDENT_WHOLE)
    def test_velocities_of_plain_symbols(self, method):
        arguments = (1,) if method in VELOCITY_DEPENDENT else ()
        with pytest.warns(UserWarning, match=rf"{method}: .*for x is no function.*moro\.abc") as w:
            getattr(self.robot(), method)(*arguments)
        assert len(w) == 1
        assert w[0].filename == __file__

    def test_velocities_are_zero_then(self):
        with pytest.warns(UserWarning, match="v_cm"):
            assert self.robot().v_cm(1) == sp.zeros(3, 1)
        with pytest.warns(UserWarning, match="kinetic_energy"):
            energy = self.robot().kinetic_energy()
        assert energy == (m2 * l2**2 + sp.Symbol("I_{z_2z_2}")) * q2.diff(t) ** 2 / 2
        with pytest.warns(UserWarning, match="dynamic_model"):
            equations = self.robot().dynamic_model()
        assert not any(e.has(x.diff(t)) or e.atoms(sp.Dummy) for e in equations)

    def test_what_needs_no_velocities_does_not_warn(self):
        robot = self.robot()
        for method in ("inertia_matrix", "gravity_vector", "potential_energy", "base_parameters"):
            getattr(robot, method)()
        robot.J_cm_i(1)
        assert robot.T.shape == (4, 4)
        assert robot.q_dot(2) == q2.diff(t)

    def test_functions_of_time_do_not_warn(self):
        robot = complete()
        for method in VELOCITY_DEPENDENT:
            getattr(robot, method)(1)
        for method in VELOCITY_DEPENDENT_WHOLE:
            getattr(robot, method)()


# -- geometry -------------------------------------------------------------------------------------


def turn(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    T = np.eye(4)
    j, k = {"x": (1, 2), "z": (0, 1)}[axis]
    T[j, j] = T[k, k] = c
    T[j, k], T[k, j] = -s, s
    return T


def shift(axis, length):
    T = np.eye(4)
    T["xyz".index(axis), 3] = length
    return T


def link_transform(row, convention):
    a, twist, d, theta = (float(value) for value in row[:4])
    about_x, about_z = shift("x", a) @ turn("x", twist), turn("z", theta) @ shift("z", d)
    return about_z @ about_x if convention == "dh" else about_x @ about_z


def numbers(matrix, state):
    return np.array(sp.Matrix(matrix).subs(state).evalf(20), dtype=float)


GEOMETRIES = {
    "symbols": [(a1, alpha1, d1, q1), (0, 0, 0, q2 + alpha), (l1, -alpha, q3 + d3, x, "p")],
    "offsets": [(a1, pi / 2, 0.3, q1 + pi / 2), (0.2, 0, 0, q2 - pi), (0, pi, q3 + 0.5, 1.1, "p")],
    "floats": [
        (0.1, 1.5707963267948966, 0.2, q1 + 0.3),
        (0, -np.pi / 2, q2, 0, "p"),
        (1, 1, 1, q3),
    ],
    "parallel": [(a1, 0, 0, q1), (l1, pi, 0, q2 + pi / 3), (l2, 0, d3, q3)],
}


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("name", GEOMETRIES)
def test_frames_against_products_of_matrices(name, convention):
    rows = GEOMETRIES[name]
    robot = Robot(*rows, convention=convention)
    rng = random.Random(name)
    state = {s: rng.uniform(-2, 2) for s in [*robot.qs, *robot.parameters]}
    steps = [
        link_transform([sp.sympify(v).subs(state) for v in row[:4]], convention) for row in rows
    ]
    frames = [np.eye(4)]
    for i, step in enumerate(steps, 1):
        frames.append(frames[-1] @ step)
        np.testing.assert_allclose(numbers(robot.Ts[i - 1], state), step, atol=1e-12)
    np.testing.assert_allclose(numbers(robot.T, state), frames[-1], atol=1e-12)
    for i in range(4):
        np.testing.assert_allclose(numbers(robot.R_i0(i), state), frames[i][:3, :3], atol=1e-12)
        np.testing.assert_allclose(numbers(robot.r_o(i), state)[:, 0], frames[i][:3, 3], atol=1e-12)
        np.testing.assert_allclose(numbers(robot.z(i), state)[:, 0], frames[i][:3, 2], atol=1e-12)
        for j in range(4):
            expected = np.linalg.inv(frames[j]) @ frames[i]
            np.testing.assert_allclose(numbers(robot.T_ij(i, j), state), expected, atol=1e-12)


def test_frames_seen_from_each_other_are_inverse():
    robot = Robot(*GEOMETRIES["symbols"])
    for i in range(4):
        assert robot.T_ij(i, i) == sp.eye(4)
        for j in range(4):
            assert robot.simplify(robot.T_ij(i, j) * robot.T_ij(j, i)) == sp.eye(4)


@pytest.mark.parametrize("seed", range(6))
def test_jacobian_of_a_point_against_differences(seed):
    rng = random.Random(seed)
    robot = random_robot(rng, 4, rng.choice(["dh", "mdh"]))
    link = rng.randint(1, 4)
    point = [rng.uniform(-1, 1) for _ in range(3)]
    T = robot.T_i0(link)
    state = {q: rng.uniform(-2, 2) for q in robot.qs}
    J = numbers(robot.J_point(point, link), state)
    assert J.shape == (6, 4)
    h = 1e-5
    for k, q in enumerate(robot.qs):
        ahead, behind = (numbers(T, state | {q: state[q] + s * h}) for s in (1, -1))
        rate = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(J[:3, k], (rate @ [*point, 1])[:3], atol=1e-8)
        W = rate[:3, :3] @ numbers(T, state)[:3, :3].T
        np.testing.assert_allclose(J[3:, k], [W[2, 1], W[0, 2], W[1, 0]], atol=1e-8)


def test_jacobian_of_a_tool_point():
    robot = two_links()
    tool = robot.J_point([x, y, 0], 2)
    expected = -(l2 + x) * sp.sin(q1 + q2) - y * sp.cos(q1 + q2)
    assert sp.expand(tool[0, 1] - expected) == 0
    assert robot.J_point(sp.Matrix([0, 0, 0]), 2) == robot.J
    assert robot.J_point([0, 0, 0], 1)[:, 1] == sp.zeros(6, 1)


def test_jacobians_of_centres_of_mass():
    robot = complete()
    for i in (1, 2):
        assert robot.J_cm_i(i) == robot.J_point(robot.cm_positions[i - 1], i)
        assert robot.J_cm_i(i) == robot.Jv_cm_i(i).col_join(robot.Jw_cm_i(i))


def test_relative_angular_velocities_add_up():
    robot = Robot((0, pi / 2, d1, q1), (l2, 0, 0, q2), (0, 0, q3, 0, "p"))
    total = sp.zeros(3, 1)
    for i in (1, 2, 3):
        total += robot.w_rel0(i)
        assert robot.simplify(total - robot.w(i)) == sp.zeros(3, 1)
    assert robot.w_rel0(2) == q2.diff(t) * robot.z(1)
    assert robot.w_rel0(3) == sp.zeros(3, 1)


# -- as a whole -----------------------------------------------------------------------------------


def test_shapes_of_everything():
    robot = complete()
    for method, shape in {
        "inertia_matrix": (2, 2),
        "coriolis_matrix": (2, 2),
        "gravity_vector": (2, 1),
        "friction_vector": (2, 1),
    }.items():
        assert getattr(robot, method)().shape == shape
    for method, shape in {
        "r_cm": (3, 1),
        "v_cm": (3, 1),
        "w": (3, 1),
        "w_rel0": (3, 1),
        "I_cm": (3, 3),
        "I_cm0": (3, 3),
        "J_cm_i": (6, 2),
        "Jv_cm_i": (3, 2),
        "Jw_cm_i": (3, 2),
        "T_i0": (4, 4),
        "R_i0": (3, 3),
        "r_o": (3, 1),
        "z": (3, 1),
    }.items():
        assert getattr(robot, method)(1).shape == shape
    for energy in (robot.kinetic_energy(), robot.link_potential_energy(1), robot.lagrangian()):
        assert isinstance(energy, sp.Expr)
    equations = robot.dynamic_model()
    assert [equation.rhs for equation in equations] == list(sp.symbols("tau_1 tau_2"))


class TestWithParameters:
    def test_values_are_put_in_everywhere(self):
        robot = complete()
        robot.viscous_friction, robot.coulomb_friction = [x, 1], [(x, y), 0]
        robot.rotor_inertias = [m1, 0]
        values = {l1: 2, "l_2": sp.Rational(1, 2), x: 3, m1: 5, g: 10}
        new = robot.with_parameters(values)
        symbols = {sp.Symbol(str(key)): value for key, value in values.items()}
        assert new.masses == [5, m2]
        assert new.cm_positions[0] == sp.Matrix([-3, 0, 0])
        assert new.gravity == sp.Matrix([0, -10, 0])
        assert new.viscous_friction == [3, 1]
        assert new.coulomb_friction == [(3, y), (0, 0)]
        assert new.rotor_inertias == [5, 0]
        for method in ("inertia_matrix", "coriolis_matrix", "gravity_vector", "friction_vector"):
            difference = getattr(robot, method)().subs(symbols) - getattr(new, method)()
            assert new.simplify(difference) == sp.zeros(*difference.shape)
        assert robot.masses == [m1, m2]
        assert set(new.parameters) == set(robot.parameters) - set(symbols)

    def test_the_rest_is_kept(self):
        robot = Robot((l1, alpha, d1, q1), (0, 0, q2 + d3, x, "p"), convention="mdh", name="an_arm")
        robot.masses, robot.joint_limits = None, [(-1, 1), (0, 2)]
        robot.parameters = {d1: 2, d3: 1}
        new = robot.with_parameters({l1: 1, d1: 3})
        assert (new.name, new.convention, new.joint_limits) == ("an_arm", "mdh", [(-1, 1), (0, 2)])
        assert new.parameters[d3] == 1
        assert ("masses", "assumed") in [row[:2] for row in new.model_summary()]
        assert new.dh_parameters == [(1, alpha, 3, q1), (0, 0, q2 + d3, x)]

    def test_symbols_may_change_places(self):
        new = two_links().with_parameters({l1: l2, l2: l1})
        assert [row[0] for row in new.dh_parameters] == [l2, l1]

    def test_floats_count_as_decimals_and_angles_as_quarter_turns(self):
        robot = Robot((l1, alpha, 0, q1), (l2, 0, 0, q2))
        new = robot.with_parameters({alpha: math.pi / 2, l1: 0.1})
        assert new.T[0, 2] == sp.sin(q1)
        assert new.r_o(1)[0] == 0.1 * sp.cos(q1)
        assert new.arm.rows[0].a == sp.Rational(1, 10)

    def test_nothing_to_put_in(self):
        assert two_links().with_parameters({}).dh_parameters == two_links().dh_parameters

    @pytest.mark.parametrize(
        ("values", "error", "message"),
        [
            ({x: 1}, ValueError, "x is not a symbol of the model; its symbols are l_1, l_2, m_1"),
            ({"l_3": 1}, ValueError, 'l_3 is not a symbol .*did you mean "l_'),
            ({q1: 1}, ValueError, r"q_1\(t\) is not a symbol of the model"),
            ({l1: 1, "l_1": 2}, ValueError, "l_1 is given two values"),
            ({l1: float("nan")}, ValueError, "value of l_1 must be finite, not nan"),
            ({l1: 1j}, ValueError, "value of l_1 must be real"),
            ({l1: "1"}, TypeError, "value of l_1 must be a number .*not '1'"),
            ({l1: None}, TypeError, "value of l_1 must be a number .*not None"),
            ({l1: q1}, ValueError, "value of l_1 must be constant"),
            ({m1: -1}, ValueError, "m_1 of masses must not be negative, not -1"),
            ([(l1, 1)], TypeError, "values must be a dictionary"),
            (None, TypeError, "values must be a dictionary"),
        ],
    )
    def test_wrong_values(self, values, error, message):
        with pytest.raises(error, match=message):
            two_links(masses=None).with_parameters(values)


class TestParameters:
    def test_are_the_free_symbols_of_the_model(self):
        robot = complete()
        assert set(robot.parameters) == {
            *(l1, l2, x, y, g, m1, m2),
            *(I for tensor in robot.inertia_tensors for I in tensor.free_symbols),
        }
        assert set(robot.parameters.values()) == {None}

    def test_defaults_come_first_and_in_order(self):
        robot = two_links(parameters={l2: 0.5, "l_1": 2})
        assert list(robot.parameters.items()) == [(l2, sp.Rational(1, 2)), (l1, 2)]

    @pytest.mark.parametrize(
        ("defaults", "error", "message"),
        [
            (None, TypeError, "parameters must be a dictionary"),
            ([l1], TypeError, "parameters must be a dictionary"),
            ({1: 1}, TypeError, "a parameter must be a symbol or its name, not 1"),
            ({q1: 1}, TypeError, "a parameter must be a symbol or its name"),
            ({l1: "1"}, TypeError, "default of l_1 must be a number"),
            ({l1: l2}, TypeError, "default of l_1 must be a number, not l_2"),
            ({l1: float("inf")}, ValueError, "default of l_1 must be finite"),
            ({"l1": 2}, ValueError, 'l1 is not a symbol of the model.*did you mean "l_1"'),
            ({"L_1": 2}, ValueError, 'did you mean "l_1"'),
            ({x: 1}, ValueError, "x is not a symbol of the model; its symbols are l_1, l_2"),
        ],
    )
    def test_wrong_defaults(self, defaults, error, message):
        with pytest.raises(error, match=message):
            two_links(parameters=defaults)


def test_declared_parameters_need_not_occur():
    robot = two_links()
    robot.declare({x: 2, "l_1": 1})
    assert list(robot.parameters.items()) == [(x, 2), (l1, 1), (l2, None)]
    assert list(robot.with_parameters({x: 1}).parameters) == [l1, l2]
    robot.parameters = {x: 3}
    assert robot.parameters[x] == 3


def test_model_summary():
    robot = two_links(masses=[1, x], inertia_tensors=None, joint_limits=[(-1, 1), (0, 1)])
    summary = {row[0]: row[1:] for row in robot.model_summary()}
    assert summary["rows"] == ("given", "2, dh, rr")
    assert summary["masses"] == ("given", "[1, x]")
    assert summary["inertia_tensors"][0] == "assumed"
    assert summary["cm_positions"] == (
        "not set",
        "robot.cm_positions = [[x, y, z], ...], in frame i",
    )
    assert summary["gravity"][0] == "not set"
    assert summary["viscous_friction"] == ("not set", "none; robot.viscous_friction = [value, ...]")
    assert summary["joint_limits"] == ("given", "[(-1, 1), (0, 1)]")
    assert two_links().model_summary()[-1][:2] == ("joint_limits", "assumed")
    robot.inertia_tensors = [full_tensor(1), full_tensor(2)]
    assert {row[0]: row[1] for row in robot.model_summary()}["inertia_tensors"] == "given"
    assert repr(robot.model_summary()).splitlines()[0].split() == ["quantity", "state", "value"]


def test_robots_print_themselves():
    robot = planar(2)
    assert repr(robot) == "<Robot robot: 2 joints RR, convention dh>"
    assert robot._repr_latex_().startswith("$")


def test_symbols_of_abc():
    from moro import abc

    assert abc.t == t == sp.Symbol("t")
    assert [abc.q1, abc.q6, abc.q12] == [joint_variable(i) for i in (1, 6, 12)]
    assert str(abc.q1) == "q_1(t)"
    for letter in ("l", "d", "m", "a", "alpha", "theta", "g", "tau"):
        assert getattr(abc, letter) == sp.Symbol(letter) == symbol(letter)
        assert getattr(abc, f"{letter}3") == sp.Symbol(f"{letter}_3") == symbol(letter, 3)
    assert (abc.lc, abc.lc3) == (symbol("lc"), symbol("lc", 3)) == sp.symbols("l_c l_c3")
    assert (sp.latex(abc.lc), sp.latex(abc.lc3)) == ("l_{c}", "l_{c3}")
    assert (abc.qd2, abc.qdd12) == (q2.diff(t), joint_variable(12).diff(t, 2))
    assert (abc.beta, abc.omega) == sp.symbols("beta omega")
    assert not {"pi", "I", "lambda"} & set(abc.__all__)
