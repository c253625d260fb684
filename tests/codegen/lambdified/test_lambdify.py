"""mc.lambdify: symbolic results as functions of arrays, against kernels and SymPy."""

import inspect

import numpy as np
import pytest
import sympy as sp

import moro as mr
import moro_codegen as mc
from moro.abc import l1, l2, q1, q2, t


@pytest.fixture(scope="module")
def puma():
    return mr.load("puma560")


@pytest.fixture(scope="module")
def kernel(puma, tmp_path_factory):
    functions = ("inertia_matrix", "coriolis_matrix", "gravity_vector", "kinetic_energy")
    return mc.compile(puma, functions=functions, directory=tmp_path_factory.mktemp("kernel"))


Q, QD, QDD = np.random.default_rng(5).uniform(-3, 3, (3, 4, 7, 6))


def close(found, expected):
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize(
    "name", ["inertia_matrix", "coriolis_matrix", "gravity_vector", "kinetic_energy"]
)
def test_symbolic_results_against_kernels(puma, kernel, name):
    f = mc.lambdify(getattr(puma, name)(), puma)
    given = (Q, QD)[: len(kernel.signatures[name].given)]
    close(f(*given), getattr(kernel, name)(*given))
    out = np.empty_like(f(*given))
    assert f(*given, out=out) is out
    for k in np.ndindex(4, 7):
        assert np.array_equal(f(*[x[k] for x in given]), out[k])


def test_euler_lagrange(puma):
    tau = mc.lambdify([equation.lhs for equation in puma.dynamic_model()], puma)
    M, C, G = (mc.lambdify(x, puma) for x in (
        puma.inertia_matrix(), puma.coriolis_matrix(), puma.gravity_vector()
    ))  # fmt: skip
    rigid = np.einsum("...ij,...j", M(Q), QDD) + np.einsum("...ij,...j", C(Q, QD), QD) + G(Q)
    friction = mc.lambdify(puma.friction_vector(), puma)(QD)
    close(np.stack(tau(Q, QD, QDD), axis=-1), rigid + friction)


def test_arguments_are_those_that_occur(puma):
    def arguments(expression):
        return list(inspect.signature(mc.lambdify(expression, puma)).parameters)

    q, qd, qdd = puma.q(1), puma.q_dot(1), puma.q_dot(1).diff(t)
    rest = ["parameters", "out", "threads"]
    assert arguments(q * qdd) == ["q", "qdd", *rest]
    assert arguments(qdd + qd + q) == ["q", "qd", "qdd", *rest]
    assert arguments(sp.Integer(1)) == ["q", *rest]


def test_docstring_names_arguments(puma):
    doc = mc.lambdify(puma.coriolis_matrix(), puma).__doc__
    for words in ("q[6]", "qd[6]", "joint velocities", "[6][6]", "Takes ", "multiplications"):
        assert words in doc


def test_several_results_share_their_work(puma):
    M, G = puma.inertia_matrix(), puma.gravity_vector()
    both = mc.lambdify([M, G], puma)(Q)
    assert isinstance(both, tuple)
    close(both[0], mc.lambdify(M, puma)(Q))
    close(both[1], mc.lambdify(G, puma)(Q))
    one = mc.lambdify((M, G), puma)(Q[0, 0])
    assert np.array_equal(one[1], both[1][0, 0])


@pytest.fixture
def arm():
    robot = mr.Robot((l1, 0, 0, q1), (l2, 0, 0, q2), name="arm")
    robot.parameters = {l2: 2}
    return robot


def test_parameters_are_those_that_occur(arm):
    """No masses are needed for kinematics; values by name, in order, or the defaults."""
    f = mc.lambdify(arm.T[0, 3], arm)
    q = np.array([0.3, 0.4])
    expected = 0.5 * np.cos(0.3) + 2 * np.cos(0.7)
    assert f(q, parameters={"l_1": 0.5}) == pytest.approx(expected, rel=1e-15)
    assert f(q, parameters={l1: 0.5}) == pytest.approx(expected, rel=1e-15)
    assert f(q, parameters=[2, 0.5]) == pytest.approx(expected, rel=1e-15)
    assert f(q, parameters=[[2, 0.5]] * 3).shape == (3,)
    with pytest.raises(TypeError, match="no default for l_1"):
        f(q)
    g = mc.lambdify(l2 * sp.sin(q1), arm)
    assert isinstance(g(q), np.float64)
    assert g(q) == pytest.approx(2 * np.sin(0.3), rel=1e-15)
    assert g(q) == g(list(q)) == g(q[None])[0] == g(q, [2.0])
    with pytest.raises(TypeError, match="no parameter 'l_1'"):
        g(q, parameters={"l_1": 1})


def test_what_is_wrong_is_said(arm):
    f = mc.lambdify(q1 + q2, arm)
    with pytest.raises(ValueError, match=r"q \(joint positions\) must have shape \(2,\)"):
        f(np.zeros(3))
    with pytest.raises(TypeError, match="complex"):
        f(np.zeros(2) * 1j)
    with pytest.raises(TypeError, match="q missing"):
        f()
    with pytest.raises(ValueError, match="the expression contains x: known of arm are"):
        mc.lambdify(sp.Symbol("x"), arm)
    with pytest.raises(TypeError, match="neither a number nor"):
        mc.lambdify("q1", arm)


def test_zero_and_what_is_not_finite(arm):
    """One state and many agree on infinities and NaN; nothing is raised."""
    f = mc.lambdify([1 / q1, q2 / q1, sp.log(q1), sp.sin(q2), sp.sign(q1), sp.exp(q2)], arm)
    for state in ([0.0, 1.0], [0.0, 0.0], [1.0, np.inf], [-1.0, np.nan], [1.0, 800.0]):
        one, many = f(np.array(state)), f(np.array([state, state]))
        for x, y in zip(one, many, strict=True):
            assert np.array_equal([x, x], y, equal_nan=True)
    assert f(np.array([0.0, 1.0]))[0] == np.inf


def test_every_operation_one_state_and_many(arm):
    """Bit for bit the same, whichever way a call takes."""
    entries = [
        sp.atan2(q1, q2), sp.sqrt(abs(q1)) ** 3, sp.tan(q1 * q2), sp.cosh(q1) / (1 + q2**2),
        sp.asin(sp.sin(q1 - q2)), abs(q2) ** sp.pi, sp.cos(sp.sin(q1) + q2),
    ]  # fmt: skip
    f = mc.lambdify(sp.Matrix(entries), arm)
    q = np.random.default_rng(0).uniform(-2, 2, (50, 2))
    many = f(q)
    assert many.shape == (50, 7)
    for k, state in enumerate(q):
        assert np.array_equal(f(state), many[k])
    symbols = sp.symbols("a b")
    x, y = q[0]
    assert many[0][0] == pytest.approx(float(sp.atan2(*symbols).subs({"a": x, "b": y})), rel=1e-15)
