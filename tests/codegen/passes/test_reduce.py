"""Fewer inertial parameters, other frames, another unit of length: exactly the same torques."""

from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest
from arms import numeric, reference_model, sincos
from exact import EXACT, exact_arm, exact_state, exact_values, point_torques
from programs import evaluate
from recursion import inverse_dynamics

from moro.algorithms.newton_euler import joint_torques
from moro.model import REVOLUTE, Placement
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, constant_value
from moro_codegen.passes import equivalent_postures
from moro_codegen.passes.frames import (
    along_common_normals,
    in_unit,
    on_common_normals,
    turnable_leaves,
    turnable_parallels,
    unturned,
)
from moro_codegen.passes.reduce import reduced
from moro_codegen.program import generate

SEEDS = range(12)


def system(model, symbols=()):
    graph = Graph()
    known = {symbol: graph.input("parameters", k) for k, symbol in enumerate(symbols)}
    return System(graph, model.map(Converter(graph, known)))


def inputs(arm, *names):
    return [[arm.graph.input(name, i) for i in range(arm.model.dof)] for name in names]


def torques(arm, posture):
    tau = joint_torques(posture, *inputs(arm, "qd", "qdd"))
    return [arm.graph.constant(x) for x in tau]


def case(seed):
    """A random arm or tree as a system, its posture, a function that checks torques exactly."""
    rng = np.random.default_rng(seed)
    model, points = exact_arm(rng, int(rng.integers(1, 7)), tree=seed % 3 == 2)
    pairs, q, qd, qdd = exact_state(rng, model.dof)
    arm = system(model)
    expected = point_torques(model, points, pairs, q, qd, qdd)

    def check(posture, exact=True):
        values = exact_values(torques(arm, posture), {"q": q, "qd": qd, "qdd": qdd}, pairs)
        if exact:
            assert values == expected
        else:
            size = max(map(abs, expected))
            assert all(abs(x - y) <= 1e-13 * size for x, y in zip(values, expected, strict=True))

    return arm.posture(*inputs(arm, "q")), check


@pytest.mark.parametrize("seed", SEEDS)
def test_reduced(seed):
    arm, check = case(seed)
    check(reduced(arm))
    for before, after in zip(arm.links, reduced(arm).links, strict=True):
        body = after.body
        if before.type == REVOLUTE:
            assert constant_value(body.h[2]) == constant_value(body.S[2][2]) == 0
        else:
            assert {constant_value(x) for row in body.S for x in row} == {0}


@pytest.mark.parametrize("seed", SEEDS)
def test_frames(seed):
    arm, check = case(seed)
    check(on_common_normals(arm))
    check(in_unit(arm, frozenset()))
    check(unturned(arm, turnable_leaves(arm)))
    check(unturned(arm, turnable_parallels(arm)))


@pytest.mark.parametrize("seed", SEEDS)
def test_all_together(seed):
    arm, check = case(seed)
    postures = list(equivalent_postures(arm, EXACT))
    assert postures
    for posture in postures:
        check(posture)
    for posture in equivalent_postures(arm):
        check(posture, exact=False)


@pytest.mark.parametrize("seed", SEEDS)
def test_x_axes_along_common_normals(seed):
    """Of the first turning link on a turning link, R is Rx: the rest is in the joints' angles."""
    arm, check = case(seed)
    turned = along_common_normals(arm)
    check(turned, exact=False)
    for link, children in zip(turned.links, turned.children, strict=True):
        outer = [turned.links[k] for k in children if turned.links[k].type == REVOLUTE]
        if link.type == REVOLUTE and outer:
            R = np.array([[float(constant_value(x)) for x in row] for row in outer[0].R])
            assert np.count_nonzero(R == 0) >= 4


def test_dh_arms_have_their_x_axes_there():
    for name in ("puma560", "panda", "ur5"):
        arm = system(reference_model(name))
        posture = arm.posture(*inputs(arm, "q"))
        assert along_common_normals(posture) == posture


def test_positions_of_common_normals():
    """The puma's frames: nothing along y; the Stanford arm's wrist: three frames in one point."""
    for name, zero in (("puma560", [0, 1, 5]), ("stanford_arm", [0, 4, 5])):
        arm = system(reference_model(name))
        links = on_common_normals(arm.posture(*inputs(arm, "q"))).links
        for i, link in enumerate(links):
            if link.type == REVOLUTE:
                assert constant_value(link.p[1]) == 0
            if i in zero:
                assert constant_value(link.p[0]) == constant_value(link.p[1]) == 0


def test_few_numbers_remain():
    """A Panda with full tensors: no masses and no h but where masses balance, 5 second moments."""
    arm = system(reference_model("panda"))
    links = reduced(on_common_normals(arm.posture(*inputs(arm, "q")))).links
    assert all(constant_value(link.body.S[2][2]) == 0 for link in links)
    assert constant_value(links[3].body.h[0]) == 0  # balanced by masses at the frames of 5 and 6
    assert constant_value(links[3].body.h[1]) == 0
    assert constant_value(links[5].body.h[0]) == 0  # by one at frame 7
    assert [constant_value(link.body.m) != 0 for link in links] == 4 * [False] + 3 * [True]


def test_unit_of_length():
    """Two equal distances of the puma, a_2 and d_4, become 1."""
    arm = system(reference_model("puma560"))
    links = in_unit(on_common_normals(arm.posture(*inputs(arm, "q"))), frozenset()).links
    assert [constant_value(x) for x in links[2].p] == [1, 0, 0]
    assert [constant_value(x) for x in links[4].p] == [0, 0, 1]


def changed(model, i, R=None, p=None):
    """The model with another placement of joint i."""
    place = model.joints[i].placement
    joint = replace(model.joints[i], placement=Placement(R or place.R, p or place.p))
    return replace(model, joints=(*model.joints[:i], joint, *model.joints[i + 1 :]))


TINY = 1e-9
PUMA, PANDA = reference_model("puma560"), reference_model("panda")


@pytest.mark.parametrize(
    "model",
    [
        changed(PANDA, 4, p=(TINY, 0.384, 0)),
        changed(PUMA, 2, R=((1, 0, 0), (0, cos(TINY), -sin(TINY)), (0, sin(TINY), cos(TINY)))),
        changed(PUMA, 2, R=((cos(TINY), 0, sin(TINY)), (0, 1, 0), (-sin(TINY), 0, cos(TINY)))),
    ],
    ids=["short lever of a balancing mass", "nearly parallel", "common normal far away"],
)
def test_rounding(model):
    """What is nearly singular costs no accuracy."""
    rng = np.random.default_rng(1)
    (routine,) = generate(model, rigid=True).routines
    model = numeric(model)
    for q, qd, qdd in rng.uniform(-3, 3, (20, 3, model.dof)):
        expected = np.array(inverse_dynamics(model, q, qd, qdd, sincos(model, q)))
        (tau,) = evaluate(routine, q, qd, qdd)
        assert np.abs(tau - expected).max() <= 1e-13 * np.abs(expected).max()
