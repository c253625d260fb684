"""Results in print: no minus before a minus, no negative angle, values as they were."""

import random
import re

import pytest
import sympy as sp
from robots import decimal, pi, planar, random_robot, symbolic

import moro as mr
from moro.abc import l1, q1, q2, t

#: -(-, - (-, --, and *(-...) behind a minus
TWO_SIGNS = re.compile(r"-\s*\(\s*-|-\s*-|\+\s*-")


def printed(robot):
    """Yield results of every kind."""
    n = robot.dof
    yield from (x for i in range(n + 1) for j in range(n + 1) for x in robot.T_ij(i, j))
    yield from (x for i in range(1, n + 1) for x in (*robot.J_cm_i(i), *robot.I_cm0(i)))
    yield from (*robot.inertia_matrix(), *robot.coriolis_matrix(), *robot.gravity_vector())
    yield from (robot.kinetic_energy(), robot.lagrangian())
    yield from (x.lhs for x in robot.dynamic_model())
    for named in (robot.dynamic_model(collect=True), robot.coriolis_matrix(collect=True)):
        yield from (*named.matrix, *named.constants.values())
    yield from (y for x in robot.base_parameters() for y in (x.combination, x.value))


def random_arm(seed):
    rng = random.Random(seed)
    n, convention = rng.randint(1, 2), rng.choice(["dh", "mdh"])
    if seed % 2:
        return random_robot(rng, n, convention)
    twists = [rng.choice([0, pi / 2, -pi / 2, pi, pi / 3, sp.Symbol("alpha_1")]) for _ in range(n)]
    kinds = "".join(rng.choice("rrp") for _ in range(n))
    return symbolic(twists, kinds=kinds, convention=convention)


@pytest.mark.parametrize("seed", range(8))
def test_no_minus_before_a_minus(seed):
    robot = random_arm(seed)
    for x in map(sp.sympify, printed(robot)):
        angles = {f.args[0] for f in x.atoms(sp.sin, sp.cos)}
        assert not any(angle.could_extract_minus_sign() for angle in angles), x
        assert not TWO_SIGNS.search(str(x)), x
        assert not TWO_SIGNS.search(robot.latex(x).replace("{}", "")), robot.latex(x)


@pytest.mark.parametrize("seed", range(8))
def test_signs_change_no_value(seed):
    """What is shown, at numbers, is what the polynomial is there."""
    robot, rng = random_arm(seed), random.Random(seed)
    values = {x: decimal(rng) for x in (*robot.qs, *robot.parameters)}
    rates = {q.diff(t): decimal(rng) for q in robot.qs}
    for form, shown in (
        (robot._form.inertia_matrix, robot.inertia_matrix()),
        (robot._form.coriolis_matrix(robot._rates()), robot.coriolis_matrix()),
    ):
        for p, x in zip((p for row in form for p in row), shown, strict=True):
            plain = robot._ring.expanded(p)
            difference = (plain - x).xreplace(rates).xreplace(values)
            assert abs(difference.evalf(30)) < 1e-20


def test_half_a_turn_between_axes_shows_no_negative_angle():
    robot = mr.Robot((l1, pi, 0, q1), (l1, 0, 0, q2))
    assert robot.T[0, 3] == l1 * (sp.cos(q1) + sp.cos(q1 - q2))
    robot = mr.Robot((0, pi, 0, q1), convention="mdh")
    assert robot.T[1, 0] == -sp.sin(q1)


@pytest.mark.parametrize("expr", ["sin(-q/2) + sin(q/2)", "cos(-q/2) - cos(q/2)", "a/b - a/b"])
def test_zero_is_zero(expr):
    assert planar(1).simplify(sp.sympify(expr, evaluate=False).subs(sp.Symbol("q"), q1)) == 0


def test_the_lagrangian_is_one_sum():
    robot = random_arm(5)
    assert robot.simplify(robot.lagrangian() - robot.kinetic_energy()) == robot.simplify(
        -robot.potential_energy()
    )
