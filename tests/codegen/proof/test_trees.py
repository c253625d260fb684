"""Hand-made models of branched robots go through everything: kernels and verification."""

from dataclasses import replace

import pytest
import sympy as sp
from dynamics import exact_case
from functions import COMMON, KINDS, SHORT
from trees import planar_tree, sympified

import moro_codegen as mc
from moro.model import Parameter


def kernel_of(model, directory, functions=SHORT):
    return mc.compile(model, functions=functions, directory=directory, backend="numpy")


@pytest.mark.parametrize("seed", [1, 3, 5])
def test_every_function_of_a_tree_is_verified(seed, tmp_path):
    model = sympified(exact_case(seed, massive=True, tree=True).model)
    assert any(joint.parent != i - 1 for i, joint in enumerate(model.joints))
    verification = mc.verify(kernel_of(model, tmp_path), model)
    assert verification.passed, verification.max_errors
    assert set(verification.errors) == set(SHORT)


@pytest.mark.sweep
def test_a_tree_in_symbols_takes_them_at_run_time(tmp_path):
    model = planar_tree()
    symbols = set[sp.Symbol]()
    model.map(lambda x: symbols.update(sp.sympify(x).free_symbols))
    parameters = tuple(Parameter(s, meaning=f"{s} of the tree") for s in sorted(symbols, key=str))
    model = replace(model, parameters=parameters)
    kernel = kernel_of(model, tmp_path, (*KINDS, *(set(mc.FUNCTIONS) - {*COMMON})))
    assert set(kernel.parameters) <= {str(s) for s in symbols}
    assert "mass" not in kernel.parameters
    assert mc.verify(kernel, model).passed
    assert "m_1 of the tree" in kernel.tau.__doc__


def test_lambdify_takes_a_model():
    model = planar_tree()
    q = model.qs
    height = mc.lambdify(sp.sin(q[0] + q[3]), model)
    assert height([0.1, 0, 0, 0.2, 0]) == pytest.approx(0.29552020666133955)


def test_what_is_no_robot_is_refused():
    with pytest.raises(TypeError, match="Robot"):
        mc.compile(42)
    with pytest.raises(TypeError, match="a Robot or a Model is needed"):
        mc.lambdify(sp.Integer(1), "two_link")
