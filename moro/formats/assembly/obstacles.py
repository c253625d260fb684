"""What a file says of a robot that joints do not: loops, what flies freely, springs on tendons."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from moro.formats.errors import Problem


@dataclass(frozen=True)
class Obstacle:
    """What keeps some links from being described together.

    It is none for a part of the robot without one of these links, nor where none of the
    ``coordinates``, if any are named, moves anything.
    """

    problem: Problem
    links: tuple[str, ...] = ()
    coordinates: tuple[str, ...] = ()

    def is_in(self, links: Collection[str], coordinates: Collection[str]) -> bool:
        """Whether it is one for a robot of such links and such coordinates that move something."""
        if not all(link in links for link in self.links):
            return False
        return not self.coordinates or any(q in coordinates for q in self.coordinates)
