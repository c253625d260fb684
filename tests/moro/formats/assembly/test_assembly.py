"""Links put together to a Model: what is fixed merges, frames keep their names."""

from dataclasses import replace

import pytest
import sympy as sp
from assemblies import X, arm, body, frames, gravity, joint, one, robot

from moro.formats.assembly import Link, Motion
from moro.model import PRISMATIC, REVOLUTE, Coordinate, Drive, Placement, Shift, Turn

R, pi, zero = sp.Rational, sp.pi, sp.Integer(0)


def test_what_is_fixed_merges_into_what_carries_it():
    model = arm().model()
    assert [x.name for x in model.joints] == ["upper_joint", "lower_joint"]
    assert [x.name for x in model.coordinates] == ["upper", "lower"]
    lower = model.bodies[1]
    # at 1, 3 and 4 on the x axis: flange's y axis is minus lower's x
    assert lower.mass == 2
    masses = [(1, 1), (R(1, 2), 3), (R(1, 2), 2)]
    assert sum(m * x for m, x in masses) == R(7, 2)
    assert lower.first_moment == (R(7, 2), 0, 0)
    about_y = 3 + sum(m * x * x for m, x in masses)
    assert lower.inertia == ((3, 0, 0), (0, about_y, 0), (0, 0, about_y))
    assert lower.central is None
    assert model.bodies[0].central is not None


def test_the_frame_of_every_link_is_known_by_its_name():
    model = arm().model()
    assert set(frames(model)) == {"base", "upper", "lower", "flange", "tool", "camera", "mast"}
    assert model.tip.name == "tool", "most links carry it"
    assert frames(model)["base"].link == frames(model)["mast"].link == -1
    assert frames(model)["camera"].link == 0
    tool = frames(model)["tool"]
    assert tool.link == 1
    assert sp.Matrix(tool.placement.p) == sp.Matrix([2, 0, 0])
    # in the frame of the joint, whose z axis is the link's y: x, -z, y
    assert sp.Matrix(frames(model)["camera"].placement.p) == sp.Matrix([1, -1, 0])


def test_links_come_in_any_order():
    links = arm().links
    model = replace(arm(), links=links[::-1]).model()
    assert {x.name for x in model.joints} == {"upper_joint", "lower_joint"}
    assert [x.parent for x in model.joints] == [-1, 0]
    assert [x.name for x in model.coordinates] == ["upper", "lower"], "their own order"


def test_a_joint_moves_by_terms_in_coordinates():
    model = robot(
        Link("base", None),
        joint("a", "base", bodies=(body(),)),
        joint("b", "a", q="a", ratio=R(-2), offset=R(1, 2), bodies=(body(),)),
        Link("c", "b", (Motion(PRISMATIC, (("a", one), ("c", one), ("a", -one))),), (body(),)),
    ).model()
    assert [x.terms for x in model.joints] == [((0, 1),), ((0, -2),), ((1, 1),)]
    assert model.joints[1].offset == R(1, 2)
    assert len(model.coordinates) == 2


def test_helical_and_planar_joints_are_several_motions():
    pitch = sp.Symbol("pitch")
    screw = (Motion(REVOLUTE, (("s", one),)), Motion(PRISMATIC, (("s", pitch / (2 * pi)),)))
    model = robot(Link("base", None), Link("nut", "base", screw, (body(),))).model()
    assert [x.type for x in model.joints] == [REVOLUTE, PRISMATIC]
    assert [x.terms for x in model.joints] == [((0, 1),), ((0, pitch / (2 * pi)),)]
    assert model.bodies[0].mass == 0
    assert len(model.coordinates) == 1


def test_a_motion_that_never_moves_is_a_placement():
    still = (Motion(REVOLUTE, (("a", zero),), pi / 2), Shift(X))
    links = Link("base", None), joint("a", "base", bodies=(body(),)), Link("b", "a", still)
    model = robot(*links).model()
    assert len(model.joints) == 1
    assert frames(model)["b"].placement.p == (0, 1, 0)


def test_joints_frictions_are_those_of_their_coordinates():
    drive = Drive(viscous=R(1), coulomb=(R(1), R(2)))
    links = (
        Link("base", None),
        joint("a", "base", drive=drive),
        joint("b", "a", q="a", ratio=R(-3), drive=drive),
    )
    coordinates = {"a": Coordinate(drive=Drive(rotor_inertia=R(5)))}
    model = robot(*links, coordinates=coordinates).model()
    assert model.coordinates[0].drive == Drive(R(5), R(10), (R(7), R(5)))


def test_what_no_drive_and_no_link_has_is_not_set():
    """So that there are no base parameters for it, and rotors do not join bodies."""
    drives = {"rotor_inertias", "viscous_friction", "coulomb_friction"}
    assert arm().model().not_set == drives
    bare = replace(arm(), links=tuple(replace(link, bodies=()) for link in arm().links))
    assert bare.model().not_set == drives | {"masses", "cm_positions", "inertia_tensors"}
    driven = robot(joint("upper", None, drive=Drive(viscous=one)))
    assert "viscous_friction" not in driven.model().not_set


def test_friction_of_a_joint_that_two_coordinates_move_is_refused():
    drive = Drive(viscous=one)
    both = Motion(REVOLUTE, (("a", one), ("b", -one)), name="palm", drive=drive)
    links = Link("base", None), joint("a", "base"), joint("b", "a"), Link("palm", "b", (both,))
    with pytest.raises(ValueError, match="joint palm, which a and b move together"):
        robot(*links).model()


def test_parallel_axes_stay_parallel():
    """Placements between them are shifts, whatever way the file turns there and back."""
    axis = (one, R(2), R(3))
    links = (
        Link("base", None),
        joint("a", "base", axis=axis, rpy=(R("0.1"), R("0.2"), R("0.3"))),
        joint("b", "a", axis=axis),
        joint("c", "b", axis=axis),
    )
    model = robot(*links).model()
    assert [x.placement for x in model.joints[1:]] == [Placement(), Placement()]


def test_a_turn_about_the_axis_goes_into_the_offset():
    links = Link("base", None), joint("a", "base", rpy=(zero, zero, R("0.3")))
    model = robot(*links).model()
    assert (model.joints[0].placement, model.joints[0].offset) == (Placement(), R("0.3"))


def test_a_placed_base():
    base = Link("base", None, (Shift((zero, zero, one)), Turn("x", pi)))
    model = robot(base, joint("a", "base", bodies=(body(),))).model()
    assert model.joints[0].placement.p == (0, 0, 1)
    assert model.gravity == gravity
    assert frames(model)["base"].placement.p == (0, 0, 1)


@pytest.mark.parametrize(
    ("links", "message"),
    [
        ((Link("a", None), Link("a", None)), "two links are called a"),
        ((Link("base", None), Link("b", "bse")), 'b is on bse, which is no link; did you.*"base"'),
        ((Link("a", "b"), Link("b", "c"), Link("c", "b")), "in a circle: b, c"),
        ((Link("a", None), Link("b", "a")), "robot has no joint that moves"),
        ((Link("a", None), joint("b", "a", q="x")), "no joint of robot that moves is called x"),
    ],
)
def test_what_is_no_tree_is_refused(links, message):
    with pytest.raises(ValueError, match=message):
        robot(*links, coordinates={"b": Coordinate()}).model()
