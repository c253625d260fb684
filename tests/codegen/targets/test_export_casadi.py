"""CasADi's external functions: the kernel's numbers, and derivatives as of the equations."""

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from exports import needs, run, two_link

import moro as mr
import moro_codegen as mc
from moro.abc import l1, m2, q1, q2, qd1, qdd2, t

OWN = mc.Function("own", sp.Matrix([sp.exp(q1) * m2, sp.atan2(l1 + q2**2, qd1), sp.sqrt(qdd2**2)]))
FUNCTIONS = (
    "tau", "bias", "gravity_vector", "inertia_matrix", "coriolis_matrix", "forward_dynamics",
    "forward_kinematics", "jacobian", "kinetic_energy", "potential_energy", "tau_derivatives",
    OWN, ("tau", "inertia_matrix"),
)  # fmt: skip
SINGLE = (*FUNCTIONS[:10], "own")

pytestmark = needs("make")


def made(robot, folder, functions):
    (there,) = mc.export(robot, folder, ("casadi",), functions)
    run("make", "CFLAGS=-O1 -Wall -Wextra -Wpedantic -Wconversion -Werror", cwd=there)
    return str(there / f"lib{robot.name}_casadi.so")


@pytest.fixture(scope="module")
def robot():
    """An arm that turns and slides, with run-time parameters, a rotor, and friction."""
    arm = mr.Robot((l1, sp.pi / 2, 0, q1), (0, 0, q2, 0, "p"), name="crane")
    arm.masses, arm.cm_positions = [2, m2], [(-l1 / 2, 0, 0), (0, 0.1, 0)]
    arm.inertia_tensors = [sp.diag(0.1, 0.2, 0.3), sp.diag(0.01, 0.02, 0.03)]
    arm.gravity, arm.parameters = (0, -9.81, 0.5), {l1: 0.5, m2: 1}
    arm.rotor_inertias, arm.viscous_friction, arm.coulomb_friction = [0.1, 0], [0.3, 0.4], [1, 2]
    return arm


@pytest.fixture(scope="module")
def library(robot, tmp_path_factory):
    return made(robot, tmp_path_factory.mktemp("casadi"), FUNCTIONS)


@pytest.fixture(scope="module")
def kernel(robot):
    return mc.compile(robot, functions=FUNCTIONS)


@pytest.fixture(scope="module")
def formulas(robot):
    """The closed forms as functions of CasADi's, {name: Function}."""
    names = {"q": robot.qs, "qd": [x.diff(t) for x in robot.qs],
             "qdd": [x.diff(t, 2) for x in robot.qs], "parameters": [l1, m2]}  # fmt: skip
    values = {name: ca.SX.sym(name, 2) for name in (*names, "tau")}
    symbols = {s: sp.Symbol(f"{name}{k}") for name, of in names.items() for k, s in enumerate(of)}
    modules = [
        {x: getattr(ca, x) for x in ("sin", "cos", "sqrt", "exp", "atan2")} | {"step": ca.sign}
    ]

    def in_symbols(x):
        for moving in ("qdd", "qd", "q"):  # rates before what they are rates of
            x = x.subs({s: symbols[s] for s in names[moving]})
        return x.subs(symbols).replace(sp.sign, sp.Function("step"))

    def matrix(expression):
        M = sp.Matrix([expression]) if isinstance(expression, sp.Expr) else sp.Matrix(expression)
        entries = [in_symbols(x) for x in M.T]  # column by column
        call = sp.lambdify([*symbols.values()], entries, modules)
        numbers = call(*(values[name][k] for name in names for k in range(2)))
        return ca.reshape(ca.vertcat(*numbers), *M.shape)

    qd, qdd = (sp.Matrix(names[x]) for x in ("qd", "qdd"))
    M, C, G = robot.inertia_matrix(), robot.coriolis_matrix(), robot.gravity_vector()
    bias = C * qd + G + robot.friction_vector()
    results = {
        "tau": matrix(M * qdd + bias), "bias": matrix(bias), "gravity_vector": matrix(G),
        "inertia_matrix": matrix(M), "coriolis_matrix": matrix(C),
        "forward_dynamics": ca.solve(matrix(M), values["tau"] - matrix(bias)),
        "forward_kinematics": matrix(robot.T), "jacobian": matrix(robot.J),
        "kinetic_energy": matrix(robot.kinetic_energy()),
        "potential_energy": matrix(robot.potential_energy()), "own": matrix(OWN.expression),
    }  # fmt: skip
    return lambda name, inputs: ca.Function(name, [values[x] for x in inputs], [results[name]])


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.mark.parametrize("name", SINGLE)
def test_derivatives_are_those_that_casadi_finds_in_the_equations(library, formulas, rng, name):
    """First ones, with the zeros they have, and second ones of a weighted sum, by all inputs."""
    f = ca.external(name, library)
    formula = formulas(name, f.name_in())
    given = rng.uniform(0.5, 2, f.nnz_in())
    weights = rng.uniform(-1, 1, f.numel_out(0))
    found, expected = (derivatives(g, weights)(given) for g in (f, formula))
    for a, b in zip(found, expected, strict=True):
        size = np.abs(b.full()).max(initial=1)
        assert np.allclose(a.full(), b.full(), rtol=0, atol=1e-12 * size)
    there = ca.sparsify(expected[1], 1e-12).sparsity()
    assert ca.horzcat(*jacobian(f, given)).sparsity() == there


def derivatives(f, weights):
    """The value of f of all inputs in one vector, its Jacobian; gradient and Hessian of w . f."""
    x = ca.MX.sym("x", f.nnz_in())
    y = ca.vec(f(*ca.vertsplit(x, [0, *np.cumsum([f.nnz_in(k) for k in range(f.n_in())])])))
    H, gradient = ca.hessian(ca.dot(weights, y), x)
    return ca.Function("d", [x], [y, ca.jacobian(y, x), gradient, H])


def jacobian(f, given):
    """The blocks of f's own Jacobian."""
    sizes = np.cumsum([f.nnz_in(k) for k in range(f.n_in())])
    return f.jacobian().call([*map(ca.DM, np.split(given, sizes[:-1])), *[0] * f.n_out()])


@pytest.mark.parametrize("name", [*SINGLE, "tau_inertia_matrix", "tau_derivatives"])
def test_numbers(library, kernel, rng, name):
    f = ca.external(name, library)
    given = [rng.uniform(0.5, 2, f.size1_in(k)) for k in range(f.n_in())]
    found, expected = f.call(given), getattr(kernel, name)(*given)
    for a, b in zip(found, expected if len(found) > 1 else [expected], strict=True):
        assert np.allclose(a.full().reshape(b.shape), b, rtol=1e-13, atol=1e-15)


def test_several_results_have_their_derivatives(library, kernel, rng):
    q, qd, qdd, parameters = rng.uniform(0.5, 2, (4, 2))
    both = ca.external("tau_inertia_matrix", library)
    blocks = dict(
        zip(both.jacobian().name_out(), jacobian(both, np.r_[q, qd, qdd, parameters]), strict=True)
    )
    by_q, by_qd, M = kernel.tau_derivatives(q, qd, qdd, parameters)
    for name, expected in {"tau_q": by_q, "tau_qd": by_qd, "tau_qdd": M}.items():
        assert np.allclose(blocks[f"jac_{name}"].full(), expected, rtol=1e-12, atol=1e-14)
    assert blocks["jac_M_q"].shape == (4, 2)
    assert blocks["jac_M_qd"].nnz() == 0


def test_names(library):
    tau = ca.external("tau", library)
    assert (tau.name_in(), tau.name_out()) == (["q", "qd", "qdd", "parameters"], ["tau"])


def test_an_optimal_control_problem_is_solved(tmp_path):
    """The arm goes from rest to rest, by IPOPT with exact Hessians."""
    library = made(mr.load("two_link"), tmp_path, ("forward_dynamics",))
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
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0})
    solution = problem.solve()
    assert np.allclose(solution.value(x)[:, -1], [0.3, -0.2, 0, 0], rtol=0, atol=1e-6)
    assert solution.stats()["n_call_nlp_hess_l"] > 0


def test_what_takes_too_long_is_left_out(tmp_path, monkeypatch):
    monkeypatch.setattr("moro_codegen.targets.derivatives.MOST", 20)
    library = made(mr.load("two_link"), tmp_path, ("tau", "potential_energy"))
    assert ca.external("potential_energy", library).jacobian().n_out() == 1
    with pytest.raises(RuntimeError):
        ca.external("tau", library).jacobian()
    words = (tmp_path / "casadi" / "README.md").read_text()
    assert "gives `tau`; no derivatives" in words


def test_a_function_called_like_a_derivative_is_refused(tmp_path):
    own = mc.Function("jac_tau", q1)
    with pytest.raises(ValueError, match="no function can be called jac_tau"):
        mc.export(two_link(), tmp_path, ("casadi",), ("tau", own))


def test_single_precision_is_refused(tmp_path):
    with pytest.raises(ValueError, match="CasADi computes in double precision"):
        mc.export(mr.load("two_link"), tmp_path, ("casadi",), dtype="float32")
