"""Statements in an order in which few values wait, and long routines in parts.

A routine has more values than a processor has registers: the fewer wait to be read, the fewer go to
memory and back. Long routines are divided, because the time that compilers take for a function
grows with its square, and what they make of one of a thousand statements is a third slower. What
one part computes and a later one reads is handed on in an array, as the compiler would have done
with it anyway; that array is most of the memory that a call takes.
"""

from __future__ import annotations

import heapq
import itertools
import re
from collections import Counter, defaultdict
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

#: statements of a part, of which compilers make the best code, and the fewest parts that are worth
#: the array
LENGTH, LEAST = 80, 5

#: angles that are reduced, or whose sines are computed, at once: a multiple of those side by side
ANGLES = 16

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


@dataclass(frozen=True)
class Give:
    """``name`` is result ``index``."""

    name: str
    index: int


Step = Statement | Take | Keep | Give


@dataclass(frozen=True)
class Parts:
    """The steps of each part. ``room``: places needed, in the first of which inputs may lie.

    Results that are inputs or constants are given by no step; if there is one part only, none is.
    """

    steps: tuple[tuple[Step, ...], ...]
    room: int


def in_parts(body: RoutineBody, inputs: Sequence[tuple[str, int]], length: int = LENGTH) -> Parts:
    """Return the statements of a routine in order, divided if there are many.

    ``inputs`` are the names and sizes of the arguments. An array that holds their components one
    after the other may serve as that of the places: each is used anew only when nothing reads the
    component any more.
    """
    loads = [s for s in body.statements if isinstance(s, Load)]
    work = [s for s in body.statements if not isinstance(s, Load)]
    count = round(len(work) / length)
    if count < LEAST:
        return Parts(((*loads, *ordered(work, body.results)),), 0)
    pieces = ordered([s for statement in work for s in _split(statement, body)], body.results)
    ends = [len(pieces) * k // count for k in range(count + 1)]
    parts = [pieces[start:end] for start, end in itertools.pairwise(ends)]
    return _Division(loads, parts, body.results, inputs).divide()


def ordered(work: Sequence[Statement], results: Sequence[str]) -> list[Statement]:
    """Return statements in an order in which few of their values wait for the last that reads them.

    The next one is always that which ends the waiting of the most values, less those it begins; of
    several, the first. Results do not wait: they are given at once.
    """
    uses = [set(_used(s)) for s in work]
    readers: dict[str, set[int]] = defaultdict(set)
    for k, names in enumerate(uses):
        for name in names:
            readers[name].add(k)
    given = {name for text in results for name in _NAME.findall(text)}
    home = {name: k for k, s in enumerate(work) for name in _defined(s)}
    missing = [len({home[name] for name in names if name in home}) for names in uses]
    gain = [-sum(name in readers for name in _defined(s) if name not in given) for s in work]
    for name, at in readers.items():
        if len(at) == 1 and name not in given:
            gain[next(iter(at))] += 1
    ready = [(-gain[k], k) for k in range(len(work)) if not missing[k]]
    heapq.heapify(ready)
    order: list[Statement] = []
    done = [False] * len(work)
    while ready:
        cost, k = heapq.heappop(ready)
        if done[k] or cost != -gain[k]:
            continue  # it was put in again with its gain of now
        done[k] = True
        order.append(work[k])
        for name in uses[k]:
            readers[name].discard(k)
            if len(readers[name]) == 1 and name not in given:
                (last,) = readers[name]
                gain[last] += 1
                if not missing[last]:
                    heapq.heappush(ready, (-gain[last], last))
        for j in set().union(*(readers[name] for name in _defined(work[k]) if name in readers)):
            missing[j] -= 1
            if not missing[j]:
                heapq.heappush(ready, (-gain[j], j))
    return order


def _split(statement: Statement, body: RoutineBody) -> Iterator[Statement]:
    """Yield a statement in pieces that take few angles each."""
    match statement:
        case Sines(angles, pairs, arrays) if len(angles) > ANGLES:
            for k in range(0, len(angles), ANGLES):
                angle, sine, cosine = map(body.names.take, arrays)
                piece = angles[k : k + ANGLES], pairs[k : k + ANGLES]
                yield Sines(*piece, (angle, sine, cosine))
        case ReduceAngles(names, angles, array) if len(angles) > ANGLES:
            for k in range(0, len(angles), ANGLES):
                own_array = body.names.take(array)
                yield ReduceAngles(names[k : k + ANGLES], angles[k : k + ANGLES], own_array)
        case _:
            yield statement


@dataclass
class _Division:
    loads: Sequence[Load]
    parts: Sequence[Sequence[Statement]]
    results: Sequence[str]
    inputs: Sequence[tuple[str, int]]

    def divide(self) -> Parts:
        """Add to each part what it loads, takes, keeps and gives."""
        self.loaded = {s.name: s for s in self.loads}
        self.home = {
            name: k for k, part in enumerate(self.parts) for s in part for name in _defined(s)
        }
        self.given: dict[str, list[int]] = defaultdict(list)
        for index, text in enumerate(self.results):
            if text in self.home:
                self.given[text].append(index)
        self.left = self._readings()
        self.last = {
            name: k for k, part in enumerate(self.parts) for s in part for name in _used(s)
        }
        self.places = self._places_of_inputs()
        self.room = sum(size for _, size in self.inputs)
        self.free = sorted(set(range(self.room)) - set(self.places.values()), reverse=True)
        steps = tuple(tuple(self._steps(k)) for k in range(len(self.parts)))
        return Parts(steps, self.room)

    def _readings(self) -> Counter[str]:
        """Count the statements that read a name; those that the results are end the last part."""
        readings = Counter(name for part in self.parts for s in part for name in set(_used(s)))
        others = (text for text in self.results if text not in self.home)
        readings.update(name for text in others for name in _NAME.findall(text))
        return readings

    def _places_of_inputs(self) -> dict[str, int]:
        """Return where the components that are read lie at first."""
        first = dict(
            zip(
                (name for name, _ in self.inputs),
                itertools.accumulate((size for _, size in self.inputs), initial=0),
                strict=False,
            )
        )
        return {s.name: first[s.argument] + s.index for s in self.loads if s.name in self.left}

    def _steps(self, k: int) -> Iterator[Step]:
        """Yield the steps of part k."""
        known: set[str] = set()
        for statement in self.parts[k]:
            used = list(dict.fromkeys(_used(statement)))
            yield from self._brought(used, k, known)
            yield statement
            for name in used:
                self._read(name)
            for name in _defined(statement):
                if self.last.get(name, k) > k:
                    yield Keep(name, self._place(name))
                for index in self.given.get(name, ()):
                    yield Give(name, index)
        if k == len(self.parts) - 1:
            for text in self.results:
                if text not in self.home:
                    yield from self._brought(_NAME.findall(text), k, known)

    def _place(self, name: str) -> int:
        """Return a place for a value, one that is free or a new one."""
        if not self.free:
            self.free.append(self.room)
            self.room += 1
        self.places[name] = self.free.pop()
        return self.places[name]

    def _read(self, name: str) -> None:
        """Free the place of a value that nothing reads any more."""
        self.left[name] -= 1
        if not self.left[name] and name in self.places:
            self.free.append(self.places[name])

    def _brought(self, names: Sequence[str], k: int, known: set[str]) -> Iterator[Step]:
        """Yield what makes names known in part k that come from elsewhere."""
        for name in names:
            if name not in known:
                known.add(name)
                if name in self.loaded:
                    yield self.loaded[name]
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
