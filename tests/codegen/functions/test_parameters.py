"""Run-time parameters: those that the equations have, those of functions, and what cancels."""

import numpy as np
import pytest
import sympy as sp
from functions import SHORT

import moro
import moro_codegen as mc
from moro import Robot
from moro.abc import q1, q2
from moro.formats.loading import locate
from moro_codegen.functions.requested import requested
from moro_codegen.program import generate
from moro_codegen.proof.verification import INVERTING

m, mx, zz, payload, kp = sp.symbols("M1 MX1 ZZ1 payload Kp")
GRAVITY = sp.Rational("9.81")
#: of geometry alone, or with masses one by one
OTHERS = {"tau_with_wrench", "center_of_mass", "standard_regressor", "operational_space"}
DYNAMICS = [name for name in SHORT if mc.FUNCTIONS[name].frame is None and name not in OTHERS]


def identified():
    """One link, by its mass, its first moment, and its tensor about the joint."""
    robot = Robot((0, 0, 0, q1), convention="mdh", name="identified")
    robot.masses, robot.cm_positions = [m], [[mx / m, 0, 0]]
    robot.inertia_tensors = [sp.diag(0, 0, zz - mx**2 / m)]
    robot.gravity = [0, -GRAVITY, 0]
    robot.parameters = {m: 0, mx: 2, "ZZ1": 3}
    return robot


def loaded():
    """Two links; the second one and its payload are one body, about their centre of mass."""
    own, at, there = sp.Rational(6, 5), sp.Rational(-1, 2), sp.Rational(1, 5)
    total = own + payload
    apart = own * payload / total * (at - there) ** 2
    robot = Robot((1, 0, 0, q1), (1, 0, 0, q2), name="loaded")
    robot.masses = [1, total]
    robot.cm_positions = [[at, 0, 0], [(own * at + payload * there) / total, 0, 0]]
    tensor = sp.diag(0, sp.Rational(1, 10), sp.Rational(1, 10))
    robot.inertia_tensors = [tensor, tensor + sp.diag(0, apart, apart)]
    robot.gravity = [0, -GRAVITY, 0]
    robot.parameters = {payload: sp.Rational(1, 2)}
    return robot


def two_links():
    """A planar arm in symbols."""
    l1, l2, lc1, lc2, g = sp.symbols("l1 l2 lc1 lc2 g")
    robot = Robot((l1, 0, 0, q1), (l2, 0, 0, q2), name="symbolic")
    robot.masses = robot.inertia_tensors = None
    robot.cm_positions = [[lc1 - l1, 0, 0], [lc2 - l2, 0, 0]]
    robot.gravity = [0, -g, 0]
    return robot


@pytest.mark.parametrize("name", DYNAMICS)
def test_identified_parameters_need_no_mass(name):
    robot = identified()
    program = generate(robot, (name,))
    assert "M1" not in [parameter.name for parameter in program.parameters]
    inverse = name in INVERTING  # of M, that is ZZ1
    assert program.routines[0].ops["div"] <= inverse


def test_torques_of_identified_parameters(tmp_path):
    robot = identified()
    kernel = mc.compile(robot, functions=DYNAMICS, directory=tmp_path, backend="numpy")
    assert kernel.tau([0.1], [0], [1])[0] == pytest.approx(22.52198, abs=1e-5)
    assert kernel.parameters == {"MX1": 2, "ZZ1": 3}
    assert mc.verify(kernel, robot).passed


@pytest.mark.parametrize("name", DYNAMICS)
def test_a_common_centre_of_mass_needs_no_division(name):
    robot = loaded()
    (routine,) = generate(robot, (name,)).routines
    assert name in INVERTING or routine.ops["div"] == 0


def test_torques_with_a_payload(tmp_path):
    robot = loaded()
    kernel = mc.compile(robot, functions=DYNAMICS, directory=tmp_path, backend="numpy")
    assert mc.verify(kernel, robot).passed
    away = kernel.tau([0.3, 0.2], [1, 2], [3, 4], parameters={"payload": -1.2})  # nothing is left
    values = {payload: sp.Rational(-6, 5), q1: 0.3, q2: 0.2}
    rates = {q1.diff(): 1, q2.diff(): 2, q1.diff().diff(): 3, q2.diff().diff(): 4}
    exact = [x.lhs.subs(rates).subs(values) for x in robot.dynamic_model()]
    np.testing.assert_allclose(away, np.array(exact, dtype=float), rtol=1e-12)


def test_closed_forms_cancel_denominators():
    m1, m2 = sp.symbols("m1 m2")
    robot = identified()
    assert robot.simplify(m1 / (m1 + m2) + m2 / (m1 + m2) - 1) == 0
    assert robot.simplify((m1**2 + 2 * m1 * m2 + m2**2) / (m1 + m2) ** 2) == 1
    assert robot.inertia_matrix()[0, 0] == zz
    assert not any(x.atoms(sp.Pow) for x in loaded().base_parameters().values)
    assert list(identified().base_parameters().values) == [zz, mx]


@pytest.mark.parametrize("name", DYNAMICS)
def test_a_planar_arm_asks_for_what_its_equations_have(name):
    robot = two_links()
    program = generate(robot, (name,))
    found = {parameter.name for parameter in program.parameters}
    assert not {f"I_{{{x}_{i}{x}_{i}}}" for x in "xy" for i in (1, 2)} & found
    assert [p.name for p in program.parameters] == [
        str(x) for x in robot.parameters if str(x) in found
    ]


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_kernels_of_a_planar_arm_verify(backend, tmp_path):
    robot = two_links()
    kernel = mc.compile(robot, functions=DYNAMICS, directory=tmp_path, backend=backend)
    assert mc.verify(kernel, robot).passed
    heavy = mc.compile(robot, functions=("potential_energy",), directory=tmp_path, backend=backend)
    assert list(heavy.parameters) == ["g", "l1", "lc1", "lc2", "m_1", "m_2"]


class TestParametersOfFunctions:
    def test_they_come_after_those_of_the_robot(self, tmp_path):
        robot, u = loaded(), mc.Function("u", -kp * q1, parameters={"Kp": 100})
        kernel = mc.compile(robot, functions=("tau", u), directory=tmp_path, backend="numpy")
        assert kernel.parameters == {"payload": 0.5, "Kp": 100}
        assert kernel.u([0.5, 0]) == -50
        assert kernel.u([0.5, 0], parameters={"Kp": 2}) == -1
        assert mc.verify(kernel, robot).passed
        both = mc.compile(robot, functions=(("tau", u),), directory=tmp_path, backend="numpy")
        assert both.tau_u([0.5, 0], [0, 0], [0, 0])[1] == -50
        assert mc.lambdify(kp * q1, robot, {kp: 3})([1, 0]) == 3

    def test_without_a_default_they_must_be_given(self, tmp_path):
        u = mc.Function("u", kp * q1, parameters={kp: None})
        kernel = mc.compile(loaded(), functions=(u,), directory=tmp_path, backend="numpy")
        with pytest.raises(TypeError, match="no default for Kp"):
            kernel.u([1, 2])

    @pytest.mark.parametrize(
        ("functions", "message"),
        [
            (lambda: mc.Function("u", kp * q1), r"by parameters=\{Kp: default\}"),
            (lambda: mc.Function("u", sp.Symbol("paylod") * q1), 'did you mean "payload"'),
            (lambda: mc.Function("u", kp * q1, parameters={"kp": 1}), 'did you mean "Kp"'),
            (lambda: mc.Function("u", payload, parameters={payload: 1}), "of loaded already"),
            (lambda: mc.Function("u", kp * q1, parameters={kp: "x"}), "default of Kp"),
            (lambda: mc.Function("u", kp * q1, parameters=[kp]), "a dictionary"),
        ],
    )
    def test_what_cannot_be(self, functions, message):
        with pytest.raises((ValueError, TypeError), match=message):
            mc.compile(loaded(), functions=(functions(),), backend="numpy")

    def test_one_default_each(self):
        pair = [mc.Function(name, kp * q1, parameters={kp: x}) for name, x in (("u", 1), ("v", 2))]
        with pytest.raises(ValueError, match="the default of Kp is 2"):
            mc.compile(loaded(), functions=pair, backend="numpy")


def test_a_file_may_declare_what_only_functions_use(tmp_path):
    text = locate("two_link").read_text(encoding="utf-8")
    path = tmp_path / "controlled.yaml"
    path.write_text(text.replace("\nlinks:", "\nparameters: {Kp: 7}\nlinks:"), encoding="utf-8")
    with pytest.warns(UserWarning, match="not used in the file"):
        robot = moro.load(path)
    assert robot.parameters == {kp: 7}
    u = mc.Function("u", kp * q1)
    assert mc.compile(robot, directory=tmp_path, backend="numpy").parameters == {}
    kernel = mc.compile(robot, functions=(u,), directory=tmp_path, backend="numpy")
    assert kernel.u([2, 0]) == 14
    assert robot.with_parameters({"Kp": 1}).parameters == {}


def test_a_payload_loses_no_columns(tmp_path):
    robot = moro.load("panda")
    columns = robot.base_parameters().symbols
    robot.masses = [*robot.masses[:-1], robot.masses[-1] + payload]
    assert robot.base_parameters().symbols == columns
    for zeros in (None, True, False):
        regressor = mc.Regressor(zeros=zeros)
        entry = requested((regressor,), robot.model())[0]
        assert entry.outputs[1].shape == (len(robot.base_parameters(zeros)),)
    with pytest.raises(TypeError, match="zeros"):
        mc.Regressor(zeros="all")


def test_zeros_reach_kernels(tmp_path):
    robot = two_links()
    regressor = mc.Regressor(zeros=True)
    kernel = mc.compile(robot, functions=(regressor,), directory=tmp_path, backend="numpy")
    n = len(robot.base_parameters(zeros=True))
    assert n > len(robot.base_parameters())
    Y, p = kernel.regressor(
        [0.1, 0.2], [1, 2], [3, 4], parameters=np.full(len(kernel.parameters), 0.5)
    )
    assert Y.shape == (2, n)
    assert p.shape == (n,)
    assert mc.verify(kernel, robot).passed
