"""Parts of a tree of links: the chain to a tip, the tree on a link, joints that stand still."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.formats.assembly.links import Link, Motion
from moro.formats.assembly.tree import by_name, children, known, way
from moro.model import Shift, Turn
from moro.model.placement import Step

_ZERO = sp.Integer(0)


def tree_on(links: Sequence[Link], root: str) -> tuple[list[Link], list[Step]]:
    """Return the links on ``root`` and what they carry, and the way to root from the world.

    Root stands in the world then; joints on the way stand still, at zero.
    """
    there = by_name(links)
    known(root, there, "root", "no link")
    steps = [step for link in reversed([*way(there, root)]) for step in _at_rest(link.path)]
    on = children(links)
    found, waiting = [replace(there[root], parent=None, path=())], [root]
    while waiting:
        for link in on.get(waiting.pop(), ()):
            found.append(link)
            waiting.append(link.name)
    names = {link.name for link in found}
    return [found[0], *(link for link in links if link.name in names - {root})], steps


def chains_to(links: Sequence[Link], tips: Sequence[str]) -> list[Link]:
    """Return the links on the way to the tips, and what is fixed to them, or spins, on the way.

    The robot ends at a tip: what is on it is not there. ValueError for a tip that is no link.
    """
    there = by_name(links)
    for tip in tips:
        known(tip, there, "tip", "no link")
    kept = {link.name for tip in tips for link in way(there, tip)}
    driven = {q for link in links if not link.spins for x in link.motions for q, _ in x.terms}
    on = children(links)
    ends = {tip for tip in tips if not any(tip in _above(there, other) for other in tips)}
    waiting = [name for name in kept if name not in ends]
    while waiting:
        for link in on.get(waiting.pop(), ()):
            if link.name not in kept and (link.spins or not link.motions):
                kept.add(link.name)
                waiting.append(link.name)
    left = {
        q
        for link in links
        if link.name in kept and not link.spins
        for x in link.motions
        for q, _ in x.terms
    }
    found = [link for link in links if link.name in kept or _is_spun(link, kept, left)]
    still = dict.fromkeys(driven - left, _ZERO)  # what drove a joint that is not there
    return [held([link], still)[0] if link.spins else link for link in found]


def _is_spun(link: Link, kept: Container[str], coordinates: set[str]) -> bool:
    """Whether a link is a rotor, in the world or on some links, that coordinates spin."""
    there = link.spins and (link.parent is None or link.parent in kept)
    return there and coordinates.issuperset(q for x in link.motions for q, _ in x.terms)


def _above(links: Mapping[str, Link], name: str) -> set[str]:
    """Return the names of the links that carry a link."""
    return {link.name for link in way(links, name)} - {name}


def held(links: Iterable[Link], values: Mapping[str, Any]) -> list[Link]:
    """Return links without the coordinates ``values``, which stand still there."""
    return [replace(link, path=tuple(_held(step, values) for step in link.path)) for link in links]


def _held(step: Step | Motion, values: Mapping[str, Any]) -> Step | Motion:
    if not isinstance(step, Motion):
        return step
    offset = step.offset + sum(r * values[q] for q, r in step.terms if q in values)
    terms = tuple((q, r) for q, r in step.terms if q not in values and r != 0)
    if terms:
        return replace(step, terms=terms, offset=offset)
    return still(step, offset)


def still(motion: Motion, x: Any) -> Step:
    """Return where a motion is at x."""
    turn, slide = motion.type.displacement(x)
    return Turn("z", turn) if motion.type.is_angle else Shift((_ZERO, _ZERO, slide))


def _at_rest(path: Iterable[Step | Motion]) -> list[Step]:
    return [still(step, step.offset) if isinstance(step, Motion) else step for step in path]
