"""Base inertial parameters: the same torques from fewer numbers.

The moments of a body form the matrix P = [[S, h], [h^T, m]]; in the frame of the parent it is
T P T^T with the homogeneous transform T. What of that does not change when the joint moves acts
exactly as if it were fixed to the parent (Gautier & Khalil 1990; Khalil & Dombre 2002, ch. 9, with
tensors of inertia in place of second moments):

- of a link that turns about z, a rod on the axis: m, h_z and S_zz. Seven numbers remain;
- of a link that slides, all of S. Four numbers remain.

The same freedom used the other way round saves more. A point mass on the axis of a child may count
to the child or to the link. Left with the outer links whose origins lie there, at the cost of m a,
masses are chosen such that the first moment h of the link vanishes, and with it U h and h x a.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

from moro.algorithms.posture import PosedLink, Posture
from moro.spatial.moments import Moments
from moro.spatial.vectors import Scalar, Vector, add, times
from moro_codegen.graph.nodes import Constant, constant_value

#: masses left with outer links stay below this multiple of the mass of the arm, for accuracy
HEAVY = 10


class FixedPoint(NamedTuple):
    """The origin of an outer link's frame, where it does not move in the frame of a link."""

    outer: int
    p: tuple[Constant, Constant, Constant]


def reduced(arm: Posture, *, balanced: bool = True, constants_only: bool = False) -> Posture:
    """Return the arm with its moments in as few numbers as possible, and the same torques.

    ``balanced``: masses are left with outer links. ``constants_only`` leaves alone what depends on
    run-time parameters: moving it costs operations in every call.
    """
    links = list(arm.links)
    children, pulled = arm.children, _pulled(arm)
    heaviest = HEAVY * sum(abs(constant_value(link.body.m) or 0) for link in links)
    accelerated: set[int] = set()  # links whose acceleration is needed in any case

    def put(i: int, extra: Moments) -> None:
        links[i] = replace(links[i], body=links[i].body + extra)

    for i in reversed(range(len(links))):
        link = links[i]
        if balanced and pulled[i]:
            points = [p for p in _fixed_points(links, children, i) if p.outer in accelerated]
            for point, mass in _balancing_masses(link.body.h, points, heaviest):
                put(point.outer, Moments(mass))
                put(i, Moments(-mass).displaced(point.p))
        fixed = _fixed_to_parent(links[i], constants_only)
        put(i, Moments(0) - fixed)
        if link.parent >= 0:
            put(link.parent, fixed.rotated(link.R).displaced(link.p))
        if _has_force(links[i].body) or not accelerated.isdisjoint(children[i]):
            accelerated.add(i)
    return replace(arm, links=tuple(links))


def _fixed_to_parent(link: PosedLink, constants_only: bool) -> Moments:
    """Return what of a body acts as if it were fixed to the parent."""

    def part(x: Scalar) -> Scalar:
        return 0 if constants_only and constant_value(x) is None else x

    if constants_only and None in map(constant_value, (*link.p, *link.R[0], *link.R[1])):
        return Moments(0)
    carried = link.type.carried_moments(link.body)
    h, x, y, z = ((part(a), part(b), part(c)) for a, b, c in (carried.h, *carried.S))
    return Moments(part(carried.m), h, (x, y, z))


def _pulled(arm: Posture) -> list[bool]:
    """Return for every link whether the force on it has a part in any torque.

    Not so where the frames of all links down to the first have their origins on its axis.
    """
    pulled: list[bool] = []
    for link in arm.links:
        if not link.type.fixes_axis or link.parent < 0:
            pulled.append(not link.type.fixes_axis)
        else:
            on_first_axis = arm.links[link.parent].parent < 0
            lever = link.p[:2] if on_first_axis else link.p
            pulled.append(pulled[link.parent] or any(constant_value(x) != 0 for x in lever))
    return pulled


def _has_force(body: Moments) -> bool:
    return any(constant_value(x) != 0 for x in (body.m, *body.h))


def _fixed_points(
    links: Sequence[PosedLink], children: Sequence[Sequence[int]], i: int
) -> Iterator[FixedPoint]:
    """Yield the origins of frames further out that lie on the axes of the children of link i."""
    for k in children[i]:
        child = links[k]
        if child.type.fixes_axis:
            yield from _constant_points(k, child.p)
            for j in children[k]:
                x, y, z = map(constant_value, links[j].p)
                if links[j].type.fixes_axis and x == y == 0 and z:
                    yield from _constant_points(j, add(child.p, times(child.R, (0, 0, z))))


def _constant_points(outer: int, p: Vector) -> Iterator[FixedPoint]:
    x, y, z = map(constant_value, p)
    if x is not None and y is not None and z is not None and (x or y):
        yield FixedPoint(outer, (x, y, z))


def _balancing_masses(
    moment: Vector, points: Sequence[FixedPoint], heaviest: Constant
) -> list[tuple[FixedPoint, Constant]]:
    """Return masses at some of the points that have x and y of a first moment, or one of them."""
    x, y = map(constant_value, moment[:2])
    if x is None or y is None or not (x or y):
        return []
    for masses in _balances(x, y, points):
        if all(abs(mass) <= heaviest for _, mass in masses):
            return masses
    return []


def _balances(
    x: Constant, y: Constant, points: Sequence[FixedPoint]
) -> Iterator[list[tuple[FixedPoint, Constant]]]:
    """Yield masses that balance (x, y): one mass, two masses, one mass that leaves x or y.

    Masses mu_a at points a balance where sum of mu_a (a_x, a_y) = (x, y): one does if a is parallel
    to (x, y), and two points that are not parallel do always, by Cramer's rule.
    """
    for point in points:
        px, py, _ = point.p
        if px * y == py * x:
            yield [(point, x / px if px else y / py)]
    for a, b in combinations(points, 2):
        (ax, ay, _), (bx, by, _) = a.p, b.p
        if ax * by != ay * bx:
            area = ax * by - ay * bx
            yield [(a, (x * by - y * bx) / area), (b, (ax * y - ay * x) / area)]
    for point in points:
        px, py, _ = point.p
        if px and x and (y or not py):
            yield [(point, x / px)]
        elif py and y and (x or not px):
            yield [(point, y / py)]
