"""Links in order, parents first; and what keeps links from being a tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from moro.checks.values import suggestion
from moro.formats.assembly.links import Link


def by_name(links: Iterable[Link]) -> dict[str, Link]:
    """Return links by their names; ValueError for two of one name."""
    found: dict[str, Link] = {}
    for link in links:
        if link.name in found:
            raise ValueError(f"two links are called {link.name}")
        found[link.name] = link
    return found


def children(links: Iterable[Link]) -> dict[str | None, list[Link]]:
    """Return the links on each link, in the order given; those of None stand in the world."""
    found: dict[str | None, list[Link]] = {}
    for link in links:
        found.setdefault(link.parent, []).append(link)
    return found


def parents_first(links: Sequence[Link]) -> list[Link]:
    """Return links in the order given, where parents come first in it, or else ``depth_first``.

    ValueError for what that refuses.
    """
    found, place = depth_first(links), {link.name: i for i, link in enumerate(links)}
    given = all(x.parent is None or place[x.parent] < i for i, x in enumerate(links))
    return [*links] if given else found


def depth_first(links: Sequence[Link]) -> list[Link]:
    """Return links, each followed by what it carries, what it carries in the order given.

    ValueError for two links of one name, for a parent that is none of the links, and for links that
    carry each other.
    """
    there = by_name(links)
    for link in links:
        if link.parent is not None and link.parent not in there:
            raise ValueError(
                f"link {link.name} is on {link.parent}, which is no link"
                f"{suggestion(link.parent, there)}"
            )
    on = children(links)
    found: list[Link] = []
    waiting = [*reversed(on.get(None, []))]
    while waiting:
        link = waiting.pop()
        found.append(link)
        waiting += reversed(on.get(link.name, []))
    if len(found) < len(links):
        lost = set(there) - {link.name for link in found}
        circle = next(name for name in there if name in lost)
        seen: dict[str, None] = {}
        while circle not in seen:
            seen[circle] = None
            circle = str(there[circle].parent)
        ring = [*seen][[*seen].index(circle) :]
        raise ValueError(f"links carry each other in a circle: {', '.join(ring)}")
    return found


def way(links: Mapping[str, Link], name: str) -> Iterator[Link]:
    """Yield a link and those that carry it."""
    at: str | None = name
    while at is not None:
        yield links[at]
        at = links[at].parent


def known(name: Any, names: Iterable[str], what: str, among: str) -> str:
    """Return a name that is among ``names``; ValueError says which is near, and what there is."""
    names = [*names]
    if not isinstance(name, str):
        raise TypeError(f"{what} must be a name, not {name!r}")
    if name not in names:
        shown = ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")
        raise ValueError(
            f"{what}: {among} is called {name}{suggestion(name, names)} (there are"
            f" {shown or 'none'})"
        )
    return name


_SHOWN = 40
