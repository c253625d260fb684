"""Rows, conventions, names and indices: what a wrong one is told."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from robots import complete, two_links

import moro as mr
from moro import Robot
from moro.abc import (
    alpha,
    d1,
    d3,
    l1,
    l2,
    q1,
    q2,
    q3,
    t,
)

pi = sp.pi
x, y = sp.symbols("x y")


class TestConstruction:
    def test_rows_of_four_are_revolute(self):
        assert Robot((l1, 0, 0, q1)).joint_types == ["r"]

    @pytest.mark.parametrize("kind", ["r", "R", "revolute", "Revolute"])
    def test_case_of_revolute_does_not_matter(self, kind):
        assert Robot((l1, 0, 0, q1, kind)).joint_types == ["r"]

    @pytest.mark.parametrize("kind", ["p", "P", "prismatic", "PRISMATIC"])
    def test_case_of_prismatic_does_not_matter(self, kind):
        assert Robot((l1, 0, q1, 0, kind)).joint_types == ["p"]

    @pytest.mark.parametrize(
        "row",
        [
            [l1, 0, 0, q1],
            (l1, 0, 0, q1, "r"),
            sp.Matrix([l1, 0, 0, q1]),
            sp.Matrix([[l1, 0, 0, q1]]),
            sp.ImmutableMatrix([l1, 0, 0, q1]),
            sp.Tuple(l1, 0, 0, q1),
            np.array([l1, 0, 0, q1], dtype=object),
            iter((l1, 0, 0, q1)),
        ],
        ids=lambda row: type(row).__name__,
    )
    def test_rows_may_be_any_sequence(self, row):
        robot = Robot(row)
        assert robot.dh_parameters == [(l1, 0, 0, q1)]
        assert robot.T[0, 3] == l1 * sp.cos(q1)

    def test_convention(self):
        assert two_links().convention == "dh"
        assert Robot((l1, 0, 0, q1), convention="mdh").convention == "mdh"
        assert Robot((l1, 0, 0, q1), convention="MDH").convention == "mdh"

    def test_name(self):
        robot = Robot((l1, 0, 0, q1), name="arm")
        assert robot.name == "arm"
        robot.name = "other"
        assert "other" in repr(robot)

    def test_load_is_the_same_on_the_class_and_the_module(self):
        assert Robot.load("two_link").dh_parameters == mr.load("two_link").dh_parameters

    def test_degrees_of_freedom_types_and_variables(self):
        robot = Robot((l1, 0, 0, q1), (0, 0, q2 + d1, 0, "p"), (l2, 0, 0, q3))
        assert robot.dof == 3
        assert robot.joint_types == ["r", "p", "r"]
        assert [robot.joint_type(i) for i in (1, 2, 3)] == ["r", "p", "r"]
        assert robot.qs == [q1, q2, q3] == [robot.q(i) for i in (1, 2, 3)]
        assert robot.q_dot(2) == q2.diff(t)

    def test_rows_as_given_and_as_a_table(self):
        robot = Robot((l1, pi / 2, 0.5, q1 + pi / 2), (0, alpha, q2 + d1, 0, "P"))
        assert robot.dh_parameters == [
            (l1, pi / 2, 0.5, q1 + pi / 2),
            (0, alpha, q2 + d1, 0),
        ]
        table = robot.dh_table
        assert table.headings == ("i", "a", "alpha", "d", "theta", "type")
        assert table[1] == (2, 0, alpha, d1 + q2, 0, "p")
        assert [line.split()[0] for line in repr(table).splitlines()[2:]] == ["1", "2"]
        assert (table[0, 2], table[1, 1], table[2, 5], table.shape) == ("alpha", l1, "p", (3, 6))
        assert r"\tfrac{\pi }{2}" in robot._repr_latex_()
        assert "<td>" in table._repr_html_() == robot._repr_html_()

    def test_joint_variables_may_have_offsets(self):
        robot = Robot((l1, 0, 0, q1 + pi / 2), (l2, 0, 0, q2 - pi), (0, 0, q3 + d3, alpha, "p"))
        assert robot.qs == [q1, q2, q3]
        assert robot.T[0, 3] == -l1 * sp.sin(q1) + l2 * sp.sin(q1 + q2)
        assert robot.T[2, 3] == d3 + q3

    def test_joint_variables_may_be_plain_symbols_or_other_functions_of_time(self):
        assert Robot((l1, 0, 0, x)).qs == [x]
        phi = sp.Function("phi")(t)
        assert Robot((l1, 0, 0, phi + x)).qs == [phi]

    def test_numbers_of_all_kinds_are_exact(self):
        kinds = [0.1, np.float64(0.1), np.float32(0.1), Decimal("0.1"), Fraction(1, 10)]
        kinds += [sp.Float("0.1"), sp.Rational(1, 10), sp.Float("0.1", 30), np.array(0.1)]
        for number in kinds:
            robot = Robot((number, 0, 0, q1))
            assert robot.arm.rows[0].a == sp.Rational(1, 10), repr(number)
        assert Robot((np.int64(3), 0, 0, q1)).arm.rows[0].a == 3

    @pytest.mark.parametrize("k", range(-8, 9))
    def test_floats_next_to_quarter_turns_are_quarter_turns(self, k):
        robot = Robot((0, k * math.pi / 4, 0, q1), (0, k * np.pi / 2, 0, q2 + k * math.pi / 6))
        rows = robot.arm.rows
        assert [rows[0].alpha, rows[1].alpha, rows[1].theta] == [k * pi / 4, k * pi / 2, k * pi / 6]

    def test_other_floats_stay_what_they_are(self):
        assert Robot((0, 1.56, 0, q1)).arm.rows[0].alpha == sp.Rational("1.56")


@pytest.mark.parametrize(
    ("rows", "error", "message"),
    [
        ([], ValueError, r"at least one row \(a, alpha, d, theta\)"),
        ([()], ValueError, r"row 1 must be \(a, alpha, d, theta\).*not 0 values"),
        ([(l1, 0, 0, q1), (1, 2, 3)], ValueError, "row 2 must be .*not 3 values"),
        ([(l1, 0, 0, q1, "r", 1)], ValueError, "row 1 must be .*not 6 values"),
        (["l1,0"], TypeError, "row 1 must be a list of values, not 'l1,0'"),
        ([{0: 0, 1: 1, 2: 2, 3: q1}], TypeError, "row 1 must be a list of values"),
        ([{l1, 0, 1, q1}], TypeError, "row 1 must be a list of values"),
        ([None], TypeError, "row 1 must be a list of values, not None"),
        ([7], TypeError, "row 1 must be a list of values, not 7"),
        ([[(l1, 0, 0, q1), (l2, 0, 0, q2)]], ValueError, r"one by one.*Robot\(\*rows\)"),
        ([sp.Matrix([[l1, 0, 0, q1], [l2, 0, 0, q2]])], ValueError, r"Robot\(\*rows\)"),
        ([np.array([[0.1, 0, 0, q1]] * 2, dtype=object)], ValueError, r"Robot\(\*rows\)"),
        ([(float("nan"), 0, 0, q1)], ValueError, "a of row 1 must be finite, not nan"),
        ([(0, 0, float("inf"), q1)], ValueError, "d of row 1 must be finite, not inf"),
        ([(0, -sp.oo, 0, q1)], ValueError, "alpha of row 1 must be finite, not -oo"),
        ([(sp.zoo, 0, 0, q1)], ValueError, "a of row 1 must be finite, not zoo"),
        ([(1j, 0, 0, q1)], ValueError, "a of row 1 must be real, not 1j"),
        ([(1 + 0j, 0, 0, q1)], ValueError, "a of row 1 must be real"),
        ([(sp.I * l1, 0, 0, q1)], ValueError, r"a of row 1 must be real, not I\*l_1"),
        ([(sp.sqrt(-2), 0, 0, q1)], ValueError, "a of row 1 must be real"),
        ([("0.5", 0, 0, q1)], TypeError, "a of row 1 must be a number .*not '0.5'"),
        ([(0, "pi/2", 0, q1)], TypeError, "alpha of row 1 must be a number .*not 'pi/2'"),
        ([(True, 0, 0, q1)], TypeError, "a of row 1 must be a number .*not True"),
        ([(None, 0, 0, q1)], TypeError, "a of row 1 must be a number .*not None"),
        ([(sp.Matrix([1]), 0, 0, q1)], TypeError, "a of row 1 must be a number .*not a matrix"),
        ([([1], 0, 0, q1)], TypeError, r"a of row 1 must be a number .*not \[1\]"),
        ([(0, 0, 0, sp.Eq(q1, 1))], TypeError, "theta of row 1 must be a number"),
        ([(0, 0, 0, sp.Function("q"))], TypeError, "theta of row 1 must be a number"),
        ([(0, 0, 0, q1, "x")], ValueError, "joint type of row 1 must be \"r\".*not 'x'"),
        ([(0, 0, 0, q1, "rotational")], ValueError, "joint type of row 1"),
        ([(0, 0, 0, q1, "prizmatic")], ValueError, 'did you mean "prismatic"'),
        ([(0, 0, 0, q1, None)], ValueError, "joint type of row 1 .*not None"),
        ([(0, 0, 0, q1, 1)], ValueError, "joint type of row 1 .*not 1"),
        ([(l1, 0, 0, 0)], ValueError, "theta of row 1 is 0, a number: the joint variable"),
        ([(l1, 0, 3, q1, "p")], ValueError, "d of row 1 is 3, a number: the joint variable"),
        ([(l1, 0, 0, q1**2)], ValueError, "theta of row 1 must be a sum of joint variables, each"),
        ([(l1, 0, 0, t * q1)], ValueError, "theta of row 1 must be joint variables and constants"),
        ([(l1, 0, 0, q1 + q2)], ValueError, r"q_1\(t\) and q_2\(t\) move joints only together"),
        ([(l1, 0, 0, x + y)], ValueError, "theta of row 1 .*which of x, y is the joint variable"),
        ([(l1, 0, 0, q1.diff(t))], ValueError, "theta of row 1 must be a sum of joint variables"),
        ([(l1, 0, 0, t)], ValueError, "theta of row 1 is t: t is time"),
        ([(l1, 0, 0, sp.Function("q")(x))], ValueError, "theta of row 1 .*function of time"),
        (
            [(l1, 0, 0, sp.Function("q")(sp.Symbol("t", real=True)))],
            ValueError,
            "theta of row 1 .*the t of moro.abc",
        ),
        ([(l1, 0, 0, q1), (l2, 0, 0, q1)], ValueError, r"rows 1 and 2 have the same .*q_1\(t\)"),
        ([(q2, 0, 0, q1), (l2, 0, 0, q2)], ValueError, "a of row 1 .*joint variable of row 2"),
        ([(l1, 0, 0, x), (l2, x, 0, y)], ValueError, "alpha of row 2 .*joint variable of row 1"),
        ([(l1, 0, 0, q1), (l2, 0, q1, q2)], ValueError, "d of row 2 .*joint variable of row 1"),
        ([(0, 0, q1, q1, "p")], ValueError, "theta of row 1 .*joint variable of row 1"),
        ([(q1.diff(t), 0, 0, q1)], ValueError, "a of row 1 .*must be constant"),
        ([(sp.Function("f")(t), 0, 0, q1)], ValueError, r"a of row 1 must be constant, not f\(t\)"),
        ([(2 * t, 0, 0, q1)], ValueError, "a of row 1 must be constant"),
    ],
)
def test_wrong_rows(rows, error, message):
    with pytest.raises(error, match=message):
        Robot(*rows)


@pytest.mark.parametrize(
    ("convention", "hint"),
    [
        ("mhd", 'did you mean "mdh"'),
        ("standard", 'did you mean "dh"'),
        ("Modified", 'did you mean "mdh"'),
        (None, "not None"),
        (1, "not 1"),
        ("", "not ''"),
    ],
)
def test_wrong_convention(convention, hint):
    with pytest.raises(ValueError, match='convention must be "dh".*or "mdh".*' + hint):
        Robot((l1, 0, 0, q1), convention=convention)


def test_wrong_name():
    with pytest.raises(TypeError, match="name must be text, not 5"):
        Robot((l1, 0, 0, q1), name=5)
    with pytest.raises(ValueError, match="name must not be empty"):
        Robot((l1, 0, 0, q1), name=" ")


def test_a_setting_misspelt_is_not_taken_silently():
    robot = two_links()
    with pytest.raises(AttributeError, match='a Robot has no mases; did you mean "masses"'):
        robot.mases = [1, 2]
    with pytest.raises(AttributeError):
        robot.dof = 3


def test_symbols_that_look_alike_are_told_apart():
    robot = Robot((sp.Symbol("a", real=True), 0, 0, q1), (sp.Symbol("a"), 0, 0, q2))
    with pytest.raises(ValueError, match="two different symbols are called a"):
        robot.T  # noqa: B018


# -- indices --------------------------------------------------------------------------------------

OF_LINKS = ["m", "I_cm", "I_cm0", "r_cm", "v_cm", "w", "w_rel0", "J_cm_i", "Jv_cm_i", "Jw_cm_i"]
OF_LINKS += ["link_kinetic_energy", "link_potential_energy"]
OF_JOINTS = ["joint_type", "q", "q_dot"]
OF_FRAMES = ["T_i0", "R_i0", "r_o", "z"]
NO_INDEX = [
    1.0,
    np.float64(1),
    None,
    True,
    np.bool_(True),
    [1],
    x,
    sp.Float(1),
    1j,
    Fraction(1),
]


class TestIndices:
    robot = complete()

    @pytest.mark.parametrize("method", OF_LINKS + OF_JOINTS + OF_FRAMES)
    def test_whole_numbers_of_all_kinds(self, method):
        of = getattr(self.robot, method)
        for i in (np.int64(2), np.uint8(2), sp.Integer(2)):
            assert of(i) == of(2)

    @pytest.mark.parametrize("method", OF_LINKS + OF_JOINTS + OF_FRAMES)
    @pytest.mark.parametrize("i", NO_INDEX, ids=repr)
    def test_what_is_no_whole_number(self, method, i):
        what = self.what(method)
        with pytest.raises(TypeError, match=f"{what} index must be a whole number, not"):
            getattr(self.robot, method)(i)

    @pytest.mark.parametrize("method", OF_LINKS + OF_JOINTS)
    def test_text_is_no_whole_number(self, method):
        with pytest.raises(TypeError, match="index must be a whole number, not '1'"):
            getattr(self.robot, method)("1")

    @pytest.mark.parametrize("method", OF_FRAMES)
    def test_frames_are_called_by_their_numbers_too(self, method):
        assert getattr(self.robot, method)("1") == getattr(self.robot, method)(1)
        with pytest.raises(ValueError, match="no frame is called '7'; there are 0 to 2"):
            getattr(self.robot, method)("7")

    @pytest.mark.parametrize("method", OF_LINKS + OF_JOINTS + OF_FRAMES)
    @pytest.mark.parametrize("i", [-1, 0, 3, 10**30])
    def test_out_of_range(self, method, i):
        what = self.what(method)
        if what == "frame" and i == 0:
            getattr(self.robot, method)(i)
            return
        low = 0 if what == "frame" else 1
        with pytest.raises(IndexError, match=rf"{what} index must be {low}\.\.2, not {i}"):
            getattr(self.robot, method)(i)

    def what(self, method):
        return "link" if method in OF_LINKS else "joint" if method in OF_JOINTS else "frame"

    def test_of_two_frames(self):
        for i, j in ((3, 0), (0, 3), (-1, 0)):
            with pytest.raises(IndexError, match=r"frame index must be 0\.\.2"):
                self.robot.T_ij(i, j)
        with pytest.raises(TypeError, match=r"frame index must be a whole number, not 0\.5"):
            self.robot.T_ij(1, 0.5)

    def test_of_points(self):
        with pytest.raises(IndexError, match=r"link index must be 1\.\.2, not 0"):
            self.robot.J_point([0, 0, 0], 0)

    def test_of_christoffel_symbols(self):
        M = self.robot.inertia_matrix()
        with pytest.raises(IndexError, match=r"joint index must be 1\.\.2, not 3"):
            self.robot.christoffel_symbols(1, 3, 1, M)
        with pytest.raises(TypeError, match=r"joint index must be a whole number, not 1\.5"):
            self.robot.christoffel_symbols(1, 1, 1.5, M)


@pytest.mark.parametrize(
    ("M", "error", "message"),
    [
        (sp.eye(3), ValueError, "M must be 2 x 2, not 3 x 3"),
        (None, TypeError, "M must be a matrix, not None"),
        ("M", TypeError, "M must be a matrix, not 'M'"),
        ([[1, 2], [3]], TypeError, "M must be a matrix"),
    ],
)
def test_wrong_matrix_for_christoffel_symbols(M, error, message):
    with pytest.raises(error, match=message):
        complete().christoffel_symbols(1, 1, 1, M)


# -- what is set ----------------------------------------------------------------------------------
