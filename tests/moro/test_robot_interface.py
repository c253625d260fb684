"""Robot as a person meets it: what goes in, what comes out, and what a wrong input is told."""

import math
import random
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from robots import full_tensor, planar, random_robot

import moro as mr
from moro import Robot
from moro.abc import (
    a1,
    alpha,
    alpha1,
    d1,
    d3,
    g,
    joint_variable,
    l1,
    l2,
    m1,
    m2,
    q1,
    q2,
    q3,
    symbol,
    t,
)

pi = sp.pi
x, y = sp.symbols("x y")


def two_links(**values):
    robot = Robot((l1, 0, 0, q1), (l2, 0, 0, q2))
    for name, value in values.items():
        setattr(robot, name, value)
    return robot


def complete():
    return two_links(
        masses=None,
        cm_positions=[[-x, 0, 0], [-y, 0, 0]],
        inertia_tensors=None,
        gravity=[0, -g, 0],
    )


# -- construction ---------------------------------------------------------------------------------


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
        ([(l1, 0, 0, 2 * q1)], ValueError, "theta of row 1 is 2.*factor 1, not 2"),
        ([(l1, 0, 0, -q1)], ValueError, "theta of row 1 is -.*factor 1, not -1"),
        ([(l1, 0, 0, x * q1)], ValueError, "theta of row 1 must be a joint variable plus a const"),
        ([(l1, 0, 0, q1**2)], ValueError, "theta of row 1 must be a joint variable plus a const"),
        ([(l1, 0, 0, q1 + q2)], ValueError, "theta of row 1 .*which of .* is the joint variable"),
        ([(l1, 0, 0, x + y)], ValueError, "theta of row 1 .*which of x, y is the joint variable"),
        ([(l1, 0, 0, q1.diff(t))], ValueError, "theta of row 1 must be a joint variable plus a"),
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
    "1",
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

VALUES = [x, 2]
LISTS_OF_TWO = [
    [x, 2],
    (x, 2),
    sp.Matrix([x, 2]),
    sp.Matrix([[x, 2]]),
    sp.ImmutableMatrix([x, 2]),
    sp.Array([x, 2]),
    np.array([x, 2]),
    np.array([[x, 2]]),
    np.array([[x], [2]]),
    (value for value in (x, 2)),
]


class TestLists:
    @pytest.mark.parametrize("name", ["masses", "rotor_inertias", "viscous_friction"])
    def test_of_numbers(self, name):
        for values in [*LISTS_OF_TWO[:-1], iter((x, 2))]:
            assert getattr(two_links(**{name: values}), name) == VALUES
        assert getattr(two_links(**{name: np.array([1, 2])}), name) == [1, 2]
        assert getattr(two_links(**{name: np.array([0.5, 2])}), name) == [0.5, 2.0]

    def test_of_friction_in_two_directions(self):
        for values in LISTS_OF_TWO[:-1]:
            assert two_links(coulomb_friction=values).coulomb_friction == [(x, x), (2, 2)]
        for pairs in ([(x, 1), (2, 2)], [[x, 1], 2], [sp.Matrix([x, 1]), 2]):
            assert two_links(coulomb_friction=pairs).coulomb_friction == [(x, 1), (2, 2)]
        for matrix in (np.array([[x, 1], [2, 2]]), sp.Matrix([[x, 1], [2, 2]])):
            assert two_links(coulomb_friction=matrix).coulomb_friction == [(x, 1), (2, 2)]

    @pytest.mark.parametrize(
        "values",
        [
            [[x, 0, 1], [0, 2, 3]],
            ((x, 0, 1), (0, 2, 3)),
            [sp.Matrix([x, 0, 1]), sp.Matrix([[0, 2, 3]])],
            sp.Matrix([[x, 0, 1], [0, 2, 3]]),
            sp.Array([[x, 0, 1], [0, 2, 3]]),
            np.array([[x, 0, 1], [0, 2, 3]]),
            np.array([[[x], [0], [1]], [[0], [2], [3]]]),
            [np.array([x, 0, 1]), np.array([[0], [2], [3]])],
        ],
        ids=lambda values: type(values).__name__,
    )
    def test_of_vectors(self, values):
        found = two_links(cm_positions=values).cm_positions
        assert found == [sp.Matrix([x, 0, 1]), sp.Matrix([0, 2, 3])]

    def test_of_tensors(self):
        I = sp.Matrix([[1, x, 0], [x, 2, 0], [0, 0, 3]])
        as_array = np.array(I.tolist())
        for values in (
            [I, I],
            (I.as_immutable(), I.tolist()),
            [as_array, as_array],
            np.stack([as_array, as_array]),
            sp.Array([I.tolist(), I.tolist()]),
        ):
            assert two_links(inertia_tensors=values).inertia_tensors == [I, I]
        numbers = np.stack([np.diag([1.0, 2, 3])] * 2)
        assert two_links(inertia_tensors=numbers).inertia_tensors == [sp.Matrix(numbers[0])] * 2
        for values in ([1, 2, 3, x, 0, 0], {"zz": 3, "Ixx": 1, "iyy": 2, "xy": x}):
            assert two_links(inertia_tensors=[values] * 2).inertia_tensors == [I, I]
        assert two_links(inertia_tensors=[(1, 2, 3)] * 2).inertia_tensors == [sp.diag(1, 2, 3)] * 2

    @pytest.mark.parametrize(
        ("values", "message"),
        [
            ({"xx": 1, "yy": 2}, "has no zz"),
            ({"xx": 1, "Ixx": 2, "yy": 1, "zz": 1}, "gives xx twice"),
            ({"xx": 1, "yy": 2, "zz": 3, "yx": 1}, "has an entry yx; its entries are xx, yy, zz"),
            ([1, 2, 3, 4, q1, 6], "must be constant"),
        ],
    )
    def test_of_wrong_entries(self, values, message):
        with pytest.raises(ValueError, match=f"of link 1 {message}"):
            two_links(inertia_tensors=[values, sp.eye(3)])

    def test_of_limits(self):
        pairs = [(-1, 1), (0, 2)]
        for values in (pairs, [[-1, 1], [0, 2]], np.array(pairs), sp.Matrix(pairs)):
            assert two_links(joint_limits=values).joint_limits == pairs

    @pytest.mark.parametrize(
        "value", [[0, 0, -g], (0, 0, -g), sp.Matrix([0, 0, -g]), sp.Matrix([[0, 0, -g]])]
    )
    def test_of_gravity(self, value):
        assert two_links(gravity=value).gravity == sp.Matrix([0, 0, -g])
        assert two_links(gravity=np.array([0, 0, -9.81])).gravity[2] == -9.81

    def test_almost_symmetric_tensors_become_symmetric(self):
        I = np.diag([1.0, 2, 3])
        I[0, 1], I[1, 0] = 0.1, 0.1 * (1 + 1e-15)
        assert two_links(inertia_tensors=[I, I]).I_cm(1).is_symmetric()
        same = [[1, (x + 1) ** 2, 0], [x**2 + 2 * x + 1, 1, 0], [0, 0, 1]]
        assert two_links(inertia_tensors=[same, same]).I_cm(1).is_symmetric()


NOT_LISTS = [5, x, "12", b"12", {1: 1, 2: 2}, {1, 2}, frozenset({1, 2})]
PER_LINK = ["masses", "cm_positions", "inertia_tensors"]
PER_JOINT = ["rotor_inertias", "viscous_friction", "coulomb_friction", "joint_limits"]
ITEMS = {
    "masses": 1,
    "cm_positions": [0, 0, 0],
    "inertia_tensors": sp.eye(3),
    "rotor_inertias": 1,
    "viscous_friction": 1,
    "coulomb_friction": (1, 2),
    "joint_limits": (0, 1),
}
BAD_NUMBERS = [
    (float("nan"), ValueError, "must be finite, not nan"),
    (np.float64("inf"), ValueError, "must be finite, not inf"),
    (-sp.oo, ValueError, "must be finite, not -oo"),
    (sp.nan, ValueError, "must be finite, not nan"),
    (2j, ValueError, "must be real, not 2j"),
    (np.complex128(1), ValueError, "must be real"),
    (sp.I * x, ValueError, r"must be real, not I\*x"),
    ("1", TypeError, "must be a number or a SymPy expression, not '1'"),
    (True, TypeError, "must be a number or a SymPy expression, not True"),
    (None, TypeError, "must be a number or a SymPy expression, not None"),
    (sp.Matrix([1]), TypeError, "must be a number or a SymPy expression, not a matrix"),
    (q1, ValueError, r"must be constant, not q_1\(t\)"),
    (q1.diff(t), ValueError, "must be constant"),
    (1 + t, ValueError, r"must be constant, not t \+ 1"),
]
OF_NUMBERS = [(str(value), value, error, message) for value, error, message in BAD_NUMBERS]


class TestWrongValues:
    @pytest.mark.parametrize("name", PER_LINK + PER_JOINT)
    @pytest.mark.parametrize("values", NOT_LISTS, ids=repr)
    def test_not_a_list(self, name, values):
        with pytest.raises(TypeError, match=f"{name} must be a list of values, not"):
            two_links(**{name: values})

    @pytest.mark.parametrize("name", PER_LINK + PER_JOINT)
    @pytest.mark.parametrize("count", [0, 1, 3])
    def test_wrong_count(self, name, count):
        of = "link" if name in PER_LINK else "joint"
        message = f"{name} must have 2 values, one for each {of}, not {count}"
        with pytest.raises(ValueError, match=message):
            two_links(**{name: [ITEMS[name]] * count})

    @pytest.mark.parametrize(("_", "value", "error", "message"), OF_NUMBERS)
    def test_wrong_number(self, _, value, error, message):
        with pytest.raises(error, match=f"m_2 of masses {message}"):
            two_links(masses=[1, value])
        for name in ("rotor_inertias", "viscous_friction", "coulomb_friction"):
            if name == "coulomb_friction" and isinstance(value, sp.Matrix):
                continue  # a list of one
            with pytest.raises(error, match=f"{name} of joint 2 {message}"):
                two_links(**{name: [1, value]})
        with pytest.raises(error, match=f"component 3 of cm_positions of link 2 {message}"):
            two_links(cm_positions=[[0, 0, 0], [0, 0, value]])
        with pytest.raises(error, match=f"component 1 of gravity {message}"):
            two_links(gravity=[value, 0, 0])
        with pytest.raises(error, match=f"entry 2,3 of inertia tensor of link 1 {message}"):
            two_links(inertia_tensors=[[[1, 0, 0], [0, 1, value], [0, value, 1]], sp.eye(3)])
        with pytest.raises(error, match=f"component 2 of point {message}"):
            two_links().J_point([0, value, 0], 1)

    def test_joint_variables_that_are_symbols_are_no_constants(self):
        robot = Robot((l1, 0, 0, x), (l2, 0, 0, y))
        with pytest.raises(ValueError, match="m_1 of masses must be constant, not x"):
            robot.masses = [x, 1]

    @pytest.mark.parametrize("value", [-1, -0.5, sp.sqrt(2) - 5, sp.Symbol("n", negative=True)])
    def test_negative(self, value):
        with pytest.raises(ValueError, match="m_1 of masses must not be negative, not"):
            two_links(masses=[value, 1])
        for name in ("rotor_inertias", "viscous_friction", "coulomb_friction"):
            with pytest.raises(ValueError, match=f"{name} of joint 2 must not be negative, not"):
                two_links(**{name: [1, value]})
        with pytest.raises(ValueError, match="coulomb_friction of joint 1 must not be negative"):
            two_links(coulomb_friction=[(1, value), 1])

    @pytest.mark.parametrize(
        "values", [sp.eye(2), np.eye(2), np.ones((2, 1, 1))], ids=["Matrix", "array", "3-d"]
    )
    def test_lists_of_wrong_shape(self, values):
        with pytest.raises(ValueError, match=r"masses must be one row or column, not an? "):
            two_links(masses=values)

    @pytest.mark.parametrize("value", [[0, 0], [0, 0, 0, 0], [], sp.Matrix([0, 0])])
    def test_vectors_of_wrong_length(self, value):
        n = len(value)
        with pytest.raises(ValueError, match=f"gravity must have 3 components, not {n}"):
            two_links(gravity=value)
        message = f"cm_positions of link 2 must have 3 components, not {n}"
        with pytest.raises(ValueError, match=message):
            two_links(cm_positions=[[0, 0, 0], value])
        with pytest.raises(ValueError, match=f"point must have 3 components, not {n}"):
            two_links().J_point(value, 1)

    @pytest.mark.parametrize("value", [sp.eye(3), np.eye(3), np.ones((3, 1, 1))])
    def test_vectors_of_wrong_shape(self, value):
        with pytest.raises(ValueError, match=r"gravity must be one row or column, not an? "):
            two_links(gravity=value)

    @pytest.mark.parametrize("value", [1, "123", None, {1: 1, 2: 2, 3: 3}, {1, 2, 3}])
    def test_vectors_that_are_none(self, value):
        with pytest.raises(TypeError, match="cm_positions of link 1 must be a list of values, not"):
            two_links(cm_positions=[value, [0, 0, 0]])

    @pytest.mark.parametrize(
        "value",
        [
            sp.eye(2),
            sp.ones(3, 4),
            np.eye(2),
            np.ones(4),
            [1, 2],
            [[1, 0], [0, 1, 0], [0, 0, 1]],
            [[1, 0, 0], [0, 1, 0]],
            "abc",
            5,
            None,
            [[1, 0, 0], 2, 3],
        ],
        ids=lambda value: str(value).replace("\n", ""),
    )
    def test_tensors_of_wrong_shape(self, value):
        message = "inertia tensor of link 2 must be a 3 x 3 matrix, or .*, not"
        with pytest.raises(ValueError, match=message):
            two_links(inertia_tensors=[sp.eye(3), value])

    def test_asymmetric_tensors(self):
        I = sp.Matrix([[1, 0, x], [0, 1, 0], [y, 0, 1]])
        message = "inertia tensor of link 2 must be symmetric: entry 1,3 is x, entry 3,1 is y"
        with pytest.raises(ValueError, match=message):
            two_links(inertia_tensors=[sp.eye(3), I])
        I = np.eye(3)
        I[1, 2] = 1e-6
        with pytest.raises(ValueError, match="link 1 must be symmetric: entry 2,3 is 1e-06"):
            two_links(inertia_tensors=[I, I])

    @pytest.mark.parametrize(
        ("pair", "error", "message"),
        [
            ((1, -1), ValueError, r"must be \(lower, upper\), but 1 > -1"),
            ((1.5, 1), ValueError, r"must be \(lower, upper\), but 3/2 > 1"),
            ((float("nan"), 1), ValueError, "must be finite, not nan"),
            ((0, float("inf")), ValueError, "must be finite, not inf"),
            ((-sp.oo, 0), ValueError, "must be finite, not -oo"),
            (("a", "b"), TypeError, "must be a number or a SymPy expression, not 'a'"),
            ((None, 1), TypeError, "must be a number or a SymPy expression, not None"),
            ((False, True), TypeError, "must be a number or a SymPy expression, not False"),
            ((-x, x), TypeError, "must be a number, not -x"),
            ((q1, 1), TypeError, "must be a number, not q_1"),
            ((1j, 2), ValueError, "must be real, not 1j"),
            ((0, 1, 2), ValueError, r"must be \(lower, upper\), not \(0, 1, 2\)"),
            ((0,), ValueError, r"must be \(lower, upper\), not \(0,\)"),
            (1, TypeError, "must be a list of values, not 1"),
            ("01", TypeError, "must be a list of values, not '01'"),
            ({0, 1}, TypeError, "must be a list of values"),
            ({"lower": 0, "upper": 1}, TypeError, "must be a list of values"),
            (True, TypeError, "must be a list of values, not True"),
        ],
    )
    def test_limits(self, pair, error, message):
        with pytest.raises(error, match=f"limits of joint 2 {message}"):
            two_links(joint_limits=[(0, 1), pair])

    @pytest.mark.parametrize("pair", [(1, 2, 3), []])
    def test_friction_of_more_than_two_directions(self, pair):
        message = r"coulomb_friction of joint 1 must be one value or \(forward, backward\), not"
        with pytest.raises(ValueError, match=message):
            two_links(coulomb_friction=[pair, 1])

    def test_a_wrong_value_leaves_the_robot_as_it_was(self):
        robot = complete()
        before = robot.inertia_matrix()
        with pytest.raises(ValueError, match="m_2 of masses"):
            robot.masses = [1, -1]
        with pytest.raises(ValueError, match="never assumed"):
            robot.gravity = None
        assert robot.masses == [m1, m2]
        assert robot.inertia_matrix() == before


class TestDefaults:
    def test_nothing_is_assumed_before_it_is_asked_for(self):
        robot = two_links()
        names = ["masses", "cm_positions", "inertia_tensors", "gravity"]
        names += ["rotor_inertias", "viscous_friction", "coulomb_friction"]
        assert [getattr(robot, name) for name in names] == [None] * 7
        assert set(robot.parameters) == {l1, l2}

    def test_masses_and_tensors_are_generated_when_set_to_none(self):
        robot = two_links(masses=None, inertia_tensors=None)
        assert robot.masses == list(sp.symbols("m_1 m_2"))
        assert robot.m(2) == sp.Symbol("m_2")
        diagonal = sp.diag(*sp.symbols("I_{x_2x_2} I_{y_2y_2} I_{z_2z_2}"))
        assert robot.I_cm(2) == robot.inertia_tensors[1] == diagonal

    @pytest.mark.parametrize("name", ["cm_positions", "gravity"])
    def test_centres_of_mass_and_gravity_are_never_generated(self, name):
        with pytest.raises(ValueError, match=f"{name} (is|are) never assumed: give"):
            two_links(**{name: None})

    @pytest.mark.parametrize("name", ["rotor_inertias", "viscous_friction", "coulomb_friction"])
    def test_rotors_and_friction_can_be_taken_away(self, name):
        robot = complete()
        plain = robot.dynamic_model()
        setattr(robot, name, [1, 2])
        assert robot.dynamic_model() != plain
        setattr(robot, name, None)
        assert getattr(robot, name) is None
        assert robot.dynamic_model() == plain

    def test_limits(self):
        robot = Robot((l1, 0, 0, q1), (0, 0, q2, 0, "p"))
        assert robot.joint_limits == [(-pi, pi), (0, 1000)]
        robot.joint_limits = [(-1, 1), (0, 0)]
        assert robot.joint_limits == [(-1, 1), (0, 0)]
        robot.joint_limits = [None, (1, 2)]
        assert robot.joint_limits == [(-pi, pi), (1, 2)]
        assert robot.with_parameters({}).joint_limits == robot.joint_limits
        robot.joint_limits = None
        assert robot.joint_limits == [(-pi, pi), (0, 1000)]

    @pytest.mark.parametrize(
        ("method", "arguments", "missing"),
        [
            ("m", (1,), "masses"),
            ("I_cm", (1,), "inertia_tensors"),
            ("I_cm0", (1,), "inertia_tensors"),
            ("r_cm", (1,), "cm_positions"),
            ("v_cm", (1,), "cm_positions"),
            ("J_cm_i", (1,), "cm_positions"),
            ("link_kinetic_energy", (1,), "masses"),
            ("link_potential_energy", (1,), "masses"),
            ("kinetic_energy", (), "masses"),
            ("potential_energy", (), "masses"),
            ("lagrangian", (), "masses"),
            ("dynamic_model", (), "masses"),
            ("inertia_matrix", (), "masses"),
            ("coriolis_matrix", (), "masses"),
            ("gravity_vector", (), "masses"),
            ("dynamic_model_matrix_form", (), "masses"),
            ("base_parameters", (), "gravity"),
        ],
    )
    def test_what_is_needed_says_which_setter_to_use(self, method, arguments, missing):
        with pytest.raises(ValueError, match=rf"{missing} not set: robot\.{missing} = "):
            getattr(two_links(), method)(*arguments)

    def test_each_thing_missing_is_named_in_turn(self):
        robot = two_links(masses=None)
        with pytest.raises(ValueError, match=r"robot\.cm_positions = "):
            robot.inertia_matrix()
        robot.cm_positions = [[0, 0, 0]] * 2
        with pytest.raises(ValueError, match=r"robot\.inertia_tensors = "):
            robot.inertia_matrix()
        with pytest.raises(ValueError, match=r"robot\.gravity = "):
            robot.gravity_vector()
        robot.inertia_tensors = None
        assert robot.inertia_matrix().shape == (2, 2)
        with pytest.raises(ValueError, match=r"robot\.gravity = "):
            robot.lagrangian()


class TestCopies:
    def test_changing_lists_changes_nothing(self):
        robot = complete()
        robot.coulomb_friction, robot.rotor_inertias = [(1, 2), 3], [4, 5]
        names = ["joint_types", "qs", "dh_parameters", "masses", "cm_positions", "inertia_tensors"]
        names += ["joint_limits", "coulomb_friction", "rotor_inertias", "Ts"]
        for name in names:
            before = getattr(robot, name)
            changed = getattr(robot, name)
            changed[0] = 0
            changed.append(1)
            assert getattr(robot, name) == before, name
        robot.parameters.clear()
        assert l1 in robot.parameters

    def test_changing_matrices_changes_nothing(self):
        robot = complete()
        robot.cm_positions[0][0] = robot.inertia_tensors[1][2, 2] = robot.gravity[1] = 7
        robot.I_cm(1)[0, 0] = robot.Ts[0][0, 0] = robot.T[0, 0] = robot.J[0, 0] = 7
        assert robot.cm_positions[0] == sp.Matrix([-x, 0, 0])
        assert robot.gravity == sp.Matrix([0, -g, 0])
        assert not (robot.I_cm(2) + robot.I_cm(1)).has(7)
        for method in ("inertia_matrix", "coriolis_matrix", "gravity_vector"):
            before = getattr(robot, method)()
            getattr(robot, method)()[0] = 7
            assert getattr(robot, method)() == before
        for method in ("T_i0", "R_i0", "r_o", "z", "J_cm_i", "r_cm", "I_cm0", "v_cm", "w"):
            before = getattr(robot, method)(1)
            getattr(robot, method)(1)[0] = 7
            assert getattr(robot, method)(1) == before
        before = robot.dynamic_model()
        robot.dynamic_model().clear()
        assert robot.dynamic_model() == before

    def test_what_was_given_comes_back_and_is_exact_inside(self):
        values = {
            "masses": [1.2, x],
            "cm_positions": [sp.Matrix([0.1, 0, 0])] * 2,
            "inertia_tensors": [sp.diag(0.3, 0.3, x)] * 2,
            "gravity": sp.Matrix([0, -9.81, 0]),
            "rotor_inertias": [0.1, 0],
            "viscous_friction": [0.7, x],
            "coulomb_friction": [(0.1, 0.2), (x, 0.3)],
            "joint_limits": [(-1.3, 1.3), (-sp.pi, 0.1)],
        }
        robot = two_links(**values)
        for name, value in values.items():
            assert getattr(robot, name) == value
        assert (robot.m(1), robot.I_cm(2)) == (1.2, values["inertia_tensors"][1])
        assert robot.arm.masses == (sp.Rational("1.2"), x)
        assert robot.arm.gravity[1] == -sp.Rational("9.81")
        again = robot.with_parameters({x: 0.4})
        assert again.masses == [1.2, 0.4]
        assert again.coulomb_friction == [(0.1, 0.2), (0.4, 0.3)]
        assert again.arm.masses[1] == sp.Rational("0.4")

    def test_changing_what_was_given_changes_nothing(self):
        masses, r, I = [m1, m2], sp.Matrix([x, 0, 0]), np.eye(3)
        positions, tensors, row = [r, r], [I, I], [l1, 0, 0, q1]
        robot = Robot(row, (l2, 0, 0, q2))
        robot.masses, robot.cm_positions, robot.inertia_tensors = masses, positions, tensors
        row[0] = masses[0] = r[0] = I[0, 0] = 7
        positions.clear()
        assert robot.masses == [m1, m2]
        assert robot.cm_positions == [sp.Matrix([x, 0, 0])] * 2
        assert robot.I_cm(1) == sp.Matrix(np.eye(3))
        assert robot.dh_parameters[0][0] == l1

    def test_setting_drops_what_was_computed_from_older_values(self):
        methods = ["inertia_matrix", "coriolis_matrix", "gravity_vector", "kinetic_energy"]
        methods += ["potential_energy", "lagrangian", "dynamic_model", "friction_vector"]
        methods += ["base_parameters", "regressor"]
        values = {
            "masses": [3, 4],
            "cm_positions": [[1, 0, 0], [2, 0, 0]],
            "inertia_tensors": [sp.eye(3) * 5] * 2,
            "gravity": [0, 0, -5],
            "rotor_inertias": [6, 7],
            "viscous_friction": [8, 9],
            "coulomb_friction": [1, (2, 3)],
        }
        used, set_so_far = complete(), {}
        for name, value in values.items():
            before = [getattr(used, method)() for method in methods]
            set_so_far[name] = value
            fresh = complete()
            for robot, settings in ((used, {name: value}), (fresh, set_so_far)):
                for key, setting in settings.items():
                    setattr(robot, key, setting)
            after = [getattr(used, method)() for method in methods]
            assert list(map(str, after)) == [str(getattr(fresh, method)()) for method in methods]
            assert list(map(str, after)) != list(map(str, before)), name


# -- warnings -------------------------------------------------------------------------------------

VELOCITY_DEPENDENT = ["v_cm", "w", "w_rel0", "link_kinetic_energy", "q_dot"]
VELOCITY_DEPENDENT_WHOLE = ["kinetic_energy", "lagrangian", "coriolis_matrix", "dynamic_model"]
VELOCITY_DEPENDENT_WHOLE += ["dynamic_model_matrix_form", "friction_vector", "regressor"]


class TestWarnings:
    def robot(self):
        robot = Robot((l1, 0, 0, x), (l2, 0, 0, q2))
        robot.masses = robot.inertia_tensors = None
        robot.cm_positions, robot.gravity = [[0, 0, 0]] * 2, [0, -g, 0]
        robot.viscous_friction = [1, 2]
        return robot

    @pytest.mark.parametrize("method", VELOCITY_DEPENDENT + VELOCITY_DEPENDENT_WHOLE)
    def test_velocities_of_plain_symbols(self, method):
        arguments = (1,) if method in VELOCITY_DEPENDENT else ()
        with pytest.warns(UserWarning, match=rf"{method}: .*for x is no function.*moro\.abc") as w:
            getattr(self.robot(), method)(*arguments)
        assert len(w) == 1
        assert w[0].filename == __file__

    def test_velocities_are_zero_then(self):
        with pytest.warns(UserWarning, match="v_cm"):
            assert self.robot().v_cm(1) == sp.zeros(3, 1)
        with pytest.warns(UserWarning, match="kinetic_energy"):
            energy = self.robot().kinetic_energy()
        assert energy == (m2 * l2**2 + sp.Symbol("I_{z_2z_2}")) * q2.diff(t) ** 2 / 2
        with pytest.warns(UserWarning, match="dynamic_model"):
            equations = self.robot().dynamic_model()
        assert not any(e.has(x.diff(t)) or e.atoms(sp.Dummy) for e in equations)

    def test_what_needs_no_velocities_does_not_warn(self):
        robot = self.robot()
        for method in ("inertia_matrix", "gravity_vector", "potential_energy", "base_parameters"):
            getattr(robot, method)()
        robot.J_cm_i(1)
        assert robot.T.shape == (4, 4)
        assert robot.q_dot(2) == q2.diff(t)

    def test_functions_of_time_do_not_warn(self):
        robot = complete()
        for method in VELOCITY_DEPENDENT:
            getattr(robot, method)(1)
        for method in VELOCITY_DEPENDENT_WHOLE:
            getattr(robot, method)()


# -- geometry -------------------------------------------------------------------------------------


def turn(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    T = np.eye(4)
    j, k = {"x": (1, 2), "z": (0, 1)}[axis]
    T[j, j] = T[k, k] = c
    T[j, k], T[k, j] = -s, s
    return T


def shift(axis, length):
    T = np.eye(4)
    T["xyz".index(axis), 3] = length
    return T


def link_transform(row, convention):
    a, twist, d, theta = (float(value) for value in row[:4])
    about_x, about_z = shift("x", a) @ turn("x", twist), turn("z", theta) @ shift("z", d)
    return about_z @ about_x if convention == "dh" else about_x @ about_z


def numbers(matrix, state):
    return np.array(sp.Matrix(matrix).subs(state).evalf(20), dtype=float)


GEOMETRIES = {
    "symbols": [(a1, alpha1, d1, q1), (0, 0, 0, q2 + alpha), (l1, -alpha, q3 + d3, x, "p")],
    "offsets": [(a1, pi / 2, 0.3, q1 + pi / 2), (0.2, 0, 0, q2 - pi), (0, pi, q3 + 0.5, 1.1, "p")],
    "floats": [
        (0.1, 1.5707963267948966, 0.2, q1 + 0.3),
        (0, -np.pi / 2, q2, 0, "p"),
        (1, 1, 1, q3),
    ],
    "parallel": [(a1, 0, 0, q1), (l1, pi, 0, q2 + pi / 3), (l2, 0, d3, q3)],
}


@pytest.mark.parametrize("convention", ["dh", "mdh"])
@pytest.mark.parametrize("name", GEOMETRIES)
def test_frames_against_products_of_matrices(name, convention):
    rows = GEOMETRIES[name]
    robot = Robot(*rows, convention=convention)
    rng = random.Random(name)
    state = {s: rng.uniform(-2, 2) for s in [*robot.qs, *robot.parameters]}
    steps = [
        link_transform([sp.sympify(v).subs(state) for v in row[:4]], convention) for row in rows
    ]
    frames = [np.eye(4)]
    for i, step in enumerate(steps, 1):
        frames.append(frames[-1] @ step)
        np.testing.assert_allclose(numbers(robot.Ts[i - 1], state), step, atol=1e-12)
    np.testing.assert_allclose(numbers(robot.T, state), frames[-1], atol=1e-12)
    for i in range(4):
        np.testing.assert_allclose(numbers(robot.R_i0(i), state), frames[i][:3, :3], atol=1e-12)
        np.testing.assert_allclose(numbers(robot.r_o(i), state)[:, 0], frames[i][:3, 3], atol=1e-12)
        np.testing.assert_allclose(numbers(robot.z(i), state)[:, 0], frames[i][:3, 2], atol=1e-12)
        for j in range(4):
            expected = np.linalg.inv(frames[j]) @ frames[i]
            np.testing.assert_allclose(numbers(robot.T_ij(i, j), state), expected, atol=1e-12)


def test_frames_seen_from_each_other_are_inverse():
    robot = Robot(*GEOMETRIES["symbols"])
    for i in range(4):
        assert robot.T_ij(i, i) == sp.eye(4)
        for j in range(4):
            assert robot.simplify(robot.T_ij(i, j) * robot.T_ij(j, i)) == sp.eye(4)


@pytest.mark.parametrize("seed", range(6))
def test_jacobian_of_a_point_against_differences(seed):
    rng = random.Random(seed)
    robot = random_robot(rng, 4, rng.choice(["dh", "mdh"]))
    link = rng.randint(1, 4)
    point = [rng.uniform(-1, 1) for _ in range(3)]
    T = robot.T_i0(link)
    state = {q: rng.uniform(-2, 2) for q in robot.qs}
    J = numbers(robot.J_point(point, link), state)
    assert J.shape == (6, 4)
    h = 1e-5
    for k, q in enumerate(robot.qs):
        ahead, behind = (numbers(T, state | {q: state[q] + s * h}) for s in (1, -1))
        rate = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(J[:3, k], (rate @ [*point, 1])[:3], atol=1e-8)
        W = rate[:3, :3] @ numbers(T, state)[:3, :3].T
        np.testing.assert_allclose(J[3:, k], [W[2, 1], W[0, 2], W[1, 0]], atol=1e-8)


def test_jacobian_of_a_tool_point():
    robot = two_links()
    tool = robot.J_point([x, y, 0], 2)
    expected = -(l2 + x) * sp.sin(q1 + q2) - y * sp.cos(q1 + q2)
    assert sp.expand(tool[0, 1] - expected) == 0
    assert robot.J_point(sp.Matrix([0, 0, 0]), 2) == robot.J
    assert robot.J_point([0, 0, 0], 1)[:, 1] == sp.zeros(6, 1)


def test_jacobians_of_centres_of_mass():
    robot = complete()
    for i in (1, 2):
        assert robot.J_cm_i(i) == robot.J_point(robot.cm_positions[i - 1], i)
        assert robot.J_cm_i(i) == robot.Jv_cm_i(i).col_join(robot.Jw_cm_i(i))


def test_relative_angular_velocities_add_up():
    robot = Robot((0, pi / 2, d1, q1), (l2, 0, 0, q2), (0, 0, q3, 0, "p"))
    total = sp.zeros(3, 1)
    for i in (1, 2, 3):
        total += robot.w_rel0(i)
        assert robot.simplify(total - robot.w(i)) == sp.zeros(3, 1)
    assert robot.w_rel0(2) == q2.diff(t) * robot.z(1)
    assert robot.w_rel0(3) == sp.zeros(3, 1)


# -- as a whole -----------------------------------------------------------------------------------


def test_shapes_of_everything():
    robot = complete()
    for method, shape in {
        "inertia_matrix": (2, 2),
        "coriolis_matrix": (2, 2),
        "gravity_vector": (2, 1),
        "friction_vector": (2, 1),
    }.items():
        assert getattr(robot, method)().shape == shape
    for method, shape in {
        "r_cm": (3, 1),
        "v_cm": (3, 1),
        "w": (3, 1),
        "w_rel0": (3, 1),
        "I_cm": (3, 3),
        "I_cm0": (3, 3),
        "J_cm_i": (6, 2),
        "Jv_cm_i": (3, 2),
        "Jw_cm_i": (3, 2),
        "T_i0": (4, 4),
        "R_i0": (3, 3),
        "r_o": (3, 1),
        "z": (3, 1),
    }.items():
        assert getattr(robot, method)(1).shape == shape
    for energy in (robot.kinetic_energy(), robot.link_potential_energy(1), robot.lagrangian()):
        assert isinstance(energy, sp.Expr)
    equations = robot.dynamic_model()
    assert [equation.rhs for equation in equations] == list(sp.symbols("tau_1 tau_2"))


class TestWithParameters:
    def test_values_are_put_in_everywhere(self):
        robot = complete()
        robot.viscous_friction, robot.coulomb_friction = [x, 1], [(x, y), 0]
        robot.rotor_inertias = [m1, 0]
        values = {l1: 2, "l_2": sp.Rational(1, 2), x: 3, m1: 5, g: 10}
        new = robot.with_parameters(values)
        symbols = {sp.Symbol(str(key)): value for key, value in values.items()}
        assert new.masses == [5, m2]
        assert new.cm_positions[0] == sp.Matrix([-3, 0, 0])
        assert new.gravity == sp.Matrix([0, -10, 0])
        assert new.viscous_friction == [3, 1]
        assert new.coulomb_friction == [(3, y), (0, 0)]
        assert new.rotor_inertias == [5, 0]
        for method in ("inertia_matrix", "coriolis_matrix", "gravity_vector", "friction_vector"):
            difference = getattr(robot, method)().subs(symbols) - getattr(new, method)()
            assert new.simplify(difference) == sp.zeros(*difference.shape)
        assert robot.masses == [m1, m2]
        assert set(new.parameters) == set(robot.parameters) - set(symbols)

    def test_the_rest_is_kept(self):
        robot = Robot((l1, alpha, d1, q1), (0, 0, q2 + d3, x, "p"), convention="mdh", name="an_arm")
        robot.masses, robot.joint_limits = None, [(-1, 1), (0, 2)]
        robot.parameters = {d1: 2, d3: 1}
        new = robot.with_parameters({l1: 1, d1: 3})
        assert (new.name, new.convention, new.joint_limits) == ("an_arm", "mdh", [(-1, 1), (0, 2)])
        assert new.parameters[d3] == 1
        assert ("masses", "assumed") in [row[:2] for row in new.model_summary()]
        assert new.dh_parameters == [(1, alpha, 3, q1), (0, 0, q2 + d3, x)]

    def test_symbols_may_change_places(self):
        new = two_links().with_parameters({l1: l2, l2: l1})
        assert [row[0] for row in new.dh_parameters] == [l2, l1]

    def test_floats_count_as_decimals_and_angles_as_quarter_turns(self):
        robot = Robot((l1, alpha, 0, q1), (l2, 0, 0, q2))
        new = robot.with_parameters({alpha: math.pi / 2, l1: 0.1})
        assert new.T[0, 2] == sp.sin(q1)
        assert new.r_o(1)[0] == 0.1 * sp.cos(q1)
        assert new.arm.rows[0].a == sp.Rational(1, 10)

    def test_nothing_to_put_in(self):
        assert two_links().with_parameters({}).dh_parameters == two_links().dh_parameters

    @pytest.mark.parametrize(
        ("values", "error", "message"),
        [
            ({x: 1}, ValueError, "x is not a symbol of the model; its symbols are l_1, l_2, m_1"),
            ({"l_3": 1}, ValueError, 'l_3 is not a symbol .*did you mean "l_'),
            ({q1: 1}, ValueError, r"q_1\(t\) is not a symbol of the model"),
            ({l1: 1, "l_1": 2}, ValueError, "l_1 is given two values"),
            ({l1: float("nan")}, ValueError, "value of l_1 must be finite, not nan"),
            ({l1: 1j}, ValueError, "value of l_1 must be real"),
            ({l1: "1"}, TypeError, "value of l_1 must be a number .*not '1'"),
            ({l1: None}, TypeError, "value of l_1 must be a number .*not None"),
            ({l1: q1}, ValueError, "value of l_1 must be constant"),
            ({m1: -1}, ValueError, "m_1 of masses must not be negative, not -1"),
            ([(l1, 1)], TypeError, "values must be a dictionary"),
            (None, TypeError, "values must be a dictionary"),
        ],
    )
    def test_wrong_values(self, values, error, message):
        with pytest.raises(error, match=message):
            two_links(masses=None).with_parameters(values)


class TestParameters:
    def test_are_the_free_symbols_of_the_model(self):
        robot = complete()
        assert set(robot.parameters) == {
            *(l1, l2, x, y, g, m1, m2),
            *(I for tensor in robot.inertia_tensors for I in tensor.free_symbols),
        }
        assert set(robot.parameters.values()) == {None}

    def test_defaults_come_first_and_in_order(self):
        robot = two_links(parameters={l2: 0.5, "l_1": 2})
        assert list(robot.parameters.items()) == [(l2, sp.Rational(1, 2)), (l1, 2)]

    @pytest.mark.parametrize(
        ("defaults", "error", "message"),
        [
            (None, TypeError, "parameters must be a dictionary"),
            ([l1], TypeError, "parameters must be a dictionary"),
            ({1: 1}, TypeError, "a parameter must be a symbol or its name, not 1"),
            ({q1: 1}, TypeError, "a parameter must be a symbol or its name"),
            ({l1: "1"}, TypeError, "default of l_1 must be a number"),
            ({l1: l2}, TypeError, "default of l_1 must be a number, not l_2"),
            ({l1: float("inf")}, ValueError, "default of l_1 must be finite"),
            ({"l1": 2}, ValueError, 'l1 is not a symbol of the model.*did you mean "l_1"'),
            ({"L_1": 2}, ValueError, 'did you mean "l_1"'),
            ({x: 1}, ValueError, "x is not a symbol of the model; its symbols are l_1, l_2"),
        ],
    )
    def test_wrong_defaults(self, defaults, error, message):
        with pytest.raises(error, match=message):
            two_links(parameters=defaults)


def test_declared_parameters_need_not_occur():
    robot = two_links()
    robot.declare({x: 2, "l_1": 1})
    assert list(robot.parameters.items()) == [(x, 2), (l1, 1), (l2, None)]
    assert list(robot.with_parameters({x: 1}).parameters) == [l1, l2]
    robot.parameters = {x: 3}
    assert robot.parameters[x] == 3


def test_model_summary():
    robot = two_links(masses=[1, x], inertia_tensors=None, joint_limits=[(-1, 1), (0, 1)])
    summary = {row[0]: row[1:] for row in robot.model_summary()}
    assert summary["rows"] == ("given", "2, dh, rr")
    assert summary["masses"] == ("given", "[1, x]")
    assert summary["inertia_tensors"][0] == "assumed"
    assert summary["cm_positions"] == (
        "not set",
        "robot.cm_positions = [[x, y, z], ...], in frame i",
    )
    assert summary["gravity"][0] == "not set"
    assert summary["viscous_friction"] == ("not set", "none; robot.viscous_friction = [value, ...]")
    assert summary["joint_limits"] == ("given", "[(-1, 1), (0, 1)]")
    assert two_links().model_summary()[-1][:2] == ("joint_limits", "assumed")
    robot.inertia_tensors = [full_tensor(1), full_tensor(2)]
    assert {row[0]: row[1] for row in robot.model_summary()}["inertia_tensors"] == "given"
    assert repr(robot.model_summary()).splitlines()[0].split() == ["quantity", "state", "value"]


def test_robots_print_themselves():
    robot = planar(2)
    assert repr(robot) == "<Robot robot: 2 joints RR, convention dh>"
    assert robot._repr_latex_().startswith("$")


def test_symbols_of_abc():
    from moro import abc

    assert abc.t == t == sp.Symbol("t")
    assert [abc.q1, abc.q6, abc.q12] == [joint_variable(i) for i in (1, 6, 12)]
    assert str(abc.q1) == "q_1(t)"
    for letter in ("l", "d", "m", "a", "alpha", "theta", "g", "tau"):
        assert getattr(abc, letter) == sp.Symbol(letter) == symbol(letter)
        assert getattr(abc, f"{letter}3") == sp.Symbol(f"{letter}_3") == symbol(letter, 3)
    assert (abc.lc, abc.lc3) == (symbol("lc"), symbol("lc", 3)) == sp.symbols("l_c l_c3")
    assert (sp.latex(abc.lc), sp.latex(abc.lc3)) == ("l_{c}", "l_{c3}")
    assert (abc.qd2, abc.qdd12) == (q2.diff(t), joint_variable(12).diff(t, 2))
    assert (abc.beta, abc.omega) == sp.symbols("beta omega")
    assert not {"pi", "I", "lambda"} & set(abc.__all__)
