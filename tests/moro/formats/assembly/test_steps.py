"""Placements as elementary motions."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from moro.formats.assembly import inverse, joined, placed, rpy, to_axis, turn_y
from moro.model import Placement, Rotation, Shift, Turn

a, b = sp.symbols("a b")
pi, zero = sp.pi, sp.Integer(0)
decimals = st.integers(-4000, 4000).map(lambda k: sp.Rational(k, 1000))
twelfths = st.integers(-12, 12).map(lambda k: k * pi / 12)
angles = st.one_of(decimals, twelfths)
steps = st.one_of(
    st.builds(Turn, st.sampled_from("xz"), angles),
    st.builds(Shift, st.tuples(decimals, decimals, decimals)),
)


def floats(rows):
    return np.array(sp.Matrix(rows).evalf(), dtype=float)


def textbook(roll, pitch, yaw):
    (sr, cr), (sp_, cp), (sy, cy) = ((math.sin(x), math.cos(x)) for x in (roll, pitch, yaw))
    Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    Ry = np.array([[cp, 0, sp_], [0, 1, 0], [-sp_, 0, cp]])
    Rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return Rz @ Ry @ Rx


@given(angles, angles, angles)
@settings(max_examples=40, deadline=None)
def test_roll_pitch_yaw_about_fixed_axes(roll, pitch, yaw):
    expected = textbook(*map(float, (roll, pitch, yaw)))
    assert np.allclose(floats(placed(rpy(roll, pitch, yaw)).R), expected, rtol=0, atol=1e-15)


def test_a_turn_about_y():
    assert sp.Matrix(Placement.by(*turn_y(a)).R) == sp.Matrix(
        [[sp.cos(a), 0, sp.sin(a)], [0, 1, 0], [-sp.sin(a), 0, sp.cos(a)]]
    )


@pytest.mark.parametrize(
    ("axis", "turns"),
    [
        ((0, 0, 1), ()),
        ((0, 0, -2), (Turn("x", pi),)),
        ((0, 1, 0), (Turn("x", -pi / 2),)),
        ((0, -1, 0), (Turn("x", pi / 2),)),
        ((3, 0, 0), (Turn("z", pi / 2), Turn("x", pi / 2))),
        ((-1, 0, 0), (Turn("z", -pi / 2), Turn("x", pi / 2))),
        ((0, 1, 1), (Turn("x", -pi / 4),)),
        ((1, 0, sp.sqrt(3)), (Turn("z", pi / 2), Turn("x", pi / 6))),
    ],
)
def test_axes_are_turned_to_z_by_elementary_turns(axis, turns):
    assert to_axis([*map(sp.sympify, axis)]) == turns


@given(st.tuples(decimals, decimals, decimals).filter(any))
@settings(max_examples=40, deadline=None)
def test_any_axis(axis):
    z = floats(placed(to_axis(axis)).R)[:, 2]
    v = np.array(axis, dtype=float)
    assert np.allclose(z, v / np.linalg.norm(v), rtol=0, atol=1e-15)


def test_the_zero_vector_is_no_axis():
    with pytest.raises(ValueError, match="no direction"):
        to_axis((zero, zero, zero))


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ((Turn("x", a), Turn("x", b)), (Turn("x", a + b),)),
        ((Turn("x", a), Shift((a, a, a)), Shift((-a, -a, -a)), Turn("x", -a)), ()),
        ((Turn("z", pi), Turn("z", 3 * pi / 2)), (Turn("z", pi / 2),)),
        ((Turn("z", a), Turn("x", b), Turn("z", a)), (Turn("z", a), Turn("x", b), Turn("z", a))),
        ((Rotation(((0, 0, 1), (1, 0, 0), (0, 1, 0))),) * 3, ()),
    ],
)
def test_what_is_about_one_axis_joins(given, expected):
    assert joined(given) == expected


@given(st.lists(steps, max_size=6))
@settings(max_examples=60, deadline=None)
def test_what_is_placed_is_where_its_steps_lead(way):
    found, expected = placed(way), Placement.by(*way)
    assert np.allclose(floats(found.R), floats(expected.R), rtol=0, atol=1e-14)
    assert np.allclose(floats([found.p]), floats([expected.p]), rtol=0, atol=1e-13)
    assert (sp.Matrix(found.R) * sp.Matrix(found.R).T).expand() == sp.eye(3)


@given(st.lists(steps, max_size=5))
@settings(max_examples=40, deadline=None)
def test_there_and_back(way):
    assert joined((*way, *inverse(way))) == ()


def test_plain_angles_become_one_exact_rotation():
    way = (*rpy(sp.Rational("0.3"), pi / 4, sp.Rational(-3)), Shift((a, zero, zero)))
    found = placed((*way, Turn("x", sp.Rational("1e-9"))))
    shift, rotation = found.steps
    R = sp.Matrix(rotation.R)
    assert sp.eye(3) == R * R.T
    assert R.det() == 1
    assert all(x.is_Rational for x in R)
    assert shift.p[0].free_symbols == {a}


def test_symbols_and_fractions_of_pi_stay_turns():
    way = (Turn("x", pi / 3), Shift((a, zero, zero)), Turn("z", b))
    assert placed(way).steps == way


def test_quarter_turns_are_as_few_as_can_be_and_shifts_go_before_them():
    way = (*turn_y(pi / 2), Turn("x", pi / 2), Shift((a, zero, zero)), *turn_y(-pi / 2))
    found = placed(way)
    assert found.steps == (Shift((zero, zero, -a)), Turn("z", -pi / 2))
