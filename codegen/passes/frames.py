"""Frames of few operations: the same arm at the same instant, described with more zeros and ones.

The torques depend neither on the frames chosen in the links, as long as the axis of a joint is its
frame's z axis, nor on the unit of length. What is chosen here:

- where on its axis a frame has its origin: on the common normal with the axis of its parent;
- which way its x axis points: along the common normal with the axis that comes next, so that it is
  turned by Rx alone, as in DH parameters; the rest is added to the joints' angles;
- the unit of length: the commonest distance between frames becomes 1;
- how a frame is turned about its axis. At an instant, one may fix a frame in the link that has the
  axes of the parent's frame, whatever the joint's angle is. Then no vector needs turning between
  the two; instead the moments of the body, and the positions of its children, are turned once. This
  pays for last links (if the body is symmetric about the axis, nothing is left to turn), and for
  parallel axes near the base: what is turned by q2 and then by q3 is turned by q2 + q3 at once.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from itertools import chain

from moro.algorithms.posture import PosedLink, Posture
from moro.spatial.angles import rational_sincos
from moro.spatial.moments import Moments
from moro.spatial.transform import about_z
from moro.spatial.vectors import Matrix, Scalar, Vector, add, product, scaled, transpose
from moro_codegen.graph.nodes import Constant, constant_value

#: below this sine squared of the angle between two axes, their common normal is too far away
NEARLY_PARALLEL = 1e-3
#: so many frames that are not on common normals are tried one by one
FEW = 4
#: angles below this are rounding [rad]
_NOTHING = 1e-15


def along_common_normals(arm: Posture) -> Posture:
    """Return the arm with frames of which the next is placed by Rx alone, or else by Rz Rx.

    R = Rz(a) Rx(b) Rz(c) of a link that turns: c is added to its own angle, and a to that of the
    link that it hangs on, if that turns too and no child before asked for something else. Quarter
    turns, which cost nothing, stay where they are, and so does what holds parameters.
    """
    links, shifts = list(arm.links), [0.0] * len(arm.links)
    for i, children in enumerate(arm.children):
        asking = next((k for k in children if _asks(links[k])), None)
        if asking is not None and _may_turn(links[i], [links[k] for k in children]):
            a, b, c = _turns(links[asking].R)
            quarter = _quarters(a) * (math.pi / 2)
            shifts[i] = a - quarter
            sin, cos = rational_sincos(-shifts[i])
            links[i] = replace(links[i], body=_turned(links[i].body, sin, cos))
            for k in children:
                R = product(_about_z(sin, cos), links[k].R)
                links[k] = replace(links[k], R=R, p=_turned_vector(links[k].p, sin, cos))
            links[asking] = replace(links[asking], R=_rotation(quarter, b, c))
    for i, link in enumerate(links):
        if _may_shift(link) and (shift := _rest((turns := _turns(link.R))[2])):
            links[i] = replace(link, R=_rotation(*turns[:2], turns[2] - shift))
            shifts[i] += shift
        if shifts[i]:
            links[i] = _shifted(links[i], shifts[i])
    return replace(arm, links=tuple(links))


def _asks(link: PosedLink) -> bool:
    """Return whether the frame that a link hangs on had better be turned about its axis."""
    return _is_constant(*link.R) and _rest(_turns(link.R)[0]) != 0


def _may_turn(link: PosedLink, children: Iterable[PosedLink]) -> bool:
    """Return whether a frame can be turned about its axis: if that costs nothing at run time."""
    carried = (x for child in children for x in (*child.R, child.p))
    return _may_shift(link) and _is_constant(link.body.h, *link.body.S, *carried)


def _may_shift(link: PosedLink) -> bool:
    return link.type.fixes_axis and constant_value(link.position) is None and _is_constant(*link.R)


def _is_constant(*vectors: Iterable[Scalar]) -> bool:
    return None not in map(constant_value, chain.from_iterable(vectors))


def _turns(R: Matrix) -> tuple[float, float, float]:
    """Return a, b and c of R = Rz(a) Rx(b) Rz(c); a is 0 if b is 0 or half a turn."""
    rows = [[float(constant_value(x) or 0) for x in row] for row in R]
    x, y, z = (row[2] for row in rows)
    sine = math.hypot(x, y)
    a = math.atan2(x, -y) if sine > _NOTHING else 0.0
    u, v = (math.cos(a) * rows[0][k] + math.sin(a) * rows[1][k] for k in (0, 1))
    return a, math.atan2(sine, z), math.atan2(-v, u)


def _rotation(a: float, b: float, c: float) -> Matrix:
    """Return Rz(a) Rx(b) Rz(c)."""
    (sa, ca), (sb, cb), (sc, cc) = map(_sincos, (a, b, c))
    tilt: Matrix = (1, 0, 0), (0, cb, -sb), (0, sb, cb)
    return product(_about_z(sa, ca), product(tilt, _about_z(sc, cc)))


def _sincos(angle: float) -> tuple[Scalar, Scalar]:
    """Return sine and cosine in fractions, those of quarter turns exactly."""
    s, c = rational_sincos(_rest(angle))
    for _ in range(_quarters(angle) % 4):
        s, c = c, -s
    return s, c


def _quarters(angle: float) -> int:
    return round(angle / (math.pi / 2))


def _rest(angle: float) -> float:
    """Return an angle less the quarter turns in it, 0 where nothing but rounding is left."""
    rest = angle - _quarters(angle) * (math.pi / 2)
    return rest if abs(rest) > _NOTHING else 0.0


def _about_z(sin: Scalar, cos: Scalar) -> Matrix:
    return (cos, -sin, 0), (sin, cos, 0), (0, 0, 1)


def _shifted(link: PosedLink, by: float) -> PosedLink:
    """Return a link that turns by so much more."""
    graph, known = link.position.graph, link.position
    if known.op == "add" and (constants := [x for x in known.args if x.op == "const"]):
        known = next(x for x in known.args if x.op != "const")
        by += float(constants[0].value)
    angle = known + by if abs(by) > _NOTHING else known
    return replace(link, position=angle, sin=graph.sin(angle), cos=graph.cos(angle))


def common_normals(arm: Posture) -> Iterator[Posture]:
    """Yield the arm with frames on common normals: those that constants lead to, then all.

    Where only a few are not there as they are given, also with each of these as it is given, and
    with all of them: that may have the lengths that are 0 or 1.
    """
    moved = on_common_normals(arm)
    yield moved
    if has_parameters(arm):
        if (further := on_common_normals(arm, parameters=True)) != moved:
            yield further
        return
    pairs = zip(arm.links, moved.links, strict=True)
    changed = [i for i, (link, other) in enumerate(pairs) if link.p != other.p]
    if 0 < len(changed) <= FEW:
        stay = [{i} for i in changed] if len(changed) > 1 else []
        for still in (*stay, set(changed)):
            if (other := on_common_normals(arm, still=still)) != moved:
                yield other


def on_common_normals(
    arm: Posture, parameters: bool = False, still: Collection[int] = ()
) -> Posture:
    """Return the arm with every frame's origin on the common normal with its parent's axis.

    Where the way there is a run-time parameter, a frame is moved only if ``parameters`` allow it.
    The frames of links that are ``still`` stay where they are.
    """
    links = list(arm.links)
    for i, children in enumerate(arm.children):
        link = links[i]
        if not link.type.fixes_axis or link.parent < 0 or i in still:
            continue
        shift = _to_common_normal(link, parameters)
        if constant_value(shift) != 0:
            p = add(link.p, scaled(shift, transpose(link.R)[2]))
            links[i] = replace(link, p=p, body=link.body.displaced((0, 0, -shift)))
            for k in children:
                links[k] = replace(links[k], p=add(links[k].p, (0, 0, -shift)))
    return replace(arm, links=tuple(links))


def _to_common_normal(link: PosedLink, parameters: bool) -> Scalar:
    """Return how far along its axis a frame is from the common normal with its parent's axis.

    Where the axes are parallel, from the point nearest to the origin of the parent's frame; 0 where
    run-time parameters say where the axis is, and where they say how far the way is, unless
    ``parameters`` is set.
    """
    px, py, pz = link.p
    x, y, z = map(constant_value, transpose(link.R)[2])
    if None in (x, y, z) or (None in map(constant_value, link.p) and not parameters):
        return 0
    sine = x * x + y * y
    if sine > NEARLY_PARALLEL:
        return -(px * x + py * y) / sine
    return -(px * x + py * y + pz * z)


def in_unit(arm: Posture, turned: Collection[int]) -> Posture:
    """Return the arm with lengths in a unit that makes as many of them 1 as possible.

    Torques keep their unit: m is in units of S / length^2. Only for arms of revolute joints without
    run-time parameters, where scaling costs nothing.
    """
    if has_parameters(arm) or not all(link.type.fixes_axis for link in arm.links):
        return arm
    worth: Counter[Constant] = Counter()
    for link in arm.links:
        if link.parent >= 0:
            # products with the components of p: with U and with the force, or p's own turning
            cheap = link.parent in turned or arm.links[link.parent].parent < 0
            for x in filter(None, map(constant_value, link.p)):
                worth[abs(x)] += 2 if cheap else 5
    if not worth:
        return arm
    unit = max(worth, key=worth.__getitem__)
    links = []
    for link in arm.links:
        m, h, S = link.body.m, link.body.h, link.body.S
        body = Moments(unit * unit * m, scaled(unit, h), S)
        links.append(replace(link, p=scaled(1 / unit, link.p), body=body))
    return replace(arm, links=tuple(links), gravity=scaled(1 / unit, arm.gravity))


def turnable_leaves(arm: Posture) -> frozenset[int]:
    """Return the last links that turn."""
    return frozenset(
        i
        for i, (link, children) in enumerate(zip(arm.links, arm.children, strict=True))
        if link.type.fixes_axis and link.parent >= 0 and not children
    )


def turnable_parallels(arm: Posture) -> frozenset[int]:
    """Return the links that follow the first on parallel axes, all but the last of each row.

    In the axes of the first link, their angular velocities have only two components.
    """
    found: set[int] = set()
    for i, (link, children) in enumerate(zip(arm.links, arm.children, strict=True)):
        near = link.parent in found or (link.parent >= 0 and arm.links[link.parent].parent < 0)
        if near and link.type.fixes_axis and children:
            outer = [arm.links[k] for k in children]
            if all(k.type.fixes_axis and _parallel_sense(k) for k in outer):
                found.add(i)
    return frozenset(found)


def _parallel_sense(link: PosedLink) -> int:
    """Return 1 if the link's axis is parallel to its parent's, -1 if antiparallel, else 0."""
    x, y, z = map(constant_value, transpose(link.R)[2])
    return int(z) if x == y == 0 and z is not None else 0


def unturned(arm: Posture, turned: Collection[int]) -> Posture:
    """Return the arm with the frames of some revolute links turned against their joints' angles.

    Their children, if any, turn about parallel axes. Of links 1 and 2 on parallel axes, 1 unturned:

        parent -- Rz(q1) --> link 1 -- p --> Rz(q2) --> link 2        what is given
        parent -----------> link 1'-- Rz(q1) p --> Rz(q1 + q2) --> link 2

    Vectors go from parent to 1' as they are; the body of 1 and p are turned once, by q1.
    """
    links = list(arm.links)
    for i, children in enumerate(arm.children):
        if i in turned:
            link = links[i]
            sin, cos = link.sin, link.cos
            links[i] = replace(link, sin=0, cos=1, body=_turned(link.body, sin, cos))
            for k in children:
                child = links[k]
                angle = child.position + _parallel_sense(child) * link.position
                p = _turned_vector(child.p, sin, cos)
                pair = angle.graph.sin(angle), angle.graph.cos(angle)
                links[k] = replace(child, p=p, position=angle, sin=pair[0], cos=pair[1])
    return replace(arm, links=tuple(links))


def _turned(body: Moments, sin: Scalar, cos: Scalar) -> Moments:
    """Return the moments after turning the body about z."""
    return Moments(body.m, _turned_vector(body.h, sin, cos), about_z(body.S, sin, cos))


def _turned_vector(v: Vector, sin: Scalar, cos: Scalar) -> Vector:
    x, y, z = v
    return cos * x - sin * y, sin * x + cos * y, z


def has_parameters(arm: Posture) -> bool:
    """Return whether run-time parameters are among the lengths, angles, bodies and gravity."""
    for link in arm.links:
        fixed = (*link.R[0], *link.R[1], *link.R[2], *(link.p if link.type.fixes_axis else ()))
        body = (link.body.m, *link.body.h, *link.body.S[0], *link.body.S[1], *link.body.S[2])
        if None in map(constant_value, (*fixed, *body)):
            return True
    return None in map(constant_value, arm.gravity)
