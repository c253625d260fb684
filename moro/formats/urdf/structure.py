"""Whether the links of a file are one tree, and which coordinate moves each joint."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from moro.formats.errors import Problem, nearest
from moro.formats.urdf.elements import Joint, Link, Mimic
from moro.formats.xml import Element

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)

#: coordinates of a planar joint: its name and these
PLANAR = ("x", "y", "theta")


def problems(robot: Element, links: Sequence[Link], joints: Sequence[Joint]) -> Iterator[Problem]:
    """Yield what keeps links from being one tree, and joints from following others."""
    if not links:
        yield Problem(robot.line, "<robot>", "there is no <link> in it")
    yield from _doubles("link", links)
    yield from _doubles("joint", joints)
    there, known = {x.name: x for x in links}, {x.name: x for x in joints}
    yield from _ends(joints, there)
    yield from _two_parents(joints)
    yield from _roots(joints, there)
    yield from _planar(known)
    yield from _mimics(known)


def root(links: Iterable[Link], joints: Iterable[Joint]) -> Link:
    """Return the link that no joint carries."""
    carried = {joint.child for joint in joints}
    return next(link for link in links if link.name not in carried)


def in_order(joints: Iterable[Joint], top: Link) -> list[Joint]:
    """Return the joints depth first, those on one link in the order of the file."""
    on: dict[str, list[Joint]] = {}
    for joint in joints:
        on.setdefault(joint.parent, []).append(joint)
    found: list[Joint] = []
    waiting = [*reversed(on.get(top.name, []))]
    while waiting:
        joint = waiting.pop()
        found.append(joint)
        waiting += reversed(on.get(joint.child, []))
    return found


def followed(joint: Joint, joints: Mapping[str, Joint]) -> tuple[str, Any, Any]:
    """Return (name of the joint that it follows, or its own; ratio, offset), through all mimics.

    Of a joint that does not move: the ratio is 0.
    """
    ratio, offset = _ONE, _ZERO
    while (mimic := joint.mimic) is not None:
        ratio, offset = ratio * mimic.multiplier, offset + ratio * mimic.offset
        joint = joints[mimic.joint]
    return joint.name, ratio if joint.type != "fixed" else _ZERO, offset


def coordinates(joint: Joint) -> tuple[str, ...]:
    """Return the names of the coordinates that a joint brings."""
    if joint.type == "planar":
        return tuple(f"{joint.name}_{x}" for x in PLANAR)
    return (joint.name,) if joint.type != "fixed" and joint.mimic is None else ()


def _doubles(what: str, found: Iterable[Link | Joint]) -> Iterator[Problem]:
    first: dict[str, int] = {}
    for each in found:
        if each.name in first:
            message = f"another {what} is called `{each.name}`, in line {first[each.name]}"
            yield Problem(each.line, f"<{what} name>", message)
        first.setdefault(each.name, each.line)


def _planar(joints: Mapping[str, Joint]) -> Iterator[Problem]:
    for joint in joints.values():
        for name in coordinates(joint):
            if name != joint.name and name in joints:
                message = f"its coordinate {name} is called like the joint in line"
                yield Problem(joint.line, f"joint {joint.name}", f"{message} {joints[name].line}")


def _ends(joints: Iterable[Joint], links: Mapping[str, Link]) -> Iterator[Problem]:
    for joint in joints:
        for tag, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                message = f"there is no link `{name}`{nearest(name, links)}"
                yield Problem(joint.line, f"<{tag} link> of joint {joint.name}", message)
        if joint.parent == joint.child:
            yield Problem(joint.line, f"joint {joint.name}", "parent and child are the same link")


def _two_parents(joints: Iterable[Joint]) -> Iterator[Problem]:
    first: dict[str, Joint] = {}
    for joint in joints:
        other = first.setdefault(joint.child, joint)
        if other is not joint:
            message = f"link {joint.child} has a parent by joint {other.name} (line {other.line})"
            yield Problem(joint.line, f"<child link> of joint {joint.name}", message)


def _roots(joints: Iterable[Joint], links: Mapping[str, Link]) -> Iterator[Problem]:
    """Find links that hang on no root, and roots beside the first."""
    parents = {joint.child: joint.parent for joint in reversed([*joints])}
    tops = [link for link in links.values() if link.name not in parents]
    for link in tops[1:]:
        message = f"is on no joint, and neither is {tops[0].name} (line {tops[0].line}): one root"
        yield Problem(link.line, f"link {link.name}", message)
    done = {link.name for link in tops}
    for name in links:
        way: dict[str, None] = {}
        at = name
        while at not in done and at not in way and at in links:
            way[at] = None
            at = parents.get(at, "")
        if at in way:
            circle = [*way][[*way].index(at) :]
            listed = ", ".join(reversed(circle))
            yield Problem(links[at].line, f"link {at}", f"carries itself: {listed}")
        done |= set(way)


def _mimics(joints: Mapping[str, Joint]) -> Iterator[Problem]:
    for joint in joints.values():
        if joint.mimic is None:
            continue
        mimic, of = joint.mimic, f"<mimic joint> of joint {joint.name}"
        other = joints.get(mimic.joint)
        if other is None:
            message = f"there is no joint `{mimic.joint}`{nearest(mimic.joint, joints)}"
            yield Problem(mimic.line, of, message)
        elif "planar" in (joint.type, other.type):
            planar = joint if joint.type == "planar" else other
            message = f"{planar.name} is planar: it has three coordinates, and follows none"
            yield Problem(mimic.line, of, message)
        elif joint.name in (seen := _chain(mimic, joints)):
            yield Problem(mimic.line, of, f"follows itself: {', '.join((joint.name, *seen))}")


def _chain(mimic: Mimic | None, joints: Mapping[str, Joint]) -> list[str]:
    """Return the joints that one follows, until there is none more or one comes back."""
    seen: list[str] = []
    while mimic is not None and mimic.joint in joints and mimic.joint not in seen:
        seen.append(mimic.joint)
        mimic = joints[mimic.joint].mimic
    return seen
