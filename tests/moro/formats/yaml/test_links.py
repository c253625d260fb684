"""What robot.yaml and ``Robot.of`` say beyond rows of DH parameters, against what is known."""

import numpy as np
import pytest
import sympy as sp
from arms import random_rows
from trees import planar_tree

from moro import Robot
from moro.abc import alpha1, d1, g, joint_variable, l1, l2, lc1, m1, m2, q1, q2, q3, t
from moro.model import Drive

r, J, h, p, mp, x, y, z = sp.symbols("r J h p m_p x y z")
POINT = {"com": [0, 0, 0], "inertia": [0, 0, 0]}
ROW = {"joint": "revolute", "a": 0, "alpha": 0, "d": 0, "theta": 0}


def robot(*links, gravity=(0, 0, -g), **fields):
    return Robot.of({"links": links, "gravity": gravity, **fields})


def point(mass, *com):
    return {"mass": mass, "com": com, "inertia": [0, 0, 0]}


def equal(robot, a, b):
    return robot.simplify(sp.Matrix(a) - sp.Matrix(b)).is_zero_matrix


# -- placements -----------------------------------------------------------------------------------


def pendulum(**base):
    """A pendulum that turns about the z axis of a frame on its side; q1 = 0 is level."""
    link = {"joint": "revolute", "axis": "z", **point(m1, lc1, 0, 0)}
    return robot(link, base=base)


@pytest.mark.parametrize(("rpy", "sign"), [([sp.pi / 2, 0, 0], 1), ([-sp.pi / 2, 0, 0], -1)])
def test_gravity_stays_in_the_world_where_the_base_is_placed(rpy, sign):
    arm = pendulum(xyz=[0, 0, h], rpy=rpy)
    assert arm.gravity_vector()[0] == sign * g * lc1 * m1 * sp.cos(q1)
    assert arm.T_i0("base")[2, 3] == h
    assert arm.T_i0(1)[2, 3] == h


def test_an_arm_upside_down_has_the_gravity_of_one_whose_gravity_is_turned():
    row = dict(ROW, a=l1, alpha=sp.pi / 2, **point(m1, -lc1, 0, 0))
    down = robot(row, ROW | point(m2, x, y, z), base={"rpy": [sp.pi, 0, 0]})
    turned = robot(row, ROW | point(m2, x, y, z), gravity=(0, 0, g))
    assert equal(down, down.gravity_vector(), turned.gravity_vector())
    assert turned.convention == "dh"  # a bare chain of rows stays one
    assert down.convention == ""


@pytest.mark.parametrize("convention", ["dh", "mdh"])
def test_fixed_rows_are_products_of_the_texts(convention):
    rows = [(l1, sp.pi / 2, d1, 0), (x, alpha1, y, 0.3), (l2, 0, z, 0)]
    kinds = ["revolute", "fixed", "prismatic"]
    links = [
        dict(zip(("a", "alpha", "d", "theta"), row, strict=True), joint=kind)
        for row, kind in zip(rows, kinds, strict=True)
    ]
    found = robot(*links, convention=convention).T
    expected = sp.eye(4)
    for (a, alpha, d, theta), q in zip(rows, (("theta", q1), ("", 0), ("d", q2)), strict=True):
        d, theta = d + (q[1] if q[0] == "d" else 0), theta + (q[1] if q[0] == "theta" else 0)
        turn = sp.diag(sp.rot_axis3(-theta), 1)
        lift, shift = sp.eye(4), sp.eye(4)
        lift[2, 3], shift[0, 3] = d, a
        twist = shift * sp.diag(sp.rot_axis1(-alpha), 1)
        expected *= turn * lift * twist if convention == "dh" else twist * turn * lift
    there = {q1: 0.3, q2: 0.2, l1: 1.1, l2: 0.7, alpha1: 0.4, d1: 0.5, x: 0.6, y: -0.3, z: 0.8}
    assert np.allclose(np.array((found - expected).subs(there), float), 0, atol=1e-14)


@pytest.mark.parametrize("seed", range(6))
def test_rows_are_placements_and_axes(seed):
    """A row is a joint about z where the one before ends, and a frame fixed on what it moves."""
    rng = np.random.default_rng(seed)
    rows, links, placed = random_rows(rng, 3), [], []
    for i, (a, alpha, d, theta, kind) in enumerate(rows, 1):
        joint = {"r": "revolute", "p": "prismatic"}[kind]
        body = {"mass": i, "com": [a, 1, d], "inertia": [3, 4, 5]}
        links.append({"joint": joint, "a": a, "alpha": alpha, "d": d, "theta": theta, **body})
        moved = {"theta": theta} if kind == "r" else {"d": d}
        rest = {"xyz": [0, 0, d]} if kind == "r" else {"rpy": [0, 0, theta]}
        start = {"joint": joint, "axis": "z", **moved, "bodies": []}
        if kind == "p":
            start |= rest
        end = {"xyz": [a, 0, d if kind == "r" else 0], "rpy": [alpha, 0, 0]}
        placed += [start, {"joint": "fixed", **end, **body}]
    arm, same = robot(*links), robot(*placed)
    there = dict(zip(arm.qs, rng.uniform(-2, 2, 3), strict=True)) | {g: 9.81}
    for name in ("T", "inertia_matrix", "gravity_vector"):
        both = [getattr(x, name) for x in (arm, same)]
        one, other = (v.subs(there) if name == "T" else v().subs(there) for v in both)
        assert np.allclose(np.array(one - other, float), 0, atol=1e-12)


def test_axes_of_any_direction():
    level = {"joint": "revolute", "xyz": [0, 0, h], **point(m1, lc1, 0, 0)}
    for axis, sign in (("-y", 1), ([0, 1, 0], -1), ([0, -2, 0], 1)):
        arm = robot(level | {"axis": axis})
        assert arm.gravity_vector()[0] == sign * g * lc1 * m1 * sp.cos(sign * q1)
    assert robot(level | {"axis": "z"}).gravity_vector()[0] == 0


def test_placements_in_steps_and_as_matrices():
    steps = [{"xyz": [l1, 0, 0]}, {"rpy": [alpha1, 0, 0]}, {"xyz": [0, 0, d1], "rpy": [0, x, 0]}]
    link = {"joint": "revolute", "axis": "z"}
    arm = robot(link | {"placement": steps})
    R = sp.rot_axis1(-alpha1) * sp.rot_axis2(-x)
    shift = sp.Matrix([l1, 0, 0]) + sp.rot_axis1(-alpha1) * sp.Matrix([0, 0, d1])
    same = robot(link | {"R": R, "xyz": shift})
    assert equal(arm, arm.T, same.T)
    assert equal(arm, arm.T[:3, 3], shift)


def test_named_frames_and_the_tool():
    camera = {"camera": {"xyz": [0, 0, h], "rpy": [0, sp.pi / 2, 0]}}
    rows = dict(ROW, a=l1, name="upper", frames=camera), dict(ROW, a=l2)
    arm = robot(*rows, tool={"xyz": [x, 0, 0]})
    assert [f.name for f in arm.model().frames] == ["upper", "camera", "1", "2", "tool"]
    assert arm.T_i0("camera")[:3, 3] == arm.T_i0("upper")[:3, 3] + sp.Matrix([0, 0, h])
    assert arm.T_i0("upper") == arm.T_i0(1)
    assert arm.T_i0("tool") == arm.T
    assert equal(arm, arm.T[:3, 3], arm.r_o(2) + x * arm.R_i0(2)[:, 0])
    on_first = robot(*rows, tool={"link": "upper", "xyz": [x, 0, 0]})
    assert equal(arm, on_first.T[:3, 3], arm.r_o(1) + x * arm.R_i0(1)[:, 0])
    assert arm.T_i0("camera") == robot(*rows, tip="camera").T


# -- bodies ---------------------------------------------------------------------------------------


def test_a_payload_is_one_more_body():
    inertia = [sp.Symbol(f"I{k}") for k in "xyz"]
    link = dict(ROW, a=l1, mass=m1, com=[-lc1, 0, 0], inertia=[0, 0, J])
    payload = {"mass": mp, "com": [x, y, 0], "inertia": inertia}
    for place, about in (({}, 0), ({"xyz": [0, h, 0]}, h)):
        arm = robot(dict(link, bodies=[payload | place]))
        M = J + m1 * (l1 - lc1) ** 2 + inertia[2] + mp * ((l1 + x) ** 2 + (y + about) ** 2)
        assert sp.expand(arm.inertia_matrix()[0] - M) == 0
    turned = robot(dict(link, bodies=[payload | {"rpy": [sp.pi / 2, 0, 0]}]))
    M = J + m1 * (l1 - lc1) ** 2 + inertia[1] + mp * (l1 + x) ** 2
    assert sp.expand(turned.inertia_matrix()[0] - M) == 0
    where = {str(x.symbol): x.meaning for x in turned.model().parameters}
    assert where["m_p"] == "mass of body 1 of link 1"
    assert where["l_c1"] == "in com x of link 1"


def test_first_moments_without_a_mass():
    first = {"mass": 0, "first_moment": [h, 0, 0], "inertia": [0, 0, J]}
    arm = robot(
        {"joint": "revolute", "axis": "-y", **first, "inertia_about": "origin"}
        | {"inertia": [J] * 3}
    )
    assert arm.inertia_matrix()[0] == J
    assert arm.gravity_vector()[0] == g * h * sp.cos(q1)
    about_com = {"mass": m1, "com": [lc1, 0, 0], "inertia": [0, J, 0], "inertia_about": "origin"}
    assert robot({"joint": "revolute", "axis": "y", **about_com}).inertia_matrix()[0] == J


# -- trees ----------------------------------------------------------------------------------------


def test_a_tree_of_rows_is_the_one_of_placements():
    """Two arms on a trunk, as in tests/support."""
    lengths, parents = ("0", "l_1", "l_2", "l_1", "l_4"), (None, None, None, "trunk", None)
    links = []
    for i, (length, parent) in enumerate(zip(lengths, parents, strict=True), 1):
        m, r = sp.Symbol(f"m_{i}"), sp.Symbol(f"l_c{i}")
        link = {"joint": "revolute", "xyz": [sp.Symbol(length) if i > 1 else 0, 0, 0]}
        link |= {"mass": m, "com": [r, 0, 0], "inertia": [0, 0, sp.Symbol(f"I_{i}")]}
        links.append(
            link | ({"name": "trunk"} if i == 1 else {}) | ({"parent": parent} if parent else {})
        )
    found = robot(*links, gravity=(0, -g, 0), convention="mdh")
    expected = Robot.of(planar_tree())
    assert found.inertia_matrix() == expected.inertia_matrix()
    assert found.inertia_matrix()[1, 3] == 0
    assert found.gravity_vector() == expected.gravity_vector()


def test_links_are_numbered_by_their_joints_and_the_base_is_0():
    rows = dict(ROW, a=l1), {"joint": "fixed", "xyz": [0, 0, h]}, dict(ROW, a=l2, parent=1)
    arm = robot(*rows, dict(ROW, a=x, parent=0))
    assert [joint.parent for joint in arm.model().joints] == [-1, 0, -1]
    assert arm.T_i0("fixed_1")[2, 3] == h


# -- coordinates ----------------------------------------------------------------------------------


def free(rows, **fields):
    """The arm with a coordinate for each joint, and its torques."""
    arm = robot(*(ROW | row for row in rows), **fields)
    return arm, sp.Matrix([equation.lhs for equation in arm.dynamic_model()])


def test_the_torques_of_a_palletizer_are_those_of_the_free_arm():
    """tau = A^T tau_x for x = A q, theta4 = -q2 - q3: the user's case; row 5 has q4."""
    rows = [
        dict(a=0, alpha=sp.pi / 2, d=d1, **point(m1, 0, 0, 1)),
        dict(a=l1, **point(m2, lc1, 0, 0)),
        dict(a=l2, **point(1, 0, y, 0)),
        dict(a=h, alpha=-sp.pi / 2, **point(2, 0, x, 0)),
        dict(**point(mp, x, 0, z)),
    ]
    plain, torques = free(rows)
    coupled, found = free([*rows[:3], rows[3] | {"theta": -q2 - q3}, rows[4]])
    assert coupled.dof == 4
    A = sp.Matrix(5, 4, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, -1, 0, 0, 0, 0, 1])
    there = dict(zip(plain.qs, A * sp.Matrix(coupled.qs), strict=True))
    bound = A.T * torques.subs(there, simultaneous=True).doit()
    assert equal(coupled, found, bound)
    assert coupled.inertia_matrix().is_symmetric()


def test_a_slide_that_counts_downwards():
    arm = robot(dict(ROW, joint="prismatic", d=sp.Rational("0.246") - q1, **point(m1, 0, 0, 0)))
    assert arm.gravity_vector()[0] == -g * m1
    assert arm.T[2, 3] == sp.Rational("0.246") - q1


@pytest.mark.parametrize("form", [{"a": 0, "alpha": 0, "d": h, "theta": x}, {"xyz": [0, 0, h]}])
def test_a_screw(form):
    arm = robot(
        {"joint": "helical", "pitch": p, **form, "mass": m1, "com": [0, 0, 0], "inertia": [0, 0, J]}
    )
    rise = p / (2 * sp.pi)
    assert arm.dof == 1
    assert sp.expand(arm.inertia_matrix()[0] - J - m1 * rise**2) == 0
    assert sp.expand(arm.gravity_vector()[0] - g * m1 * rise) == 0
    assert sp.expand(arm.T[2, 3] - h - rise * q1) == 0


def test_numbers_of_joint_variables():
    """The next one is after the highest that the rows before have."""
    rows = [ROW, dict(ROW, theta=-q3), dict(ROW, theta=q2 + q3), ROW, dict(ROW, theta=2 * q1)]
    arm = robot(*rows)
    assert [j.terms for j in arm.model().joints] == [
        ((0, 1),), ((2, -1),), ((1, 1), (2, 1)), ((3, 1),), ((0, 2),)
    ]  # fmt: skip


# -- drives ---------------------------------------------------------------------------------------

FRICTION = {"viscous": 2, "coulomb": [3, 4], "static": 5, "stribeck_velocity": 6, "smooth": 7}


def test_drives_before_the_gear():
    """A motor that turns r times as fast: r^2 of inertia and viscous, r of dry friction."""
    row = dict(ROW, motor_inertia=J, gear_ratio=r, friction=FRICTION | {"side": "motor"})
    (found,) = robot(row).model().coordinates
    expected = Drive(r**2 * J, 2 * r**2, (3 * r, 4 * r), (5 * r, 5 * r), 6 / r, 7 / r)
    assert found.drive == expected
    behind = robot(dict(ROW, rotor_inertia=J, friction=FRICTION)).model().coordinates[0].drive
    assert behind == Drive(J, 2, (3, 4), (5, 5), 6, 7)


def test_gears_of_a_bare_chain_are_those_of_rows():
    row = dict(ROW, motor_inertia=2, gear_ratio=10, friction={"coulomb": 3, "side": "motor"})
    arm = robot(row, ROW)
    assert arm.convention == "dh"
    assert (arm.rotor_inertias, arm.coulomb_friction) == ([200, 0], [(30, 30), (0, 0)])


def test_a_spring_pulls_back():
    arm = robot(dict(ROW, stiffness=x, rest=y, **point(m1, 0, 0, 0)))
    assert sp.expand(arm.gravity_vector()[0] - x * (q1 - y)) == 0


def test_drives_of_coordinates_that_no_row_has_to_itself():
    rows = dict(ROW, theta=q1 + q2), dict(ROW, theta=q1 - q2)
    arm = robot(*rows, coordinates={"q1": {"rotor_inertia": J}, "q2": {"limits": [-1, 1]}})
    assert [x.drive.rotor_inertia for x in arm.model().coordinates] == [J, 0]
    assert arm.joint_limits == [(-sp.pi, sp.pi), (-1, 1)]


def test_names_of_joints():
    arm = robot(dict(ROW, joint_name="hip"), dict(ROW, theta=-q1, joint_name="knee"), ROW)
    assert [x.name for x in arm.model().joints] == ["hip", "knee", ""]
    assert arm.model().coordinates[0].name == "hip"


def test_a_file_and_a_dictionary_are_the_same(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "name: arm\n"
        "parameters: {m_p: 2, h: ~}\n"
        "base: {xyz: [0, 0, h], rpy: [pi, 0, 0]}\n"
        "links:\n"
        "  - {joint: revolute, axis: y, mass: m_p, com: [0.1, 0, 0], inertia: [1, 1, 1]}\n"
        "  - {joint: prismatic, xyz: [1, 0, 0], d: 1 - q2, bodies: []}\n"
    )
    body = {"mass": mp, "com": [0.1, 0, 0], "inertia": [1, 1, 1]}
    given = {
        "name": "arm",
        "parameters": {mp: 2, h: None},
        "base": {"xyz": [0, 0, h], "rpy": ["pi", 0, 0]},
        "links": [
            {"joint": "revolute", "axis": "y", **body},
            {"joint": "prismatic", "xyz": np.array([1, 0, 0]), "d": 1 - q2, "bodies": []},
        ],
    }
    assert Robot.load(path).model() == Robot.of(given).model()
    assert joint_variable(2) == q2
    assert t
