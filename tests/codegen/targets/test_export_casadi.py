"""CasADi's external functions: the kernel's numbers, Jacobians by its derivative functions."""

import casadi as ca
import numpy as np
import pytest
from exports import needs, run, two_link

import moro as mr
import moro_codegen as mc

BY = {"tau": "tau_derivatives", "forward_dynamics": "forward_dynamics_derivatives"}
FUNCTIONS = (
    "tau", "bias", "gravity_vector", "forward_dynamics", "inertia_matrix", "jacobian",
    "forward_kinematics", "potential_energy", ("tau", "inertia_matrix"),
)  # fmt: skip

pytestmark = needs("make")


def made(robot, folder, functions):
    (there,) = mc.export(robot, folder, ("casadi",), functions)
    run("make", "CFLAGS=-O1 -Wall -Wextra -Wpedantic -Wconversion -Werror", cwd=there)
    return str(there / f"lib{robot.name}_casadi.so")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return made(mr.load("two_link"), tmp_path_factory.mktemp("casadi"), FUNCTIONS)


@pytest.fixture(scope="module")
def kernel():
    return mc.compile(mr.load("two_link"), functions=(*FUNCTIONS, *BY.values()))


@pytest.fixture
def state():
    return dict(zip(("q", "qd", "x"), np.random.default_rng(0).uniform(-2, 2, (3, 2)), strict=True))


@pytest.mark.parametrize("name", [x for x in FUNCTIONS if isinstance(x, str)])
def test_numbers(library, kernel, state, name):
    given = [*state.values()][: len(kernel.signatures[name].inputs)]
    found, expected = ca.external(name, library)(*given), getattr(kernel, name)(*given)
    assert np.allclose(np.array(found).reshape(expected.shape), expected, rtol=1e-13, atol=1e-15)


def test_several_results(library, kernel, state):
    tau, M = ca.external("tau_inertia_matrix", library)(*state.values())
    expected = kernel.tau_inertia_matrix(*state.values())
    assert np.allclose(np.array(tau).ravel(), expected[0], rtol=1e-13)
    assert np.allclose(np.array(M), expected[1], rtol=1e-13)


def test_names(library):
    tau = ca.external("tau", library)
    assert (tau.name_in(), tau.name_out()) == (["q", "qd", "qdd"], ["tau"])


@pytest.mark.parametrize(("name", "by"), BY.items())
def test_jacobians(library, kernel, state, name, by):
    given = [ca.MX.sym(x, 2) for x in state]
    result = ca.external(name, library)(*given)
    blocks = ca.Function("J", given, [ca.jacobian(result, x) for x in given])(*state.values())
    for found, expected in zip(blocks, getattr(kernel, by)(*state.values()), strict=True):
        assert np.allclose(np.array(found), expected, rtol=1e-12, atol=1e-15)


def test_jacobians_at_rest(library, kernel, state):
    q, qd = ca.MX.sym("q", 2), ca.MX.sym("qd", 2)
    G, bias = ca.external("gravity_vector", library)(q), ca.external("bias", library)(q, qd)
    J = ca.Function("J", [q, qd], [ca.jacobian(G, q), ca.jacobian(bias, q), ca.jacobian(bias, qd)])
    found = [np.array(x) for x in J(state["q"], state["qd"])]
    zero = np.zeros(2)
    assert np.allclose(found[0], kernel.tau_derivatives(state["q"], zero, zero)[0])
    expected = kernel.tau_derivatives(state["q"], state["qd"], zero)
    assert np.allclose(found[1], expected[0])
    assert np.allclose(found[2], expected[1])


def test_an_optimal_control_problem_is_solved(library):
    """The arm goes from rest to rest, by IPOPT, without second derivatives, as the README says."""
    accelerations, steps, dt = ca.external("forward_dynamics", library), 10, 0.05
    problem = ca.Opti()
    x, u = problem.variable(4, steps + 1), problem.variable(2, steps)
    for k in range(steps):
        qdd = accelerations(x[:2, k], x[2:, k], u[:, k])
        problem.subject_to(x[2:, k + 1] == x[2:, k] + dt * qdd)
        problem.subject_to(x[:2, k + 1] == x[:2, k] + dt * x[2:, k + 1])
    problem.subject_to(x[:, 0] == [0, 0, 0, 0])
    problem.subject_to(x[:, -1] == [0.3, -0.2, 0, 0])
    problem.minimize(ca.sumsqr(u) / 1000)
    options = {"hessian_approximation": "limited-memory", "print_level": 0}
    problem.solver("ipopt", {"print_time": False}, options)
    found = problem.solve().value(x)
    assert np.allclose(found[:, -1], [0.3, -0.2, 0, 0], rtol=0, atol=1e-6)


def test_parameters_are_the_last_input(tmp_path, state):
    robot = two_link(payload=0.5)
    tau = ca.external("tau", made(robot, tmp_path, ("tau",)))
    assert tau.name_in() == ["q", "qd", "qdd", "parameters"]
    expected = mc.compile(robot).tau(*state.values(), {"payload": 2})
    assert np.allclose(np.array(tau(*state.values(), [2])).ravel(), expected, rtol=1e-13)


def test_single_precision_is_refused(tmp_path):
    with pytest.raises(ValueError, match="CasADi computes in double precision"):
        mc.export(mr.load("two_link"), tmp_path, ("casadi",), dtype="float32")
