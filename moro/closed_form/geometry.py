"""The geometry of a model over any ring: frames, joint axes, Jacobians, velocities.

On the way from the base to a link there are elementary motions: shifts, turns about z, turns about
x. Joints with parallel axes have no turn about x between them (or half a turn), so their turns
about z simply add up: such a stretch of the way is a *segment*. Its frame is the orientation before
its first joint turns; in it the links of the stretch are described by the sums of their angles, q2
and q2 + q3. This is what keeps closed forms short. On a tree, segments branch like the joints.

The scalars come from a ring: ``TrigRing`` for closed forms, ``DualRing`` for numbers and their
derivatives. Joints and links are counted from 0; -1 is the base.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import sympy as sp

from moro.model import Frame, Joint, Model, Rotation, Shift, Turn
from moro.scalars.ring import Ring
from moro.spatial.motion import Velocity
from moro.spatial.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    cross,
    difference_of,
    dot,
    product,
    scaled,
    times,
    transpose,
)

#: (rotation, position) of a frame
Pose: TypeAlias = "tuple[Matrix, Vector]"

_ZERO = sp.Integer(0)


@dataclass(frozen=True)
class _Orientation:
    """Rz(angle) Rx(tilt) R; ``R`` is there for what is no turn about x."""

    angle: Any = _ZERO
    tilt: Any = _ZERO
    R: Matrix | None = None


@dataclass(frozen=True)
class _Segment:
    """A stretch of parallel joints: how its frame is turned in that of the segment before."""

    before: int
    entry: _Orientation


@dataclass(frozen=True)
class _Step:
    """A shift by ``p`` in axes that are turned by ``turned`` in those of a segment."""

    segment: int
    turned: _Orientation
    p: Vector


@dataclass(frozen=True)
class _Axis:
    """Joint k moves: about or along ``sign`` times the z axis of its segment."""

    segment: int
    joint: int
    sign: int


@dataclass(frozen=True)
class _Place:
    """How a frame is turned in a segment: Rz(angle), and half a turn about x if ``flipped``."""

    segment: int = 0
    angle: Any = _ZERO
    flipped: bool = False

    @property
    def sign(self) -> int:
        """1 if the frame's z axis is that of the segment, else -1."""
        return -1 if self.flipped else 1

    @property
    def turned(self) -> _Orientation:
        return _Orientation(self.angle, sp.pi if self.flipped else _ZERO)


class Geometry:
    """The geometry of a model over the scalars of ``ring``."""

    def __init__(self, model: Model, ring: Ring):
        self.model = model
        self.ring = ring
        walk = _Walk(model)
        self._places, self._ways, self._segments = walk.places, walk.ways, walk.segments
        #: what ``DifferentialRing.declare_angles`` takes, by segment
        self.angles = walk.angles, walk.groups

    # -- in frame 0 -------------------------------------------------------------------------------

    def pose(self, frame: Frame) -> Pose:
        """Return rotation and position of a frame in frame 0."""
        R, p = self._in_segment(frame)
        Q = self._segment_rotations[self._home(frame.link).segment]
        return product(Q, R), add(self.origin(frame.link), times(Q, p))

    def relative(self, frame: Frame, reference: Frame) -> Pose:
        """Return rotation and position of a frame in another, by way of the last common link."""
        common = self._last_common(frame.link, reference.link)
        (A, a), (B, b) = (self._from(common, x) for x in (frame, reference))
        inverse = transpose(B)
        return product(inverse, A), times(inverse, difference_of(a, b))

    def origin(self, i: int) -> Vector:
        """Return the position of a link's frame in frame 0."""
        return self._positions[0][i] if i >= 0 else self._nowhere

    @property
    def anchors(self) -> list[Vector]:
        """A point on each joint's axis, in frame 0."""
        return self._positions[1]

    @cached_property
    def axes(self) -> list[Vector]:
        """Direction of each joint's axis in frame 0."""
        found = []
        for axis in self._axes:
            z = transpose(self._segment_rotations[axis.segment])[2]
            found.append((z[0] * axis.sign, z[1] * axis.sign, z[2] * axis.sign))
        return found

    def jacobian(self, frame: Frame, r: Vector) -> list[list[Scalar]]:
        """Return the columns (linear, angular) of the coordinates for a point in a frame."""
        R, p = self.pose(frame)
        point, zero = add(p, times(R, r)), self.ring.zero
        columns = [[zero] * 6 for _ in self.model.coordinates]
        for k in self._carrying(frame.link):
            arm = difference_of(point, self.anchors[k])
            linear, angular = self.model.joints[k].type.column(self.axes[k], arm)
            for j, ratio in self.terms[k]:
                both = zip(columns[j], (*linear, *angular), strict=True)
                columns[j] = [total + x * ratio for total, x in both]
        return columns

    @cached_property
    def _segment_rotations(self) -> list[Matrix]:
        """Rotation of each segment's frame in frame 0."""
        rotations = [self._rotation(self._segments[0].entry)]
        for segment in self._segments[1:]:
            rotations.append(product(rotations[segment.before], self._rotation(segment.entry)))
        return rotations

    @cached_property
    def _positions(self) -> tuple[list[Vector], list[Vector]]:
        """Positions in frame 0 of the links' frames, and of a point on each joint's axis."""
        origins: list[Vector] = []
        anchors: list[Vector] = []
        for joint, way in zip(self.model.joints, self._ways, strict=True):
            r = origins[joint.parent] if joint.parent >= 0 else self._nowhere
            for item in way:
                if isinstance(item, _Axis):
                    anchors.append(r)
                else:
                    r = add(r, times(self._segment_rotations[item.segment], self._shift(item)))
            origins.append(r)
        return origins, anchors

    # -- in the links' home segments --------------------------------------------------------------

    def in_link(self, i: int, v: Vector) -> Vector:
        """Return a vector of link i's home segment, in the axes of link i."""
        return times(transpose(self._rotation(self._home(i).turned)), v)

    def in_home(self, i: int, v: Vector) -> Vector:
        """Return a vector in the axes of link i, in those of its home segment."""
        return times(self._rotation(self._home(i).turned), v)

    def columns(self, i: int) -> Iterator[tuple[int, Vector, Vector]]:
        """Yield (j, v, omega) for the coordinates j that move link i, per unit of their rates.

        v is of the origin of the link's frame; both in the axes of the link's home segment.
        """
        found: dict[int, tuple[Vector, Vector]] = {}
        for k, v, w in self._joint_columns(i):
            for j, ratio in self.terms[k]:
                more = scaled(ratio, v), scaled(ratio, w)
                old = found.get(j)
                found[j] = more if old is None else (add(old[0], more[0]), add(old[1], more[1]))
        for j, (v, w) in found.items():
            yield j, v, w

    def _joint_columns(self, i: int) -> Iterator[tuple[int, Vector, Vector]]:
        """Yield (k, v, omega) for the joints k that move link i."""
        r, Q, segment = self._nowhere, self._identity, self._home(i).segment
        for link in self._carrying(i):
            for item in reversed(self._ways[link]):
                while item.segment != segment:
                    Q = product(Q, transpose(self._rotation(self._segments[segment].entry)))
                    segment = self._segments[segment].before
                if isinstance(item, _Axis):
                    x, y, z = transpose(Q)[2]
                    axis = x * item.sign, y * item.sign, z * item.sign
                    yield item.joint, *self.model.joints[item.joint].type.column(axis, r)
                else:
                    r = add(r, times(Q, self._shift(item)))

    def velocities(self, qd: Sequence[Scalar]) -> Iterator[tuple[Vector, Vector]]:
        """Yield (v, omega) of each link's frame, in the axes of its home segment."""
        found: list[tuple[Vector, Vector]] = []
        rates = self.joint_rates(qd)
        for joint, way in zip(self.model.joints, self._ways, strict=True):
            still = self._nowhere, self._nowhere
            v, w = found[joint.parent] if joint.parent >= 0 else still
            segment = self._home(joint.parent).segment
            for item in way:
                v, w = (self._into(item.segment, u, segment) for u in (v, w))
                segment = item.segment
                if isinstance(item, _Axis):
                    rate = rates[item.joint] * item.sign
                    w, v = joint.type.moved(Velocity(w, v), rate)
                else:
                    v = add(v, cross(w, self._shift(item)))
            found.append((v, w))
            yield v, w

    def along(self, u: Vector) -> Iterator[tuple[Scalar, Vector]]:
        """Yield (u . r, u) for each link: r the origin of its frame, u in its home segment's axes.

        ``u`` is given in frame 0. Heights need no more than this.
        """
        found: list[tuple[Scalar, Vector]] = []
        for joint, way in zip(self.model.joints, self._ways, strict=True):
            height, v = found[joint.parent] if joint.parent >= 0 else (self.ring.zero, u)
            segment = self._home(joint.parent).segment
            for item in way:
                v = self._into(item.segment, v, segment)
                segment = item.segment
                if isinstance(item, _Step):
                    height = height + dot(v, self._shift(item))
            found.append((height, v))
            yield height, v

    def joint_rates(self, qd: Sequence[Scalar]) -> list[Scalar]:
        """Return the rates of the joints, A qd."""
        zero = self.ring.zero
        return [sum((qd[j] * ratio for j, ratio in row), zero) for row in self.terms]

    @cached_property
    def terms(self) -> list[list[tuple[int, Scalar]]]:
        """The rows of A: (coordinate, ratio) of what moves each joint."""
        return [
            [(j, 1 if ratio == 1 else self.ring.convert(ratio)) for j, ratio in joint.terms]
            for joint in self.model.joints
        ]

    # -- elements ---------------------------------------------------------------------------------

    def _home(self, i: int) -> _Place:
        return self._places[i] if i >= 0 else _Place()

    def _carrying(self, i: int) -> Iterator[int]:
        """Yield link i and the links that carry it."""
        if i >= 0:
            yield i
            yield from self.model.ancestors(i)

    def _last_common(self, i: int, j: int) -> int:
        """Return the last link that carries, or is, both of two links."""
        carrying = {-1, *self._carrying(i)}
        return next(k for k in (*self._carrying(j), -1) if k in carrying)

    @cached_property
    def _axes(self) -> list[_Axis]:
        return [item for way in self._ways for item in way if isinstance(item, _Axis)]

    def _in_segment(self, frame: Frame) -> Pose:
        """Return where a frame is from its link's origin, in the axes of the home segment."""
        R, p = self._rotation(self._home(frame.link).turned), self._nowhere
        for step in frame.placement.steps:
            if isinstance(step, Shift):
                p = add(p, times(R, self._vector(step.p)))
            else:
                R = product(R, self._turn(step))
        return R, p

    def _from(self, link: int, frame: Frame) -> Pose:
        """Return where a frame is from a link that carries it, in the axes of its home segment."""
        Q, r, segment = self._identity, self._nowhere, self._home(link).segment
        upto = set(self._carrying(link))
        for k in reversed([k for k in self._carrying(frame.link) if k not in upto]):
            for item in self._ways[k]:
                for entry in self._between(segment, item.segment):
                    Q = product(Q, self._rotation(entry))
                segment = item.segment
                if isinstance(item, _Step):
                    r = add(r, times(Q, self._shift(item)))
        R, p = self._in_segment(frame)
        return product(Q, R), add(r, times(Q, p))

    def _between(self, before: int, segment: int) -> list[_Orientation]:
        """Return the entries of the segments on the way from one to another."""
        entries = []
        while segment != before:
            entries.append(self._segments[segment].entry)
            segment = self._segments[segment].before
        return entries[::-1]

    def _into(self, segment: int, u: Vector, before: int) -> Vector:
        """Return vector u of segment ``before`` in the axes of a segment further along."""
        for entry in self._between(before, segment):
            u = times(transpose(self._rotation(entry)), u)
        return u

    def _rotation(self, turned: _Orientation) -> Matrix:
        """Rz(angle) Rx(tilt) R."""
        s, c = self.ring.sincos(turned.angle)
        st, ct = self.ring.sincos(turned.tilt)
        zero = self.ring.zero
        R = (c, -s * ct, s * st), (s, c * ct, -c * st), (zero, st, ct)
        return R if turned.R is None else product(R, self._matrix(turned.R))

    def _turn(self, step: Turn | Rotation) -> Matrix:
        if isinstance(step, Rotation):
            return self._matrix(step.R)
        angle, tilt = (step.angle, _ZERO) if step.axis == "z" else (_ZERO, step.angle)
        return self._rotation(_Orientation(angle, tilt))

    def _shift(self, step: _Step) -> Vector:
        """Return a shift in the axes of its segment."""
        x, y, z = (self.ring.convert(component) for component in step.p)
        s, c = self.ring.sincos(step.turned.angle)
        if step.turned.tilt != 0:
            y, z = -y, -z
        return c * x - s * y, s * x + c * y, z

    def _vector(self, v: Vector) -> Vector:
        x, y, z = map(self.ring.convert, v)
        return x, y, z

    def _matrix(self, R: Matrix) -> Matrix:
        x, y, z = map(self._vector, R)
        return x, y, z

    @cached_property
    def _nowhere(self) -> Vector:
        return (self.ring.zero,) * 3

    @cached_property
    def _identity(self) -> Matrix:
        zero, one = self.ring.zero, self.ring.one
        return (one, zero, zero), (zero, one, zero), (zero, zero, one)


class _Walk:
    """The elementary motions of a model as they are gone through, link by link."""

    def __init__(self, model: Model):
        self.segments = [_Segment(-1, _Orientation())]
        #: of each link: where its frame is, and the way there from the frame of its parent
        self.places: list[_Place] = []
        self.ways: list[list[_Step | _Axis]] = []
        #: (variable, basic angle) of the coordinates that turn something, and in which segment
        self.angles: list[tuple[Any, Any]] = []
        self.groups: list[int] = []
        self._variables = model.qs
        self._fractions = _fractions(model)
        self._declared: set[Any] = set()
        for k, joint in enumerate(model.joints):
            self._joint(k, joint)

    def _joint(self, k: int, joint: Joint) -> None:
        """Go from the frame of the parent of joint k to that of its link."""
        place = self.places[joint.parent] if joint.parent >= 0 else _Place()
        way: list[_Step | _Axis] = []
        for step in joint.placement.steps:
            if isinstance(step, Shift):
                self._shift(way, place, step.p)
            elif isinstance(step, Turn) and step.axis == "z":
                place = replace(place, angle=sp.expand(place.angle + place.sign * step.angle))
            else:
                place = self._tilted(place, step)
        way.append(_Axis(place.segment, k, place.sign))
        moved = sp.Add(*(ratio * self._variables[j] for j, ratio in joint.terms))
        turn, slide = joint.type.displacement(joint.offset + moved)
        if turn != 0:
            angle = sp.expand(place.angle + place.sign * turn)
            self._declare(angle, [j for j, _ in joint.terms], place.segment)
            place = replace(place, angle=angle)
        self._shift(way, place, (_ZERO, _ZERO, slide))
        self.places.append(place)
        self.ways.append(way)

    def _declare(self, angle: Any, moving: Sequence[int], segment: int) -> None:
        """Make the angle, or sum of angles, of a joint basic for a coordinate that is new in it.

        A coordinate that turns some joint by halves or thirds of it is basic in these.
        """
        slopes = {j: sp.sympify(angle).coeff(x) for j, x in enumerate(self._variables)}
        new = [j for j in moving if self._variables[j] not in self._declared]
        lead = next((j for j in new if self._fractions[j] == 1 and abs(slopes[j]) == 1), None)
        whole = all((self._fractions[j] * slope).is_Integer for j, slope in slopes.items())
        others = (j for j in slopes if slopes[j] != 0 and (j != lead or not whole))
        for j in others:
            self._declare_as(j, self._variables[j] / self._fractions[j], segment)
        if lead is not None:
            self._declare_as(lead, _without_quarter_turns(angle), segment)

    def _declare_as(self, j: int, angle: Any, segment: int) -> None:
        variable = self._variables[j]
        if variable not in self._declared:
            self._declared.add(variable)
            self.angles.append((variable, angle))
            self.groups.append(segment)

    def _shift(self, way: list[_Step | _Axis], place: _Place, p: Vector) -> None:
        if any(x != 0 for x in p):
            way.append(_Step(place.segment, place.turned, p))

    def _tilted(self, place: _Place, step: Turn | Rotation) -> _Place:
        """Return the place after a turn about x or any other: in a new segment, or flipped."""
        if isinstance(step, Rotation):
            entry = replace(place.turned, R=step.R)
        else:
            half_turns = step.angle / sp.pi
            if half_turns.is_Integer:
                return replace(place, flipped=place.flipped ^ bool(half_turns % 2))
            entry = replace(place.turned, tilt=place.turned.tilt + step.angle)
        self.segments.append(_Segment(place.segment, entry))
        return _Place(len(self.segments) - 1)


#: a coordinate that turns joints by p / n of it, n up to this, is basic in the n-th of it; beyond,
#: sin(p q / n) stands for itself: powers of a sine are as high as n
_FINEST = 6


def _fractions(model: Model) -> list[int]:
    """Return n for each coordinate: it turns joints by whole multiples of its n-th part."""
    found = [1] * model.nv
    for joint in model.joints:
        for j, ratio in joint.terms:
            ratio = sp.sympify(ratio)
            turns, _ = joint.type.displacement(ratio)
            n = int(ratio.q) if turns != 0 and ratio.is_Rational else 1
            together = math.lcm(found[j], n)
            found[j] = together if together <= _FINEST else found[j]
    return found


def _without_quarter_turns(angle: Any) -> Any:
    """Return ``angle`` less its part in multiples of pi/2, which costs nothing in sin and cos."""
    number = sum((p for p in sp.Add.make_args(angle) if p.is_number), sp.Integer(0))
    rest = angle - number
    return rest if (2 * number / sp.pi).is_Integer else rest + number
