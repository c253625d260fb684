"""Every function: exactly what the algorithms say of the arm, in graphs and in kernels."""

import math
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from arms import NAMES, numeric, sincos
from dynamics import arrays, exact_case
from exact import EXACT, exact_values, rational
from recursion import (
    coriolis_matrix,
    forward_dynamics,
    forward_kinematics,
    inertia_matrix,
    inverse_dynamics,
    inverse_dynamics_in_contact,
    jacobian,
    kinetic_energy,
    potential_energy,
)
from robots import random_robot

import moro as mr
import moro_codegen as mc
from moro.abc import q1, q2, q3, q4
from moro.algorithms.articulated_body import joint_accelerations
from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.drives import Functions, drive_torques
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.newton_euler import joint_torques
from moro.model import Coordinate
from moro_codegen.functions.catalogue import FUNCTIONS
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, count, schedule
from moro_codegen.passes import equivalent_postures
from moro_codegen.program import generate


class Algorithms:
    """What every function is, by the algorithms on the model as it is; any numbers."""

    def __init__(self, model, pairs, q, sign=np.sign):
        self.model, self.pairs, self.q, self.sign = model, pairs, q, sign
        self.still = [0] * model.dof

    def drives(self, qd, qdd):
        return drive_torques(self.model, qd, qdd, Functions(self.sign, math.tanh, math.exp))

    def tau(self, qd, qdd):
        rigid = inverse_dynamics(self.model, self.q, qd, qdd, self.pairs)
        return [x + y for x, y in zip(rigid, self.drives(qd, qdd), strict=True)]

    def tau_with_wrench(self, qd, qdd, w):
        rigid = inverse_dynamics_in_contact(self.model, self.q, qd, qdd, w, self.pairs)
        return [x + y for x, y in zip(rigid, self.drives(qd, qdd), strict=True)]

    def bias(self, qd):
        return self.tau(qd, self.still)

    def gravity_vector(self):
        return inverse_dynamics(self.model, self.q, self.still, self.still, self.pairs)

    def inertia_matrix(self):
        return inertia_matrix(self.model, self.q, self.pairs)

    def coriolis_matrix(self, qd):
        return coriolis_matrix(self.model, self.q, qd, self.pairs)

    def forward_dynamics(self, qd, tau):
        left = [x - y for x, y in zip(tau, self.drives(qd, self.still), strict=True)]
        return forward_dynamics(self.model, self.q, qd, left, self.pairs)

    def forward_kinematics(self):
        pose = forward_kinematics(self.model, self.q, self.pairs)
        return [[*row, x] for row, x in zip(pose.R, pose.p, strict=True)] + [[0, 0, 0, 1]]

    def jacobian(self):
        return jacobian(self.model, self.q, self.pairs)

    def kinetic_energy(self, qd):
        return kinetic_energy(self.model, self.q, qd, self.pairs)

    def potential_energy(self):
        return potential_energy(self.model, self.q, self.pairs)


#: the others have tests of their own, in tests/moro/algorithms, graph and proof
TESTED = [name for name in FUNCTIONS if hasattr(Algorithms, name)]


def flat(value):
    return [x for v in value for x in flat(v)] if isinstance(value, (list, tuple)) else [value]


@pytest.mark.parametrize("seed", range(10))
def test_exact(seed):
    case = exact_case(seed, massive=True)
    rng = np.random.default_rng(seed)
    drives = [
        replace(x.drive, viscous=rational(rng), coulomb=(rational(rng), rational(rng)))
        for x in case.model.coordinates
    ]
    model = replace(case.model, coordinates=tuple(Coordinate(drive=x) for x in drives))
    program = generate(model, TESTED, passes=EXACT)
    expected = Algorithms(model, case.sincos, case.q, sign=lambda x: Fraction((x > 0) - (x < 0)))
    tau, wrench = ([rational(rng) for _ in range(size)] for size in (case.n, 6))
    given = {"q": case.q, "qd": case.qd, "qdd": case.qdd, "tau": tau, "wrench": wrench}
    for routine in program.routines:
        function = getattr(expected, routine.function.name)
        values = function(*(given[a.name] for a in routine.inputs[1:]))
        found = exact_values(routine.results, given, case.sincos)
        assert found == flat(values), routine.function.name


@pytest.mark.parametrize("seed", range(6))
def test_forward_dynamics_of_equivalent_arms(seed):
    """Both algorithms undo inverse dynamics on every arm with the same M and G."""
    case = exact_case(seed, massive=True)
    graph = Graph()
    system = System(graph, case.model.map(Converter(graph, {})))
    q, qd, tau = ([graph.input(x, i) for i in range(case.n)] for x in ("q", "qd", "tau"))
    given = {"q": case.q, "qd": case.qd, "tau": case.torques(case.qd, case.qdd)}
    for arm in equivalent_postures(system.posture(q), EXACT):
        for algorithm in (joint_accelerations, by_factorization):
            qdd = algorithm(arm, case.rotors, qd, tau)
            assert exact_values([*map(graph.constant, qdd)], given, case.sincos) == case.qdd


def functions_of(robot):
    """All functions that the robot has: none of forward dynamics without inertia everywhere."""
    try:
        generate(robot, ("forward_dynamics",))
    except ValueError:
        return [name for name in TESTED if name != "forward_dynamics"]
    return TESTED


def check(kernel, robot, rng, **parameters):
    """Compare all functions of a kernel with the algorithms, at states of shape (5, 3)."""
    n = robot.dof
    q, qd, qdd, tau = rng.uniform(-3, 3, (4, 5, 3, n))
    qd[0, 0] = 0
    given = {"q": q, "qd": qd, "qdd": qdd, "tau": tau, "wrench": rng.uniform(-3, 3, (5, 3, 6))}
    rows = {name: np.moveaxis(x, -1, 0).reshape(x.shape[-1], 15) for name, x in given.items()}
    model = numeric(robot.with_parameters(parameters).model())
    expected = Algorithms(model, sincos(model, rows["q"]), rows["q"])
    for name, signature in kernel.signatures.items():
        inputs = [a.name for a in signature.given]
        function = getattr(kernel, name)
        found = function(*(given[a] for a in inputs), parameters=parameters or None)
        values = arrays(getattr(expected, name)(*(list(rows[a]) for a in inputs[1:])), 15)
        (output,) = signature.outputs
        assert found.shape == (5, 3, *output.shape)
        values = np.moveaxis(values, -1, 0).reshape(found.shape)
        tolerance = 1e-12
        if name == "forward_dynamics":  # rounding of torques, and what M's inverse makes of it
            M = kernel.inertia_matrix(q, parameters=parameters or None)
            tolerance *= np.linalg.cond(M).max()
        error = np.abs(found - values).max()
        assert error <= tolerance * np.abs(values).max(), name
        single = function(*(given[a][0, 0] for a in inputs), parameters=parameters or None)
        assert np.abs(single - found[0, 0]).max() <= tolerance * np.abs(values).max()


@pytest.mark.sweep
@pytest.mark.parametrize("name", NAMES)
def test_packaged_arms(name, tmp_path):
    robot = mr.load(name)
    kernel = mc.compile(robot, functions_of(robot), tmp_path, backend="numpy")
    check(kernel, robot, np.random.default_rng(0))


@pytest.mark.sweep
@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize(("n", "convention"), [(1, "mdh"), (3, "dh")])
def test_random_arms(n, convention, backend, tmp_path):
    """With rotors, friction, and a payload and a length that are given at run time."""
    rng = random.Random(n)
    robot = random_robot(rng, n, convention)
    load, height = sp.symbols("load height")
    masses, places = robot.masses, robot.cm_positions
    robot.masses = [*masses[:-1], masses[-1] + load]
    robot.cm_positions = [*places[:-1], [0, height, sp.Rational(1, 10)]]
    robot.rotor_inertias = [sp.Rational(i + 1, 10) for i in range(n)]
    robot.viscous_friction = [rng.randint(1, 9) for _ in range(n)]
    robot.coulomb_friction = [(rng.randint(1, 9), rng.randint(1, 9)) for _ in range(n)]
    kernel = mc.compile(robot, TESTED, tmp_path, backend=backend)
    check(kernel, robot, np.random.default_rng(n), load=2.0, height=0.25)


class TestSingularInertia:
    def test_packaged_arm(self):
        """The last link of the published UR5 is a point on its axis."""
        message = "ur5 has no forward dynamics: no inertia .* joint 6; give that link an inertia"
        with pytest.raises(ValueError, match=message):
            mc.compile(mr.load("ur5"), ("forward_dynamics",))

    def test_rotor(self):
        robot = mr.load("ur5")
        robot.rotor_inertias = [0, 0, 0, 0, 0, 1]
        assert generate(robot.model(), ("forward_dynamics",)).routines

    def test_two_joints_on_one_axis(self):
        robot = mr.Robot((0, 0, 0, q1), (1, 0, 0, q2), (0, 0, 1, q3), (1, sp.pi / 2, 0, q4))
        robot.masses = [1, 1, 0, 1]
        robot.cm_positions = [[0, 0, 0]] * 4
        robot.inertia_tensors = [sp.eye(3)] * 2 + [sp.zeros(3), sp.eye(3)]
        robot.gravity = [0, 0, -9.81]
        with pytest.raises(ValueError, match=r"a motion of the joints 3, 4; give those links"):
            generate(robot.model(), ("forward_dynamics",))

    def test_whatever_the_parameters_are(self):
        robot = mr.load("ur5")
        m = sp.Symbol("m")
        robot.masses = [m, *robot.masses[1:]]
        with pytest.raises(ValueError, match=r"ur5 has no forward dynamics: .* some joint; "):
            generate(robot, ("forward_dynamics",))

    def test_massless_link_with_a_parameter(self):
        """What a run-time parameter makes of M is known at run time."""
        robot = mr.Robot((1, 0, 0, q1))
        m = sp.Symbol("m")
        robot.masses, robot.cm_positions, robot.inertia_tensors = [m], [[0, 0, 0]], [sp.zeros(3)]
        robot.gravity = [0, -9.81, 0]
        (routine,) = generate(robot, ("forward_dynamics",)).routines
        given = {"q": [0], "qd": [0], "tau": [Fraction(3)], "parameters": [Fraction(2)]}
        (qdd,) = exact_values(routine.results, given, [(0, 1)])
        assert float(qdd) == pytest.approx(3 / 2 - 9.81)


def test_cheaper_algorithm_is_chosen():
    """Articulated bodies, or M and its factors."""
    for name, chosen in (("two_link", joint_accelerations), ("puma560", by_factorization)):
        model = mr.load(name).model()
        (routine,) = generate(model, ("forward_dynamics",), rigid=True).routines
        costs = {a: cost(model, a) for a in (joint_accelerations, by_factorization)}
        assert min(costs, key=costs.get) is chosen
        assert total(routine.ops) <= costs[chosen]


def by_factorization(arm, rotors, qd, tau):
    bias = joint_torques(arm, qd, [0] * len(qd))
    factors = factorized(joint_inertia(arm, rotors), arm)
    return solution(factors, [x - y for x, y in zip(tau, bias, strict=True)])


def cost(model, algorithm):
    """Operations of an algorithm on the best of the equivalent arms, without rotors."""
    graph = Graph()
    system = System(graph, model.map(Converter(graph, {})))
    q, qd, tau = ([graph.input(x, i) for i in range(model.dof)] for x in ("q", "qd", "tau"))
    results = system.dynamics(
        system.posture(q), lambda arm: algorithm(arm, [0] * model.dof, qd, tau)
    )
    return total(count(schedule(results)))


def total(ops):
    return ops["add"] + ops["sub"] + ops["mul"] + 5 * ops["div"]
