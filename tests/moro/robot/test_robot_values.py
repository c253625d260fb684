"""Masses, tensors and all else that is set: what is taken, and what a wrong one is told."""

import numpy as np
import pytest
import sympy as sp
from robots import complete, two_links

from moro import Robot
from moro.abc import (
    g,
    l1,
    l2,
    m1,
    m2,
    q1,
    q2,
    t,
)

pi = sp.pi
x, y = sp.symbols("x y")


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
            ((1.5, 1), ValueError, r"must be \(lower, upper\), but 1.5 > 1"),
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
