"""The chain to a tip, the tree on a link, joints that stand still."""

import pytest
import sympy as sp
from assemblies import Y, arm, body, fixed, frames, joint, robot

from moro.formats.assembly import Link
from moro.model import Coordinate

R, pi, zero = sp.Rational, sp.pi, sp.Integer(0)


def torso(**more):
    """Two arms on a waist, a fixed head on it, a hand with two fingers on the left one."""
    return robot(
        Link("pelvis", None),
        joint("waist", "pelvis", (0, 0, 1), bodies=(body(10),)),
        joint("left", "waist", (0, 1, 0), Y, rpy=(-pi / 2, zero, zero), bodies=(body(3),)),
        joint("right", "waist", (0, -1, 0), Y, bodies=(body(3),)),
        fixed("head", "waist", (0, 0, 1), bodies=(body(5),)),
        joint("eye", "head", bodies=(body(1),)),
        fixed("wrist", "left", (1, 0, 0), bodies=(body(1),)),
        fixed("hand", "wrist", bodies=(body(1),)),
        joint("thumb", "hand", bodies=(body(1),)),
        joint("finger", "hand", q="thumb", ratio=R(-1), offset=R(1, 2), bodies=(body(1),)),
        **more,
    )


def names(model):
    return [coordinate.name for coordinate in model.coordinates]


def test_a_chain_ends_at_its_tip():
    model = torso().part(tip="wrist").model()
    assert names(model) == ["waist", "left"]
    assert model.tip.name == "wrist"
    assert "hand" not in frames(model)
    assert model.bodies[1].mass == 4, "the wrist is there, the hand on it is not"


def test_what_is_fixed_on_the_way_stays_and_what_moves_there_goes():
    part = torso().part(tip="wrist")
    model = part.model()
    assert model.bodies[0].mass == 15, "with the head"
    assert not {"eye", "right"} & set(frames(model))
    assert dict(part.notes)["part"] == "5 links, without 5 others"


def test_several_tips():
    model = torso().part(tip=["right", "hand"]).model()
    assert names(model) == ["waist", "left", "right"]
    assert model.tip.name == "hand"
    assert model.bodies[1].mass == 5
    assert names(torso().part(tip=["left", "thumb"]).model()) == ["waist", "left", "thumb"]


def test_a_tree_on_a_link():
    model = torso().part(root="left").model()
    assert names(model) == ["thumb"]
    assert frames(model)["left"].link == -1
    # left's y axis points down, its z axis along the pelvis' y
    assert model.gravity == (0, R("9.81"), 0)
    assert names(torso().part("waist", "left").model()) == ["left"]


def test_joints_that_stand_still():
    model = torso().fixed({"left": pi / 2}).model()
    assert names(model) == ["waist", "right", "eye", "thumb"]
    assert model.bodies[0].mass == 10 + 3 + 5 + 1 + 1
    # left's z axis is the waist's y: a quarter turn about y brings the wrist's way to -y, from +y
    assert frames(model)["wrist"].placement.p == (0, 0, 0)


def test_what_follows_a_joint_stands_still_with_it():
    model = torso().fixed({"thumb": R(1, 4)}).part(tip="finger").model()
    assert names(model) == ["waist", "left"]
    R_finger = sp.Matrix(frames(model)["finger"].placement.R)
    R_hand = sp.Matrix(frames(torso().model())["hand"].placement.R)
    assert (R_hand.T * R_finger)[1, 0].evalf() == pytest.approx(float(sp.sin(R(1, 4))), 1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tip": "wrst"}, 'tip: no link is called wrst; did you mean "wrist".*there are pelvis'),
        ({"root": "wast"}, 'root: no link is called wast; did you mean "waist"'),
        ({"root": "left", "tip": "right"}, "tip: right is not on left"),
        ({"root": "hand", "tip": "hand"}, "no joint that moves"),
    ],
)
def test_what_is_no_part_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        torso().part(**change).model()


def test_what_is_no_joint_is_refused():
    with pytest.raises(ValueError, match=r'no joint of robot that moves is called thum.*"thumb"'):
        torso().fixed({"thum": zero})
    with pytest.raises(TypeError, match="tip must be a name, not 3"):
        torso().part(tip=[3])


def test_standing_still_where_a_joint_cannot_go_is_warned_of():
    limited = {name: Coordinate(limits=(R(-1), R(1))) for name in ("upper", "lower")}
    with pytest.warns(UserWarning, match=r"upper is fixed at 2, beyond its limits -1\.\.1"):
        arm(coordinates=limited).fixed({"upper": R(2)})
