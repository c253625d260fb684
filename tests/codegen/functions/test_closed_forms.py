"""Closed forms beside recursions: kept where they are shorter, and no less accurate."""

import operator

import mpmath
import numpy as np
import pytest
import sympy as sp
from arms import random_model, reference_model

import moro as mr
import moro_codegen as mc
from moro.abc import q1, q2, q3
from moro.scalars.trig import TrigRing
from moro_codegen.functions.short_forms import ShortForms
from moro_codegen.graph import precise
from moro_codegen.graph.nodes import Graph
from moro_codegen.graph.rounding import no_less_accurate
from moro_codegen.passes import PASSES, Pass
from moro_codegen.program import generate

FUNCTIONS = (
    "gravity_vector", "inertia_matrix", "potential_energy", "jacobian", "forward_kinematics"
)  # fmt: skip
RECURSION = tuple(x for x in PASSES if x is not Pass.CLOSED_FORMS)

#: operations without sines, at most
COUNTS = {
    "two_link": {"gravity_vector": 4, "inertia_matrix": 3, "coriolis_matrix": 6, "bias": 14},
    "puma560": {"gravity_vector": 22, "inertia_matrix": 136, "potential_energy": 14},
    "stanford_arm": {"gravity_vector": 21, "inertia_matrix": 114, "potential_energy": 12},
    "ur5": {"gravity_vector": 16, "inertia_matrix": 102, "coriolis_matrix": 209},
    "panda": {"gravity_vector": 77, "inertia_matrix": 336, "potential_energy": 42},
}


def operations(routine):
    return sum(routine.ops[x] for x in ("add", "sub", "mul", "div"))


@pytest.mark.parametrize("name", COUNTS)
def test_operations(name):
    program = generate(reference_model(name), tuple(COUNTS[name]))
    found = {x.function.name: operations(x) for x in program.routines}
    assert all(found[name] <= most for name, most in COUNTS[name].items()), found


def models():
    rng = np.random.default_rng(3)
    yield from (reference_model(name) for name in ("two_link", "puma560"))
    yield from (random_model(rng, n) for n in (2, 3))


@pytest.mark.parametrize("model", [*models()], ids=lambda model: f"{model.name}-{model.nv}")
def test_no_less_accurate_near_states_where_terms_cancel(model):
    """Errors against 50 digits, near quarter turns and elsewhere: at most three times as large."""
    rng = np.random.default_rng(1)
    both = [generate(model, FUNCTIONS, passes=passes).routines for passes in (PASSES, RECURSION)]
    closed = [made for made in zip(*both, strict=True) if made[0].routes == ("closed form",)]
    assert closed
    for chosen, recursion in closed:
        for near in (None, 1e-3, 1e-6):
            q = rng.uniform(-1.5, 1.5, (12, model.nv))
            if near is not None:
                q = rng.integers(-1, 2, q.shape) * (np.pi / 2) + rng.uniform(-near, near, q.shape)
            ratio = np.log(errors(chosen, q)) - np.log(errors(recursion, q))
            assert ratio.mean() < np.log(3), (chosen.function.name, near)


def errors(routine, q):
    """The errors of a routine at postures, relative to its largest component; 2^-54 is none.

    Sines and cosines are those of exact angles: that sums of angles are rounded does not count.
    """
    graph, largest = routine.results[0].graph, []
    sines = [node for node in routine.schedule if node.op in ("sin", "cos")]
    for state in q:
        known = {graph.input("q", k): mpmath.mpf(x) for k, x in enumerate(state)}
        with mpmath.workdps(50):
            exact = precise.evaluate([*routine.results, *sines], known)
        values = {x: float(y) for x, y in known.items()}
        values |= dict(zip(sines, map(float, exact[len(routine.results) :]), strict=True))

        def value(node, values=values):
            return float(node.value) if node.op == "const" else values[node]

        for node in routine.schedule:
            if node not in values:
                values[node] = getattr(operator, node.op)(*map(value, node.args))
        pairs = [*zip(map(value, routine.results), exact, strict=False)]
        largest.append(float(max(abs(x - y) for x, y in pairs) / max(abs(y) for _, y in pairs)))
    return np.maximum(largest, 2.0**-54)


def test_what_cancels_is_no_candidate():
    """1 - c^2 where s^2 is asked for: no digit is left near a quarter turn."""
    graph = Graph()
    x = graph.input("q", 0)
    s, c = graph.sin(x), graph.cos(x)
    assert not no_less_accurate([1 - c * c], [s * s])
    assert no_less_accurate([s * s], [1 - c * c])
    assert no_less_accurate([2 * s * c], [s * c + c * s])


def test_formulas_with_parameters_and_couplings():
    """All formulas of a coupled arm with a parameter, a rotor and a slide, against recursions."""
    m = sp.Symbol("m")
    robot = mr.Robot((0.3, 0.4, 0, q1), (0, 1, 0.2, q1 - q2), (0.1, 0, q3, 0, "p"), name="arm")
    robot.masses = [1, m, 2]
    robot.cm_positions = [[0.1, 0.2, 0.3]] * 3
    robot.inertia_tensors = [sp.diag(0.1, 0.2, 0.3)] * 3
    robot.gravity = [0, 0, -9.81]
    robot.rotor_inertias = [0.5, 0.25, 0.125]
    robot.parameters = {m: 3}
    names = (*FUNCTIONS, "coriolis_matrix", "kinetic_energy", "bias", "tau")
    rng = np.random.default_rng(0)
    motion = dict(zip(("q", "qd", "qdd"), rng.uniform(-1, 1, (3, 3)), strict=True))
    for routine in generate(robot, names, passes=RECURSION).routines:
        graph = routine.results[0].graph
        forms = ShortForms(robot.model())
        name = routine.function.name
        formula = "pose" if name == "forward_kinematics" else name
        inputs = [[graph.input(a.name, k) for k in range(3)] for a in routine.inputs]
        made = [*forms.nodes(formula, graph, {m: graph.input("parameters", 0)}, inputs, 10_000)]
        assert made
        known = {x: mpmath.mpf(v) for a, row in zip(routine.inputs, inputs, strict=True)
                 for x, v in zip(row, motion[a.name], strict=True)}  # fmt: skip
        known[graph.input("parameters", 0)] = mpmath.mpf(3)
        expected = precise.evaluate(routine.results, known)
        rotors = np.array([0.5, 0.25, 0.125]) * motion["qdd"] if name == "tau" else [0] * 99
        for nodes in made:
            found = precise.evaluate(nodes, known)
            for x, y, extra in zip(found, expected, rotors, strict=False):
                assert abs(x + extra - y) < 1e-13, name


def test_long_ones_are_given_up():
    """After so many products, whatever the machine: the same for a seven-joint arm every time."""
    forms = ShortForms(reference_model("panda"))
    graph = Graph()
    q = [graph.input("q", k) for k in range(7)]
    assert not [*forms.nodes("inertia_matrix", graph, {}, [q], 10**6)]
    assert not [*forms.nodes("gravity_vector", graph, {}, [q], 100)]
    assert not [*forms.nodes("tau", graph, {}, [q, q, q], 10**6)]
    ring = TrigRing()
    a, b = (ring.convert(sp.Symbol(x)) + 1 for x in "ab")
    ring.allow(4)
    assert a * b
    with pytest.raises(TimeoutError, match="more products than allowed"):
        a * b


def test_several_in_one_call_take_no_more_than_alone():
    """Where they share the recursion, it is taken for both."""
    for name in ("two_link", "stanford_arm"):
        made = generate(reference_model(name), ("tau", "inertia_matrix", ("tau", "inertia_matrix")))
        alone, other, both = (operations(x) for x in made.routines)
        assert both <= alone + other


def test_the_manifest_says_by_which_route(tmp_path):
    robot = mr.load("two_link")
    functions = ("tau", "gravity_vector", ("tau", "gravity_vector"), mc.Function("own", q1))
    kernel = mc.compile(robot, functions, tmp_path, backend="numpy")
    routes = [[x["route"] for x in f["parts"]] for f in kernel.manifest["functions"]]
    assert routes[:2] == [["recursion"], ["closed form"]]
    assert len(routes[2]) == 2
    assert routes[3] == ["expression"]
