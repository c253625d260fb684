"""Never a route against itself: what closed forms made is compared with recursions."""

import numpy as np
import pytest

import moro as mr
import moro_codegen as mc
from moro.algorithms import gravity
from moro.closed_form import ClosedForm, Geometry
from moro_codegen.proof.by_recursion import recursively
from moro_codegen.proof.expected import ExpectedDynamics
from moro_codegen.proof.symbolic_route import SymbolicRoute
from moro_codegen.proof.verification import parameter_values, states_of

CLOSED = ("gravity_vector", "potential_energy", "inertia_matrix", "jacobian", "forward_kinematics")


def test_each_function_is_compared_with_the_other_route(tmp_path):
    robot = mr.load("puma560")
    kernel = mc.compile(robot, ("tau", *CLOSED), tmp_path, backend="numpy")
    verification = mc.verify(kernel, robot)
    assert verification.passed
    made = {name: s.parts[0].route for name, s in kernel.signatures.items()}
    other = {"recursion": "closed form", "closed form": "recursion"}
    assert verification.routes == {name: other[route] for name, route in made.items()}
    assert set(made.values()) == {"recursion", "closed form"}
    assert verification.route == "closed form and recursion"


def wrong(formula):
    """A formula with one entry that is off by a thousandth."""

    def found(*arguments):
        first, *others = formula(*arguments)
        return [first * 1001 / 1000 if hasattr(first, "terms") else first * 1.001, *others]

    return found


@pytest.mark.parametrize("name", ["gravity_vector", "potential_energy"])
def test_a_slip_in_the_formulas_is_found_in_what_they_make(name, monkeypatch, tmp_path):
    """Both the kernel and the symbolic route have it, and agree with each other."""
    heights = ClosedForm.potential_energies.func
    monkeypatch.setattr(ClosedForm, "potential_energies", property(wrong(heights)))
    robot = mr.load("two_link")
    kernel = mc.compile(robot, (name,), tmp_path, backend="numpy")
    assert kernel.signatures[name].parts[0].route == "closed form"
    assert not mc.verify(kernel, robot).passed
    with pytest.raises(ValueError, match=f"{name} is off by"):
        mc.export(robot, tmp_path / "out", functions=(name,))


def test_a_slip_in_the_geometry_is_found_in_what_it_makes(monkeypatch, tmp_path):
    pose = Geometry.pose
    monkeypatch.setattr(Geometry, "pose", lambda *x: (pose(*x)[0], [y * 2 for y in pose(*x)[1]]))
    robot = mr.load("two_link")
    kernel = mc.compile(robot, ("forward_kinematics",), tmp_path, backend="numpy")
    assert not mc.verify(kernel, robot).passed


def test_a_slip_in_the_recursion_is_found_by_the_formulas(monkeypatch, tmp_path):
    """Panda's G is made from the first moments of what joints carry."""
    moved = gravity.add
    monkeypatch.setattr(gravity, "add", lambda a, b: moved(a, [1.001 * x for x in b]))
    robot = mr.load("panda")
    kernel = mc.compile(robot, ("gravity_vector",), tmp_path, backend="numpy")
    assert kernel.signatures["gravity_vector"].parts[0].route == "recursion"
    assert not mc.verify(kernel, robot, route=SymbolicRoute(robot, 0)).passed


@pytest.mark.parametrize("name", ["puma560", "palletizer", "solo12"])
def test_recursions_and_formulas_agree(name):
    """At the states, as arrays; parameters, couplings, springs and trees among them."""
    model = mr.load(name).model()
    rng = np.random.default_rng(2)
    states, values = states_of(model, 8, rng), parameter_values(model, rng)
    route = SymbolicRoute(model, 0)
    formulas = ExpectedDynamics(route, *states, values)
    recursions = recursively(formulas)
    tip = model.tip
    for find in (
        lambda x: x.M, lambda x: x.C, lambda x: x.G, lambda x: x.P, lambda x: x.K,
        lambda x: x.tau, lambda x: x.T(tip), lambda x: x.J(tip),
    ):  # fmt: skip
        expected, found = find(formulas), find(recursions)
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())
