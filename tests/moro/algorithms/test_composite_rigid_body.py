"""The inertia matrix: exactly that of Newton-Euler, and that of the Jacobian sums."""

import random

import numpy as np
import pytest
from arms import NAMES, numeric, sincos
from dynamics import assert_close, by_formulas, exact_case, numbers, reference_case
from recursion import inertia_matrix, rotors
from robots import random_robot


@pytest.mark.parametrize("seed", range(12))
def test_exact(seed):
    case = exact_case(seed)
    assert inertia_matrix(case.model, case.q, case.sincos) == case.M


def test_branches_do_not_feel_each_other():
    case = exact_case(9, tree=True)
    parents = [joint.parent for joint in case.model.joints]
    M = inertia_matrix(case.model, case.q, case.sincos)
    apart = [(i, j) for j in range(case.n) for i in range(j) if i not in line(parents, j)]
    assert apart
    assert all(M[i][j] == M[j][i] == 0 for i, j in apart)


def line(parents, j):
    """The ancestors of joint j."""
    while (j := parents[j]) >= 0:
        yield j


@pytest.mark.parametrize("name", NAMES)
def test_reference(name):
    model, pairs, state = reference_case(name)
    M = np.moveaxis(state["M_rigid"], 0, -1).copy()
    for i, rotor in enumerate(rotors(model)):
        M[i, i] += rotor
    assert_close(inertia_matrix(model, state["q"].T, pairs), M)


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("n", [1, 3, 7])
def test_jacobian_sums(n, convention):
    robot = random_robot(random.Random(n), n, convention)
    robot.rotor_inertias = [i + 1 for i in range(n)]
    q = np.random.default_rng(n).uniform(-3, 3, (n, 5))
    model = numeric(robot.model())
    M = np.array(inertia_matrix(model, q, sincos(model, q)), dtype=object)
    form, _ = by_formulas(robot, q)
    assert_close(M.tolist(), numbers(form.inertia_matrix))
