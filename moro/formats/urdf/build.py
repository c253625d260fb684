"""From what a file says to links that can be put together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import sympy as sp

from moro.formats import assembly
from moro.formats.assembly import Assembly, Motion, inverse, placed, rpy, to_axis
from moro.formats.assembly.bodies import central_body
from moro.formats.urdf.elements import MOTIONS, Joint, Link, Origin
from moro.formats.urdf.structure import coordinates, followed, in_order, root
from moro.model import PRISMATIC, REVOLUTE, Body, Coordinate, Shift
from moro.model.placement import Step
from moro.spatial.vectors import product, transpose

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
#: in the frame of the root link [m/s^2]
GRAVITY = (_ZERO, _ZERO, -sp.Rational("9.81"))
_X, _Y = (_ONE, _ZERO, _ZERO), (_ZERO, _ONE, _ZERO)


def build(name: str, links: Sequence[Link], joints: Sequence[Joint]) -> Assembly:
    """Return the robot of a file's links and joints, of which there are no problems."""
    there, known = {x.name: x for x in links}, {x.name: x for x in joints}
    top = root(links, joints)
    order = in_order(joints, top)
    return Assembly(
        name,
        (
            assembly.Link(top.name, None, (), _bodies(top)),
            *(_link(joint, there[joint.child], known) for joint in order),
        ),
        {q: Coordinate(limits=joint.limits, name=q) for joint in order for q in coordinates(joint)},
        GRAVITY,
    )


def _link(joint: Joint, link: Link, joints: Mapping[str, Joint]) -> assembly.Link:
    path = (*_origin(joint.origin), *_motions(joint, joints))
    return assembly.Link(link.name, joint.parent, path, _bodies(link))


def _motions(joint: Joint, joints: Mapping[str, Joint]) -> Iterator[Step | Motion]:
    """Yield how a joint moves, about or along its axis; in the plane across it if it is planar."""
    if joint.type == "fixed":
        return
    turn = to_axis(joint.axis)
    yield from turn
    if joint.type == "planar":
        x, y, theta = coordinates(joint)
        for q, axis in ((x, _X), (y, _Y)):
            across = to_axis(axis)
            motion = Motion(PRISMATIC, ((q, _ONE),), name=q, drive=joint.drive)
            yield from (*across, motion, *inverse(across))
        yield Motion(REVOLUTE, ((theta, _ONE),), name=theta, drive=joint.drive)
    else:
        q, ratio, offset = followed(joint, joints)
        terms = ((q, ratio),) if ratio != 0 else ()
        yield Motion(MOTIONS[joint.type], terms, offset, joint.name, joint.drive)
    yield from inverse(turn)


def _origin(origin: Origin) -> tuple[Step, ...]:
    return (Shift(origin.xyz), *rpy(*origin.rpy))


def _bodies(link: Link) -> tuple[Body, ...]:
    """Return the body of a link, its tensor in the axes of the link."""
    given = link.inertial
    if given is None:
        return ()
    R = placed(rpy(*given.origin.rpy)).R
    tensor = product(product(R, given.inertia), transpose(R))
    return (central_body(given.mass, given.origin.xyz, tensor),)
