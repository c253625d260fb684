"""``kernel.jax``: the numbers of the kernel through jit and vmap; derivatives by differences."""

import jax
import numpy as np
import pytest
from jax.test_util import check_grads

import moro as mr
import moro_codegen as mc
from moro import Robot
from moro.abc import g, l1, m1, q1

jax.config.update("jax_enable_x64", True)

FUNCTIONS = (
    "tau", "tau_derivatives", "bias", "forward_dynamics", "forward_dynamics_derivatives",
    "potential_energy", "gravity_vector", "forward_kinematics", "jacobian",
    "forward_kinematics@2", "jacobian@2", "inertia_matrix",
)  # fmt: skip


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("jax")
    return mc.compile(mr.load("two_link"), functions=FUNCTIONS, directory=folder)


@pytest.fixture(scope="module")
def state():
    return np.random.default_rng(0).uniform(-2, 2, (3, 2))


def test_has_the_numbers_of_the_kernel(kernel, state):
    q, qd, qdd = state
    assert np.array_equal(kernel.jax.tau(q, qd, qdd), kernel.tau(q, qd, qdd))
    found, expected = kernel.jax.tau_derivatives(q, qd, qdd), kernel.tau_derivatives(q, qd, qdd)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_goes_through_jit_and_vmap(kernel, state):
    q, qd, qdd = state
    many = np.random.default_rng(1).uniform(-2, 2, (5, 7, 2))
    taus = jax.jit(kernel.jax.tau)(many, qd, qdd)
    assert np.array_equal(taus, kernel.tau(many, qd, qdd))
    mapped = jax.vmap(jax.vmap(kernel.jax.inertia_matrix))(many)
    assert np.array_equal(mapped, kernel.inertia_matrix(many))
    over_qdd = jax.vmap(kernel.jax.tau, (None, None, 0))(q, qd, many[0])
    assert np.array_equal(over_qdd, kernel.tau(q, qd, many[0]))


@pytest.mark.parametrize(
    ("name", "inputs"),
    [
        ("tau", 3), ("bias", 2), ("forward_dynamics", 3), ("potential_energy", 1),
        ("forward_kinematics", 1), ("forward_kinematics_2", 1),
    ],
)  # fmt: skip
def test_gradients(kernel, state, name, inputs):
    check_grads(getattr(kernel.jax, name), tuple(state[:inputs]), order=1, rtol=1e-5)


def test_gradients_of_many(kernel):
    q, qd, qdd = np.random.default_rng(2).uniform(-2, 2, (3, 4, 2))
    by_q = jax.vmap(jax.jacobian(kernel.jax.tau))(q, qd, qdd)
    assert np.allclose(by_q, kernel.tau_derivatives(q, qd, qdd)[0], rtol=1e-13)
    check_grads(kernel.jax.tau, (q, qd, qdd), order=1, rtol=1e-5)


def test_what_has_no_derivative_says_so(kernel, state):
    q, qd, qdd = state
    with pytest.raises(TypeError, match="inertia_matrix has no derivative here"):
        jax.grad(lambda q: kernel.jax.inertia_matrix(q).sum())(q)
    with pytest.raises(TypeError, match="tau has first derivatives only"):
        jax.hessian(lambda q: kernel.jax.tau(q, qd, qdd).sum())(q)
    bare = mc.compile(mr.load("two_link"))
    with pytest.raises(TypeError, match=r'functions=\("tau", "tau_derivatives"\)'):
        jax.jacobian(bare.jax.tau)(q, qd, qdd)


def test_run_time_parameters(tmp_path):
    robot = Robot((l1, 0, 0, q1), name="pendulum")
    robot.masses, robot.cm_positions, robot.inertia_tensors = [m1], [(0, 0, 0)], [[0] * 6]
    robot.gravity, robot.parameters = [0, -g, 0], {"g": 10, "l_1": 2}
    kernel = mc.compile(robot, functions=("tau", "tau_derivatives"), directory=tmp_path)
    assert kernel.jax.tau([0], [0], [0], parameters={"m_1": 3})[0] == 60
    values = np.array([[3.0 if x == "m_1" else d for x, d in kernel.parameters.items()]] * 4)
    assert kernel.jax.tau([0], [0], [0], values).tolist() == [[60]] * 4
    check_grads(lambda q: kernel.jax.tau(q, [0], [0], {"m_1": 3}), (np.ones(1),), order=1)
    with pytest.raises(ValueError, match="needs a value of m_1"):
        kernel.jax.tau([0], [0], [0])
    with pytest.raises(ValueError, match="no parameters mass"):
        kernel.jax.tau([0], [0], [0], parameters={"m_1": 3, "mass": 1})
    with pytest.raises(TypeError, match="no derivative by its run-time parameters"):
        jax.grad(lambda m: kernel.jax.tau([0], [0], [0], parameters={"m_1": m})[0])(3.0)


def test_single_precision(tmp_path, state):
    kernel = mc.compile(mr.load("two_link"), directory=tmp_path, dtype="float32")
    found = kernel.jax.tau(*state)
    assert found.dtype == "float32"
    assert np.array_equal(found, kernel.tau(*state.astype("float32")))


def test_wrong_calls(kernel, state):
    q, qd, _ = state
    with pytest.raises(TypeError, match="tau takes q, qd, qdd: 2 were given"):
        kernel.jax.tau(q, qd)
    with pytest.raises(ValueError, match=r"qd must have shape \(\.\.\., 2\), not \(3,\)"):
        kernel.jax.tau(q, [1, 2, 3], q)
    with pytest.raises(AttributeError, match="no 'coriolis_matrix'; its functions are: tau"):
        _ = kernel.jax.coriolis_matrix
    with pytest.raises(ValueError, match='not backend="numpy"'):
        _ = mc.compile(mr.load("two_link"), backend="numpy").jax
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(TypeError, match="jax_enable_x64"):
            kernel.jax.tau(q, qd, q)
    finally:
        jax.config.update("jax_enable_x64", True)
