"""Functions of one's own: any expression of the motion and the parameters, in every backend."""

import numpy as np
import pytest
import sympy as sp

import moro as mr
import moro_codegen as mc
from moro.abc import l1, l2, q1, q2, q3, t
from moro_codegen.functions.own import UserFunction, results_of
from moro_codegen.functions.requested import requested

QD1, QD2 = q1.diff(t), q2.diff(t)


@pytest.fixture(scope="module")
def arm():
    """Two links, with lengths and a mass left free."""
    robot = mr.Robot((l1, 0, 0, q1), (l2, 0, 0, q2), name="arm")
    m2 = sp.Symbol("m_2")
    robot.masses = [1, m2]
    robot.cm_positions = [[-l1 / 2, 0, 0], [-l2 / 2, 0, 0]]
    robot.inertia_tensors = [sp.zeros(3, 3)] * 2
    robot.gravity = [0, -9.81, 0]
    robot.parameters = {m2: 3, l1: sp.Rational(1, 2), l2: None}
    return robot


def by_sympy(expression, robot, q, qd, qdd, parameters):
    """An expression by substitution, entry by entry, with 30 digits."""
    values = {x.diff(t, 2): a for x, a in zip(robot.qs, qdd, strict=True)}
    values |= {x.diff(t): v for x, v in zip(robot.qs, qd, strict=True)}
    values |= dict(zip(robot.qs, q, strict=True)) | parameters
    numbers = sp.Matrix(sp.flatten([expression])).subs(list(values.items()))
    return np.array([float(x) for x in numbers.evalf(30)])


STATE = {"q": [0.3, -1.2], "qd": [0.7, 2.0], "qdd": [-1.5, 0.4]}
VALUES = {"m_2": 2.5, "l_1": 0.4, "l_2": 0.9}
M2 = sp.Symbol("m_2")
EXPRESSIONS = {
    "scalar": M2 * l2 * sp.cos(q1 + q2),
    "speeds": sp.Matrix([QD1 * q2, sp.sign(QD2) * l1, 0]),
    "square": sp.Matrix([[q1, sp.sin(q1 - q2)], [sp.Rational(1, 3), l1**2 / (1 + q1**2)]]),
    "row": sp.Matrix([[q1, q2, 2]]),
    "acceleration": sp.Matrix([q1, q2]).diff(t, 2),
    "many": sp.sqrt(1 + q1**2) * sp.exp(-q2) + sp.atan2(q1, 2 + q2) - abs(q2) ** sp.Rational(7, 3)
    + sp.tan(q1) / sp.cosh(q2) + sp.sec(q1) + sp.csc(q2) + sp.cot(q1) + sp.asinh(q2) + sp.pi
    + sp.log(3 + QD1, 2) + 1 / sp.sqrt(2 + sp.cos(q2)) + q1 ** (-3) * l1 / l2,
    "constant": sp.Integer(3),
    "of_parameters": M2 * l1,
}  # fmt: skip
SHAPES = {"speeds": (3,), "square": (2, 2), "row": (1, 3), "acceleration": (2,)}


@pytest.fixture(scope="module", params=["c", "numpy"])
def kernel(request, arm, tmp_path_factory):
    functions = [mc.Function(name, x) for name, x in EXPRESSIONS.items()]
    folder = tmp_path_factory.mktemp("kernels")
    return mc.compile(arm, functions=functions, directory=folder, backend=request.param)


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_against_sympy(kernel, arm, name):
    given = [STATE[a.name] for a in kernel.signatures[name].given]
    found = getattr(kernel, name)(*given, parameters=VALUES)
    assert found.shape == SHAPES.get(name, ())
    symbols = {symbol: VALUES[symbol.name] for symbol in arm.parameters}
    expected = by_sympy(EXPRESSIONS[name], arm, **STATE, parameters=symbols)
    np.testing.assert_allclose(np.ravel(found), expected, rtol=1e-14)
    batch = getattr(kernel, name)(*[np.tile(x, (5, 1)) for x in given], parameters=VALUES)
    np.testing.assert_allclose(batch, np.tile(found, (5, *[1] * found.ndim)), rtol=1e-15)


def test_inputs_are_those_that_occur(kernel):
    inputs = {name: [a.name for a in s.given] for name, s in kernel.signatures.items()}
    assert inputs["scalar"] == ["q"]
    assert inputs["speeds"] == ["q", "qd"]
    assert inputs["acceleration"] == ["qdd"]
    assert inputs["constant"] == inputs["of_parameters"] == ["q"]


def test_sums_of_angles_are_angles(kernel):
    assert kernel.ops["scalar"]["sincos"] == 1
    assert kernel.ops["scalar"]["add"] == 1


def test_several_results_and_texts(arm, tmp_path):
    pair = mc.Function("pair", [q1 + q2, sp.eye(2) * QD1], summary="A sum, a matrix.", unit="rad")
    kernel = mc.compile(arm, functions=(pair,), directory=tmp_path, backend="numpy")
    assert kernel.parameters == {}  # none occurs
    total, matrix = kernel.pair([1, 2], [3, 4])
    assert total == 3
    assert np.array_equal(matrix, [[3, 0], [0, 3]])
    for words in ("A sum, a matrix.", "pair_1 ", "[rad]  q_1(t) + q_2(t)", "pair_2[2][2]"):
        assert words in kernel.pair.__doc__


def test_arrays_keep_their_shapes():
    shapes = {
        (): q1,
        (2,): sp.Array([q1, q2]),
        (3,): np.array([q1, 1, 2.5]),
        (1, 2): sp.Matrix([[q1, q2]]),
        (2, 1): sp.Array([[q1], [q2]]),
        (2, 2): sp.MatrixSymbol("A", 2, 2) * 0 + sp.ImmutableMatrix([[q1, 0], [0, q2]]),
        (2, 3): sp.SparseMatrix(2, 3, {(0, 1): q1}),
    }
    for shape, value in shapes.items():
        (result,) = results_of(value, "f")
        assert result.shape == shape
        assert len(result.entries) == np.prod(shape, dtype=int)


def test_large_expressions_become_few_operations(tmp_path):
    """M and C of the PUMA: fewer operations than SymPy's own common subexpressions."""
    robot = mr.load("puma560")
    M = robot.inertia_matrix()
    kernel = mc.compile(robot, functions=(mc.Function("M", M),), directory=tmp_path)
    replaced, reduced = sp.cse(list(M))
    theirs = sum(map(sp.count_ops, [*reduced, *(x for _, x in replaced)]))
    assert sum(kernel.ops["M"][op] for op in ("add", "sub", "mul", "div")) < theirs
    q = np.random.default_rng(0).uniform(-3, 3, (4, 6))
    reference = mc.compile(robot, functions=("inertia_matrix",), directory=tmp_path)
    np.testing.assert_allclose(kernel.M(q), reference.inertia_matrix(q), rtol=0, atol=1e-14)


def test_joint_variables_may_be_plain_symbols(tmp_path):
    x = sp.Symbol("x")
    robot = mr.Robot((1, 0, 0, x), name="plain")
    robot.masses, robot.cm_positions = [1], [[0, 0, 0]]
    robot.inertia_tensors, robot.gravity = [sp.eye(3)], [0, 0, 0]
    kernel = mc.compile(robot, functions=(mc.Function("f", sp.sin(x)),), directory=tmp_path)
    assert kernel.f([0.5]) == pytest.approx(np.sin(0.5), rel=1e-15)


# -- refused -----------------------------------------------------------------------------------


def test_unknown_symbols_are_named(arm):
    mass, third = sp.symbols("m_payload k")
    function = mc.Function("payload_moment", mass * third * q1 + q3 + q2.diff(t, 3) + t)
    with pytest.raises(
        ValueError, match=r"payload_moment contains .*k, m_payload, q_3\(t\), t:"
    ) as e:
        function.entry(arm.model())
    assert "Derivative(q_2(t), (t, 3))" in str(e.value)
    assert "q_1(t), q_2(t)" in str(e.value)
    assert "its parameters m_2, l_1, l_2" in str(e.value)
    other = sp.Symbol("m_2", positive=True)
    with pytest.raises(ValueError, match="m_2 has other assumptions"):
        mc.Function("f", other).entry(arm)


@pytest.mark.parametrize("name", ["", "2nd", "my function", "a-b", "é", "_x", "class", "double",
                                  "sin", "sines", "q", "qdd", "parameters", "out"])  # fmt: skip
def test_names_that_cannot_be(name):
    with pytest.raises(ValueError, match="cannot be named"):
        mc.Function(name, q1)


@pytest.mark.parametrize(
    "name", ["tau", "inertia_matrix", "ops", "library", "name", "tau_batch", "tau_part_2"]
)
def test_names_that_are_taken(arm, name, tmp_path):
    with pytest.raises(ValueError, match=f"cannot be named '{name}'"):
        mc.compile(arm, functions=("tau", mc.Function(name, q1)), directory=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", ["q1", None, sp.Eq(q1, 1), True, object(), [[q1, q2]], {q1}])
def test_what_is_no_expression(value):
    with pytest.raises(TypeError, match="neither a number nor a SymPy expression"):
        mc.Function("f", value)


def test_bad_values(arm):
    with pytest.raises(ValueError, match="two axes"):
        mc.Function("f", sp.Array([[[q1]]]))
    with pytest.raises(ValueError, match="no entries"):
        mc.Function("f", sp.zeros(0, 3))
    with pytest.raises(ValueError, match="empty list"):
        mc.Function("f", [])
    with pytest.raises(TypeError, match="name is a string"):
        mc.Function(q1, q1)
    with pytest.raises(TypeError, match="text"):
        mc.Function("f", q1, summary=3)
    with pytest.raises(TypeError, match="text"):
        mc.Function("f", q1, unit=3)


@pytest.mark.parametrize("value", [sp.I * q1, sp.oo, sp.nan, sp.gamma(q1), sp.zoo,
                                   sp.Piecewise((q1, q1 > 0), (0, True))])  # fmt: skip
def test_what_no_kernel_computes(arm, value):
    with pytest.raises(ValueError, match=r"^f: "):
        mc.compile(arm, functions=(mc.Function("f", value),), backend="numpy")


def test_requests_that_cannot_be(arm):
    with pytest.raises(ValueError, match="no function 'inertia_matrx'; did you mean 'inertia_mat"):
        requested(("inertia_matrx",), arm)
    with pytest.raises(ValueError, match="two functions are called tau"):
        requested(("tau", "tau"), arm)
    with pytest.raises(TypeError, match=r"functions=\('tau',\)"):
        requested("tau", arm)
    with pytest.raises(TypeError, match="not 3"):
        requested((3,), arm)
    with pytest.raises(ValueError, match="no functions: there are tau, "):
        requested((), arm)
    for functions in (("tau",), ("tau", "tau"), ()):
        with pytest.raises(ValueError, match=r"asked for twice|for two or more"):
            requested((functions,), arm)


# -- together ----------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_together(backend, tmp_path):
    robot = mr.load("puma560")
    pair = ("tau", "inertia_matrix")
    kernel = mc.compile(robot, functions=(*pair, pair), directory=tmp_path, backend=backend)
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 7, 6))
    tau, M = kernel.tau_inertia_matrix(q, qd, qdd)
    np.testing.assert_allclose(tau, kernel.tau(q, qd, qdd), rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(M, kernel.inertia_matrix(q), rtol=1e-13, atol=1e-13)
    ops = {name: sum(counts.values()) for name, counts in kernel.ops.items()}
    assert ops["tau_inertia_matrix"] < ops["tau"] + ops["inertia_matrix"]
    sincos = {name: counts["sincos"] for name, counts in kernel.ops.items()}
    assert sincos["tau_inertia_matrix"] <= max(sincos["tau"], sincos["inertia_matrix"])
    assert "tau, inertia_matrix" in kernel.tau_inertia_matrix.__doc__


def test_together_with_ones_own(arm, tmp_path):
    """Inputs are joined; results of one name are told apart by their functions."""
    height = mc.Function("height", l1 * sp.sin(q1) + l2 * sp.sin(q1 + q2))
    group = ("potential_energy", height, "forward_dynamics", "tau")
    kernel = mc.compile(arm, functions=(group,), directory=tmp_path)
    (s,) = kernel.signatures.values()
    assert [a.name for a in s.given] == ["q", "qd", "qdd", "tau"]
    assert [a.name for a in s.outputs] == ["P", "height", "forward_dynamics_qdd", "tau_tau"]
    call = kernel.potential_energy_height_forward_dynamics_tau
    q, qd, qdd = STATE.values()
    _, height, _, tau = call(q, qd, qdd, [0, 0], parameters=VALUES)
    assert height == pytest.approx(0.4 * np.sin(0.3) + 0.9 * np.sin(0.3 - 1.2), rel=1e-14)
    np.testing.assert_allclose(call(q, qd, qdd, tau, parameters=VALUES)[2], qdd, rtol=1e-12)


def test_it_says_what_it_is():
    assert (
        repr(mc.Function("f", q1))
        == f"UserFunction(name='f', expression={q1}, summary='', unit='SI')"
    )
    assert mc.Function is UserFunction
