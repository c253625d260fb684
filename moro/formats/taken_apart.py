"""A Model taken apart into links, as if it had been put together of them."""

from __future__ import annotations

from moro.formats.assembly import Assembly, Link, Motion, inverse, joined
from moro.formats.assembly.bodies import moved
from moro.formats.assembly.steps import placed
from moro.model import Body, Frame, Model, Placement
from moro.model.placement import Step


def taken_apart(model: Model) -> Assembly:
    """Return links, one for each joint, whose ``model()`` this is; frames are links that are fixed.

    A link's frame is the one that has its number, as those of rows of DH parameters do, or else
    that of the joint. If another frame is there, the link is called by its name.
    """
    own = [_own_frame(model, i) for i in range(len(model.joints))]
    names: list[str | None] = [frame.name for frame in own]
    after = [joined(frame.placement.steps) for frame in own]
    links = []
    for i, joint in enumerate(model.joints):
        before = joined(joint.placement.steps)
        if joint.parent >= 0:
            before = joined((*inverse(after[joint.parent]), *before))
        terms = tuple((f"q{j + 1}", ratio) for j, ratio in joint.terms)
        motion = Motion(joint.type, terms, joint.offset, joint.name)
        body = _in(model.bodies[i], after[i])
        path = (*before, motion, *after[i])
        links.append(Link(own[i].name, _parent(names, joint.parent), path, (body,)))
    for frame in model.frames:
        if frame not in own:
            steps = frame.placement.steps
            if frame.link >= 0:
                steps = joined((*inverse(after[frame.link]), *steps))
            links.append(Link(frame.name, _parent(names, frame.link), steps))
    return Assembly(
        model.name,
        tuple(links),
        {f"q{j}": x for j, x in enumerate(model.coordinates, 1)},
        model.gravity,
        model.tip.name,
        model.parameters,
        model.not_set,
    )


def _own_frame(model: Model, i: int) -> Frame:
    there = [frame for frame in model.frames if frame.link == i]
    own = next((x for x in there if x.name == str(i + 1)), Frame(str(i + 1), i, Placement()))
    place = joined(own.placement.steps)
    called = (x for x in there if not x.name.isdigit() and joined(x.placement.steps) == place)
    return next(called, own)


def _parent(names: list[str | None], i: int) -> str | None:
    return names[i] if i >= 0 else None


def _in(body: Body, steps: tuple[Step, ...]) -> Body:
    """Return a body in a frame that is the steps away from the one that it is given in."""
    return moved(body, placed(inverse(steps)))
