"""Links in the terms of texts and files, put together to a Model.

steps      placements as elementary motions: rpy, axes, what joins, what cancels
links      a link, how it is placed on its parent, how it moves there
bodies     bodies where they are given, brought to the frames of joints and added up
drives     friction and rotors of joints, at the coordinates that move them
tree       links in order, and what is wrong with them
parts      the chain to a tip, the tree on a link, joints that stand still
obstacles  what joints do not hold: loops, what flies freely
assembly   all of it to a Model
notes      what is to be said of it
"""

from moro.formats.assembly.assembly import Assembly
from moro.formats.assembly.links import Link, Motion
from moro.formats.assembly.notes import notes
from moro.formats.assembly.obstacles import Obstacle
from moro.formats.assembly.steps import inverse, joined, placed, rpy, to_axis, turn_y

__all__ = [
    "Assembly",
    "Link",
    "Motion",
    "Obstacle",
    "inverse",
    "joined",
    "notes",
    "placed",
    "rpy",
    "to_axis",
    "turn_y",
]
