"""Names of links and frames in a robot file, and where they are referred to.

A link that moves has a number too: the first is 1, and 0 is the base.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from moro.checks.meant import nearest
from moro.formats.yaml.expressions import quoted
from moro.formats.yaml.problems import Location
from moro.formats.yaml.schema import Link, RobotFile

#: what the frames of the base and of the tool are called, where they are given
BASE = "base"
TOOL = "tool"


@dataclass
class References:
    """What links are called, and what they are on; None: the world, where there is no base."""

    names: list[str] = field(default_factory=list)
    parents: list[str | None] = field(default_factory=list)
    #: the link of the tool
    tool: str | None = None
    #: the frame that is the robot's tip
    tip: str = ""
    wrong: list[tuple[Location, str]] = field(default_factory=list)


def references(file: RobotFile) -> References:
    """Return the names and parents of all links, and what is wrong with them."""
    found = References()
    base = None if file.base is None else BASE
    #: what a name or number stands for, above the link at hand
    known: dict[str, str | None] = {"0": base}
    if base:
        known[base] = base
    count = Counter[str]()
    last: str | None = base
    for i, link in enumerate(file.links):
        kind = link.joint if link.joint in ("fixed", "rotor") else ""
        count[kind] += 1
        own = f"{kind}_{count[kind]}" if kind else str(count[kind])
        found.parents.append(
            last
            if link.parent is None
            else _referred(link.parent, known, ("links", i, "parent"), found)
        )
        found.names.append(link.name or own)
        if link.joint != "rotor":  # which carries nothing
            last = found.names[-1]
            known |= dict.fromkeys((last, own), last)
    if file.tool is not None:
        link_of_tool = file.tool.link
        at: Location = (TOOL, "link")
        found.tool = last if link_of_tool is None else _referred(link_of_tool, known, at, found)
        known[TOOL] = last = TOOL
    known |= {name: name for link in file.links for name in link.frames}
    found.tip = last or ""
    if file.tip is not None:
        found.tip = _referred(file.tip, known, ("tip",), found) or found.tip
    found.wrong += _doubled(file)
    return found


def _referred(
    name: str, known: dict[str, str | None], where: Location, found: References
) -> str | None:
    if name in known:
        return known[name]
    near = nearest(name, known)
    hint = f"; did you mean `{near}`?" if near else ""
    above = " above" if where[-1] == "parent" else ""
    found.wrong.append((where, f"no link{above} is called {quoted(name)}{hint}"))
    return None


def _doubled(file: RobotFile) -> list[tuple[Location, str]]:
    """Find names of links and frames that are taken."""
    wrong: list[tuple[Location, str]] = []
    taken = {BASE: "the base"} if file.base is not None else {}
    taken |= {TOOL: "the tool"} if file.tool is not None else {}
    for i, link in enumerate(file.links):
        for name, at, what in _labels(link, i):
            if name in taken:
                wrong.append((at, f"{quoted(name)} is what {taken[name]} is called"))
            taken[name] = what
    return wrong


def _labels(link: Link, i: int) -> Iterator[tuple[str, Location, str]]:
    if link.name is not None:
        yield link.name, ("links", i, "name"), f"links[{i + 1}]"
    for name in link.frames:
        yield name, ("links", i, "frames", name), f"a frame of links[{i + 1}]"
