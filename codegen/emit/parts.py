"""Long routines in parts: the time that compilers take for a function grows with its square.

What one part computes and a later one reads is handed on in an array, as the compiler would have
done with it anyway: a long routine has far more values than a processor has registers.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from moro_codegen.emit.statements import (
    Assign,
    Call,
    Load,
    ReduceAngles,
    RoutineBody,
    Sines,
    Statement,
)

#: statements of a part
LENGTH = 500

_NAME = re.compile(r"\b[A-Za-z_]\w*")


@dataclass(frozen=True)
class Take:
    """``name`` is what an earlier part kept in a place of the array."""

    name: str
    place: int


@dataclass(frozen=True)
class Keep:
    """Put ``name`` into a place of the array for later parts."""

    name: str
    place: int


Step = Statement | Take | Keep


@dataclass(frozen=True)
class Parts:
    """The steps of each part; the results are those of the last one. ``room``: places needed."""

    steps: tuple[tuple[Step, ...], ...]
    room: int


def in_parts(body: RoutineBody, length: int = LENGTH) -> Parts:
    """Return the statements of a routine, divided if there are many."""
    loads = {s.name: s for s in body.statements if isinstance(s, Load)}
    work = [s for s in body.statements if not isinstance(s, Load)]
    count = round(len(work) / length)
    if count <= 1:
        return Parts((body.statements,), 0)
    ends = [len(work) * k // count for k in range(count + 1)]
    parts = [work[start:end] for start, end in itertools.pairwise(ends)]
    return _Division(loads, parts, body.results).divide()


@dataclass
class _Division:
    loads: dict[str, Load]
    parts: Sequence[Sequence[Statement]]
    results: Sequence[str]

    def divide(self) -> Parts:
        """Add to each part the loads that it needs, and what it takes and keeps."""
        self.home = {
            name: k for k, part in enumerate(self.parts) for s in part for name in _defined(s)
        }
        self.last = self._last_uses()
        self.places: dict[str, int] = {}
        self.room = 0
        steps = tuple(tuple(self._steps(k)) for k in range(len(self.parts)))
        return Parts(steps, self.room)

    def _last_uses(self) -> dict[str, int]:
        """Return for every name the last part that reads it."""
        last = {}
        for k, part in enumerate(self.parts):
            for statement in part:
                last.update(dict.fromkeys(_used(statement), k))
        for result in self.results:
            last.update(dict.fromkeys(_NAME.findall(result), len(self.parts) - 1))
        return last

    def _steps(self, k: int) -> Iterator[Step]:
        """Yield the steps of part k."""
        occupied = {place for name, place in self.places.items() if self.last[name] >= k}
        free = [place for place in range(self.room) if place not in occupied]
        known: set[str] = set()
        for statement in self.parts[k]:
            yield from self._brought(_used(statement), k, known)
            yield statement
            for name in _defined(statement):
                if self.last.get(name, k) > k:
                    if not free:
                        free, self.room = [self.room], self.room + 1
                    self.places[name] = free.pop()
                    yield Keep(name, self.places[name])
        if k == len(self.parts) - 1:
            for result in self.results:
                yield from self._brought(_NAME.findall(result), k, known)

    def _brought(self, names: Sequence[str], k: int, known: set[str]) -> Iterator[Step]:
        """Yield what makes names known in part k that come from elsewhere."""
        for name in names:
            if name not in known:
                known.add(name)
                if name in self.loads:
                    yield self.loads[name]
                elif self.home.get(name, k) < k:
                    yield Take(name, self.places[name])


def _used(statement: Statement) -> list[str]:
    match statement:
        case Assign(_, expression):
            return _NAME.findall(expression)
        case Call(_, _, arguments):
            return _NAME.findall(" ".join(arguments))
        case Sines(angles, _, _) | ReduceAngles(_, angles, _):
            return _NAME.findall(" ".join(angles))
    return []


def _defined(statement: Statement) -> list[str]:
    match statement:
        case Assign(name) | Call(name):
            return [name]
        case ReduceAngles(names, _, _):
            return list(names)
        case Sines(_, pairs, _):
            return [name for pair in pairs for name in pair if name]
    return []
