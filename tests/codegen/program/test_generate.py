"""Programs of tau: right on every arm, with few operations, and well formed."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from arms import (
    NAMES,
    decimal,
    model_from_rows,
    numeric,
    random_bodies,
    random_model,
    random_state,
    reference_model,
    reference_states,
    sincos,
)
from exact import EXACT, exact_arm, exact_state, exact_values, point_torques
from programs import evaluate
from recursion import inverse_dynamics

import moro as mr
from moro import Robot
from moro.abc import q1, q2, q3
from moro.algorithms.drives import Functions, drive_torques
from moro.model import Parameter
from moro_codegen.program import generate

#: additions, subtractions and multiplications of tau without friction and rotor inertia
OPERATIONS = {"puma560": 276, "stanford_arm": 228, "panda": 519, "ur5": 206, "two_link": 23}


def arithmetic(ops):
    return ops["add"] + ops["sub"] + ops["mul"]


def with_parameters(model, defaults):
    return replace(model, parameters=tuple(Parameter(s, x) for s, x in defaults.items()))


def tau(model, **options):
    (routine,) = generate(model, **options).routines
    return routine


def expected_tau(model, q, qd, qdd):
    model = numeric(model)
    rigid = np.array(inverse_dynamics(model, q, qd, qdd, sincos(model, q)))
    return rigid + drive_torques(model, qd, qdd, Functions(np.sign, np.tanh, np.exp))


def assert_close(result, expected, tolerance=1e-12):
    assert np.abs(result - expected).max() <= tolerance * np.abs(expected).max()


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model = mr.load(name).model()
    for key, rigid in (("tau", False), ("tau_rigid", True)):
        routine = tau(model, rigid=rigid)
        for state in reference_states(name):
            (result,) = evaluate(routine, state["q"], state["qd"], state["qdd"])
            assert_close(result, np.array(state[key]))


@pytest.mark.parametrize("name", NAMES)
def test_operations(name):
    ops = tau(reference_model(name), rigid=True).ops
    assert arithmetic(ops) <= OPERATIONS[name]
    assert ops["div"] == ops["sign"] == ops["call"] == 0


def test_ignored_angles():
    """The first axis is vertical and the last body symmetric: neither angle has a sine."""
    routine = tau(reference_model("puma560"))
    used = {node.value for angle in routine.angles for node in [angle, *angle.args]}
    assert ("q", 1) in used
    assert not used & {("q", 0), ("q", 5)}


@pytest.mark.parametrize("tree", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_random_arms(seed, tree):
    rng = np.random.default_rng(seed)
    model = random_model(rng, int(rng.integers(1, 9)), tree)
    routine = tau(model)
    q, qd, qdd = rng.uniform(-3, 3, (3, 20, model.dof))
    (result,) = evaluate(routine, q, qd, qdd)
    assert_close(result, expected_tau(model, q.T, qd.T, qdd.T).T)


@pytest.mark.parametrize("seed", range(8))
def test_exact(seed):
    """The whole program in fractions, against point masses: not even rounding differs."""
    rng = np.random.default_rng(100 + seed)
    model, points = exact_arm(rng, 6, tree=seed % 2 == 1)
    pairs, q, qd, qdd = exact_state(rng, 6)
    values = exact_values(tau(model, passes=EXACT).results, {"q": q, "qd": qd, "qdd": qdd}, pairs)
    assert values == point_torques(model, points, pairs, q, qd, qdd)


def test_form():
    """Operands before what is made of them, angles and their sines first, shapes in numbers."""
    program = generate(reference_model("panda"))
    assert (program.name, program.dof, program.parameters) == ("panda", 7, ())
    assert program.joint_kinds == ("revolute",) * 7
    (routine,) = program.routines
    assert [a.shape for a in (*routine.inputs, *routine.outputs)] == [(7,)] * 4
    assert len(routine.results) == 7
    place = {node: i for i, node in enumerate(routine.schedule)}
    assert len(place) == len(routine.schedule)
    for node, i in place.items():
        assert node.op not in ("const", "input")
        assert all(place.get(operand, -1) < i for operand in node.args)
    assert all(not node.args or node in place for node in routine.results)
    trig = [i for node, i in place.items() if node.op in ("sin", "cos")]
    assert max(trig) == len(trig) + sum(angle in place for angle in routine.angles) - 1
    assert {node.args[0] for node in place if node.op in ("sin", "cos")} == set(routine.angles)
    assert routine.ops["sincos"] == len(routine.angles) == 6


def test_friction_is_never_forgotten():
    model = reference_model("puma560")
    q = qdd = np.zeros(6)
    for direction in (1, -1, 0):
        qd = np.full(6, direction * 1e-9)
        (full,) = evaluate(tau(model), q, qd, qdd)
        (rigid,) = evaluate(tau(model, rigid=True), q, qd, qdd)
        side = 0 if direction > 0 else 1
        coulomb = [direction * float(x.drive.coulomb[side]) for x in model.coordinates]
        np.testing.assert_allclose(full - rigid, coulomb, rtol=1e-8, atol=1e-10)


def symbolic_robot():
    """A spatial arm with lengths, twists, masses and gravity left free."""
    a, d, alpha, m, payload, g = symbols = sp.symbols("a d alpha m payload g", real=True)
    robot = Robot(
        (0, sp.pi / 2, d, q1), (a, alpha, 0, q2), (sp.sqrt(a * d), 0, d / 2, q3), convention="dh"
    )
    robot.masses = [1, m, sp.Rational(1, 2) + payload]
    robot.cm_positions = [[0, 0, d / 3], [-a / 2, 0, 0], [0, sp.Rational(1, 10), 0]]
    robot.inertia_tensors = [
        sp.diag(1, 2, 3),
        m * a**2 / 12 * sp.eye(3),
        sp.diag(payload / 10, 1, 2),
    ]
    robot.gravity = [0, 0, -g]
    return robot.model(), symbols


def test_run_time_parameters():
    """Free symbols of the geometry and the bodies: the same torques as with numbers put in."""
    model, symbols = symbolic_robot()
    program = generate(with_parameters(model, dict.fromkeys(symbols) | {symbols[-1]: 9.81}))
    names = ["a", "d", "alpha", "m", "payload", "g"]
    assert [p.name for p in program.parameters] == names
    assert [p.default for p in program.parameters] == [None] * 5 + [9.81]
    (routine,) = program.routines
    rng = np.random.default_rng(0)
    for values in rng.uniform(0.2, 2, (5, 6)):
        numbers = model.map(
            lambda x, v=values: sp.sympify(x).subs(dict(zip(symbols, v, strict=True)))
        )
        q, qd, qdd = random_state(rng, 3)
        (result,) = evaluate(routine, q, qd, qdd, parameters=values)
        assert_close(result, expected_tau(numbers, q, qd, qdd))


def test_a_payload_costs_little():
    """One free mass does not make parameters of all the arm's numbers."""
    model = reference_model("ur5")
    payload = sp.Symbol("payload", real=True)
    last = model.bodies[-1]
    heavier = type(last)(last.mass + payload, last.first_moment, last.inertia)
    loaded = type(model)(
        model.name, model.joints, (*model.bodies[:-1], heavier), model.gravity, model.frames
    )
    ops = tau(with_parameters(loaded, {payload: 0}), rigid=True).ops
    assert arithmetic(ops) <= OPERATIONS["ur5"] + 35


def test_what_is_not_a_parameter():
    model, symbols = symbolic_robot()
    with pytest.raises(ValueError, match="payload"):
        generate(with_parameters(model, dict.fromkeys(set(symbols) - {symbols[4]})))


def test_unknown_function():
    with pytest.raises(ValueError, match="no function 'tua'; did you mean 'tau'"):
        generate(reference_model("two_link"), ("tau", "tua"))


def test_linear_growth():
    """Operations per joint do not grow with the number of joints."""
    rng = np.random.default_rng(0)
    rows = [(decimal(rng), (-1) ** i * sp.pi / 2, decimal(rng), 0, "r") for i in range(40)]
    bodies = [*random_bodies(rng, 10)] * 4

    def operations(n):
        model = model_from_rows(rows[:n], "mdh", bodies[:n], [0, 0, sp.Rational(-981, 100)])
        return arithmetic(tau(model).ops)

    few, more, many = map(operations, (10, 20, 40))
    assert many - more <= 2 * (more - few) + 20
