"""Sums of products that share sums and products: common divisors of several polynomials.

A divisor is what terms have in common, in any of the polynomials:

- a sum of two that pairs of terms are multiples of: a + 2 b in 3 a x + 6 b x and in a y + 2 b y;
- a product of two factors, or of a number and a factor.

The one that saves most operations is taken out wherever it stands and is a factor like any other
from then on, and so on until none saves any: longer sums and products come about as divisors of
divisors. Brayton & McMullen 1982 (kernels of logic functions); Rajski & Vasudevamurthy 1992
(divisors of two terms suffice); Hosangadi, Fallah & Kastner 2006 (polynomials).
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias

#: a product: its factors, as increasing numbers, one of them as often as it occurs
Cube: TypeAlias = tuple[int, ...]
#: a sum of products: the coefficient of each
Polynomial: TypeAlias = Mapping[Cube, Any]

#: a divisor: ("sum", a, b, r) is a + r b, ("product", x, y) is x y, ("multiple", c, x) is c x;
#: a and b are cubes, c and r indices of coefficients
Divisor: TypeAlias = tuple[Any, ...]
#: the polynomial that it stands in, and its term or two terms there
Place: TypeAlias = tuple[Any, ...]


class Divided(NamedTuple):
    """Polynomials in fewer operations."""

    polynomials: list[dict[Cube, Any]]
    #: what the factors after the given ones are, in order
    divisors: list[dict[Cube, Any]]


def divided(polynomials: Sequence[Polynomial], factors: int) -> Divided:
    """Return polynomials in factors 0, 1, ... with what they share as further factors."""
    division = _Division(polynomials, factors)
    division.run()
    values = division.numbers.values
    found = [{cube: values[c] for cube, c in p.items()} for p in division.polynomials]
    return Divided(found[: len(polynomials)], found[len(polynomials) :])


def pairs(polynomials: Sequence[Polynomial]) -> int:
    """Return the number of pairs of terms: what the time that ``divided`` takes grows with."""
    return sum(len(p) * (len(p) - 1) // 2 for p in polynomials)


class _Numbers:
    """Coefficients, each known by its index: fractions are slow to divide and to look up."""

    def __init__(self) -> None:
        self.values: list[Any] = []
        #: of each, whether it is 1 or -1, which costs no multiplication
        self.units: list[bool] = []
        self._indices: dict[Any, int] = {}
        self._ratios: dict[tuple[int, int], int] = {}
        self.one, self.minus_one = self.index(1), self.index(-1)

    def index(self, value: Any) -> int:
        found = self._indices.get(value)
        if found is None:
            found = self._indices[value] = len(self.values)
            self.values.append(value)
            self.units.append(abs(value) == 1)
        return found

    def ratio(self, a: int, b: int) -> int:
        """Return the index of a / b."""
        found = self._ratios.get((a, b))
        if found is None:
            found = self._ratios[a, b] = self.index(self.values[a] / self.values[b])
        return found

    def parts(self, c: int) -> tuple[int, int]:
        """Return the indices of the sign and the size of a coefficient."""
        value = self.values[c]
        return (self.minus_one if value < 0 else self.one), self.index(abs(value))


class _Candidate:
    """A divisor that may be taken out."""

    __slots__ = ("cost", "gain", "order", "places")

    def __init__(self, cost: int, order: int) -> None:
        #: operations that it takes itself
        self.cost = cost
        #: when it was first seen: of those that save the same, the first is taken
        self.order = order
        #: operations that it saves, in all and at each place
        self.gain = 0
        self.places: dict[Place, int] = {}


class _Division:
    def __init__(self, polynomials: Sequence[Polynomial], factors: int) -> None:
        self.numbers = _Numbers()
        self.polynomials: list[dict[Cube, int]] = []
        #: of each, the terms that may have a sum in common with others
        self._paired: list[dict[Cube, int]] = []
        #: the divisors of each term, with their places
        self._standing: dict[Place, list[tuple[Divisor, Place]]] = {}
        self._next = factors
        self._candidates: dict[Divisor, _Candidate] = {}
        self._changed: dict[Divisor, None] = {}
        self._queue: list[tuple[int, int, Divisor]] = []
        self._splits: dict[tuple[Cube, Cube], tuple[Cube, Cube, Cube]] = {}
        cubes = (cube for polynomial in polynomials for cube in polynomial)
        terms = Counter(x for cube in cubes for x in dict.fromkeys(cube))
        #: factors of a single term: no divisor has them
        self._alone = {x for x, count in terms.items() if count == 1}
        for polynomial in polynomials:
            self._add({cube: self.numbers.index(c) for cube, c in polynomial.items()})

    def run(self) -> None:
        """Take out divisors until none saves anything."""
        self._enqueue()
        while self._queue:
            negative, order, divisor = heapq.heappop(self._queue)
            candidate = self._candidates[divisor]
            places = _apart(candidate.places)
            saved = sum(candidate.places[x] for x in places) - candidate.cost
            if saved <= 0 or saved > -negative or len(places) < 2:
                continue  # if it saves more by now, it is in the queue with that
            if saved < -negative and self._queue and saved < -self._queue[0][0]:
                heapq.heappush(self._queue, (-saved, order, divisor))
                continue
            self._take_out(divisor, places)
            self._enqueue()

    def _enqueue(self) -> None:
        for divisor in self._changed:
            candidate = self._candidates[divisor]
            saved = candidate.gain - candidate.cost
            if saved > 0 and len(candidate.places) > 1:
                heapq.heappush(self._queue, (-saved, candidate.order, divisor))
        self._changed.clear()

    def _take_out(self, divisor: Divisor, places: Sequence[Place]) -> None:
        kind, *what = divisor
        numbers, new = self.numbers, self._next
        self._next += 1
        for k, *cubes in places:
            coefficients = [self._remove(k, cube) for cube in cubes]
            c = coefficients[0]
            if kind == "sum":
                cube: Sequence[int] = self._split(*cubes)[0]
            elif kind == "product":
                cube = _without(cubes[0], *what)
            else:
                c, _ = numbers.parts(c)
                cube = _without(cubes[0], what[1])
            self._insert(k, (*cube, new), c)
        if kind == "sum":
            self._add({what[0]: numbers.one, what[1]: what[2]})
        elif kind == "product":
            self._add({(what[0], what[1]): numbers.one})
        else:
            self._add({(what[1],): what[0]})

    # -- polynomials, and where divisors stand in them --------------------------------------------

    def _add(self, polynomial: Mapping[Cube, int]) -> None:
        self.polynomials.append({})
        self._paired.append({})
        for cube, c in polynomial.items():
            self._insert(len(self.polynomials) - 1, cube, c)

    def _insert(self, k: int, cube: Cube, c: int) -> None:
        if cube in self.polynomials[k]:
            values = self.numbers.values
            total = values[self._remove(k, cube)] + values[c]
            if total == 0:
                return
            c = self.numbers.index(total)
        place = k, cube
        self._standing[place] = []
        factors: Sequence[int] = cube
        if self._alone.isdisjoint(cube):
            for other, d in self._paired[k].items():
                self._put_common_sum(k, (cube, c), (other, d))
            self._paired[k][cube] = c
        else:
            factors = [x for x in cube if x not in self._alone]
        for pair in dict.fromkeys(combinations(factors, 2)):
            self._put(("product", *pair), 1, place, 1, place)
        if not self.numbers.units[c]:
            size = self.numbers.parts(c)[1]
            for x in dict.fromkeys(factors):
                self._put(("multiple", size, x), 1, place, 1, place)
        self.polynomials[k][cube] = c

    def _put_common_sum(self, k: int, term: tuple[Cube, int], other: tuple[Cube, int]) -> None:
        """Put the sum that two terms are a multiple of where it stands."""
        common, a, b = self._split(term[0], other[0])
        if b < a:
            term, other, a, b = other, term, b, a
        (first, c), (second, d) = term, other
        ratio, units = self.numbers.ratio(d, c), self.numbers.units
        cost = (len(a) - 1 if a else 0) + (len(b) - units[ratio] if b else 0) + 1
        before = (len(first) - units[c] if first else 0) + (len(second) - units[d] if second else 0)
        saved = before + 1 - len(common) - (not units[c])
        self._put(("sum", a, b, ratio), cost, (k, first, second), saved, (k, first), (k, second))

    def _put(self, divisor: Divisor, cost: int, place: Place, gain: int, *terms: Place) -> None:
        """Put a divisor where it stands in one or two terms, so that it is known with each."""
        candidate = self._candidates.get(divisor)
        if candidate is None:
            candidate = self._candidates[divisor] = _Candidate(cost, len(self._candidates))
        candidate.places[place] = gain
        candidate.gain += gain
        self._changed[divisor] = None
        for term in terms:
            self._standing[term].append((divisor, place))

    def _remove(self, k: int, cube: Cube) -> int:
        self._paired[k].pop(cube, None)
        for divisor, place in self._standing.pop((k, cube)):
            candidate = self._candidates[divisor]
            gain = candidate.places.pop(place, None)
            if gain is not None:  # it did not go with the other term
                candidate.gain -= gain
                self._changed[divisor] = None
        return self.polynomials[k].pop(cube)

    def _split(self, a: Cube, b: Cube) -> tuple[Cube, Cube, Cube]:
        """Return the factors that two terms have in common, and the rest of each, which differ."""
        found = self._splits.get((a, b))
        if found is None:
            common, rest = [], list(b)
            first = []
            for x in a:
                if x in rest:
                    rest.remove(x)
                    common.append(x)
                else:
                    first.append(x)
            found = self._splits[a, b] = tuple(common), tuple(first), tuple(rest)
        return found


def _apart(places: Mapping[Place, int]) -> list[Place]:
    """Return places of which no two have a term in common, the first ones."""
    used = set[tuple[int, Cube]]()
    chosen = []
    for place in sorted(places):
        terms = {(place[0], cube) for cube in place[1:]}
        if used.isdisjoint(terms):
            used |= terms
            chosen.append(place)
    return chosen


def _without(cube: Cube, *factors: int) -> list[int]:
    rest = list(cube)
    for x in factors:
        rest.remove(x)
    return rest
