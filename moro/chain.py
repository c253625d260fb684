"""The geometry of an arm over any scalar: frames, joint axes, Jacobians, velocities.

The rows of a DH table are a chain of elementary motions: turns about z, shifts along z and x,
turns about x. Joints with parallel axes have no turn about x between them (or half a turn), so
their turns about z simply add up: such a stretch of the chain is a *segment*. Its frame is the
orientation before its first joint turns; in it the links of the stretch are described by the sums
of their angles, q2 and q2 + q3. This is what keeps closed forms short.

The scalars come from a ring: ``TrigRing`` for closed forms, ``DualRing`` for numbers and their
derivatives. A vector is a list of three scalars, a matrix a list of three rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias

import sympy as sp

Scalar: TypeAlias = Any
Vec: TypeAlias = "list[Scalar]"
Mat: TypeAlias = "list[list[Scalar]]"


@dataclass(frozen=True)
class Row:
    """One row of a DH table: SymPy constants and the joint variable added to one of them.

    The variable adds to ``theta`` of a revolute joint ("r") and to ``d`` of a prismatic one ("p").
    """

    a: Any
    alpha: Any
    d: Any
    theta: Any
    variable: Any
    kind: Literal["r", "p"]


@dataclass(frozen=True)
class _Segment:
    """A stretch of parallel joints: frame g in frame g-1 is Rz(entry_angle) Rx(tilt)."""

    entry_angle: Any
    tilt: Any


@dataclass(frozen=True)
class _Link:
    """Where frame i is: in its home segment g, turned by Rz(angle) Rx(tilt)."""

    segment: int
    angle: Any
    tilt: Any


@dataclass(frozen=True)
class _Shift:
    """A displacement: ``axial`` along z, ``radial`` along x turned by ``angle``."""

    segment: int
    axial: Any
    radial: Any
    angle: Any


@dataclass(frozen=True)
class _Motion:
    """Joint k: about or along ``sign`` times the z axis of its segment."""

    segment: int
    joint: int
    kind: str
    sign: int


@dataclass(frozen=True)
class _End:
    """The end of row i, where frame i has its origin."""

    segment: int
    link: int


class Chain:
    """The geometry of an arm given by DH rows, over the scalars of ``ring``.

    ``convention`` is "dh" (standard: Rz Tz Tx Rx) or "mdh" (modified: Rx Tx Rz Tz). Joints and
    links are counted from 0 here; frame i of the texts is link i - 1. The arm itself
    declares its angles to the ring; a part of it (``declare=False``) uses them.
    """

    def __init__(self, rows: Sequence[Row], convention: str, ring: Any, declare: bool = True):
        self.rows = tuple(rows)
        self.ring = ring
        self._walk = _Walk()
        for i, row in enumerate(self.rows):
            if convention == "dh":
                self._walk.joint(i, row)
                self._walk.advance(row.a)
                self._walk.link(row.alpha)
                self._walk.end(i)
                self._walk.tilt(row.alpha)
            else:
                self._walk.advance(row.a)
                self._walk.tilt(row.alpha)
                self._walk.joint(i, row)
                self._walk.link(sp.Integer(0))
                self._walk.end(i)
        for group in self._walk.groups if declare else []:
            if group:
                ring.declare_angles(group)

    # -- in frame 0 -------------------------------------------------------------------------------

    @cached_property
    def _segment_rotations(self) -> list[Mat]:
        """Rotation of each segment's frame in frame 0."""
        R = _identity(self.ring)
        rotations = []
        for segment in self._walk.segments:
            R = _times(R, self._rotation(segment.entry_angle, segment.tilt))
            rotations.append(R)
        return rotations

    def R(self, i: int) -> Mat:
        """Return R_i0, the rotation of the frame of link i in frame 0."""
        link = self._walk.links[i]
        R = self._segment_rotations[link.segment]
        return _times(R, self._rotation(link.angle, link.tilt))

    @cached_property
    def _positions(self) -> tuple[list[Vec], list[Vec]]:
        """Positions in frame 0 of the links' frames, and of a point on each joint's axis."""
        r = [self.ring.zero] * 3
        origins: list[Vec] = []
        anchors: list[Vec] = []
        for item in self._walk.items:
            if isinstance(item, _Shift):
                shift = self._displacement(item)
                r = _plus(r, _apply(self._segment_rotations[item.segment], shift))
            else:
                (origins if isinstance(item, _End) else anchors).append(r)
        return origins, anchors

    @property
    def origins(self) -> list[Vec]:
        """Position of each link's frame in frame 0."""
        return self._positions[0]

    @property
    def anchors(self) -> list[Vec]:
        """A point on each joint's axis in frame 0."""
        return self._positions[1]

    @cached_property
    def axes(self) -> list[Vec]:
        """Direction of each joint's axis in frame 0."""
        return [
            [row[2] * item.sign for row in self._segment_rotations[item.segment]]
            for item in self._walk.motions
        ]

    def point_in_base(self, i: int, r: Vec) -> Vec:
        """Return the position in frame 0 of a point given in frame i."""
        return _plus(self.origins[i], _apply(self.R(i), r))

    def tensor_in_base(self, i: int, I: Mat) -> Mat:
        """Return R I R^T: a tensor given in frame i, in the axes of frame 0."""
        return _times(_times(self.R(i), I), _transpose(self.R(i)))

    def jacobian_in_base(self, i: int, r: Vec) -> list[Vec]:
        """Return the 6-vectors (linear, angular) of joints 0..i for a point given in frame i."""
        point, zero = self.point_in_base(i, r), [self.ring.zero] * 3
        columns = []
        for k, z in enumerate(self.axes[: i + 1]):
            arm = [x - y for x, y in zip(point, self.anchors[k], strict=True)]
            revolute = self.rows[k].kind == "r"
            columns.append([*cross(z, arm), *z] if revolute else [*z, *zero])
        return columns

    # -- in the links' home segments --------------------------------------------------------------

    def point(self, i: int, r: Vec) -> Vec:
        """Return a vector given in frame i, in the axes of link i's home segment."""
        link = self._walk.links[i]
        return _apply(self._rotation(link.angle, link.tilt), r)

    def tensor(self, i: int, I: Mat) -> Mat:
        """Return a tensor given in frame i, in the link's axes before their tilt about x."""
        R = self._rotation(sp.Integer(0), self._walk.links[i].tilt)
        return _times(_times(R, I), _transpose(R))

    def in_link(self, i: int, v: Vec) -> Vec:
        """Return a vector of link i's home segment, in link i's axes before their tilt about x."""
        R = self._rotation(self._walk.links[i].angle, sp.Integer(0))
        return _apply(_transpose(R), v)

    def in_frame(self, i: int, v: Vec) -> Vec:
        """Return a vector of link i's home segment, in the axes of frame i."""
        link = self._walk.links[i]
        return _apply(_transpose(self._rotation(link.angle, link.tilt)), v)

    def jacobian_columns(self, i: int, r: Vec) -> Iterator[tuple[int, Vec, Vec]]:
        """Yield (k, linear, angular) for the joints k that move point ``r`` of link i.

        ``r`` and the columns are in the axes of the link's home segment; ``r`` starts at the origin
        of frame i. Revolute: z x r and z; prismatic: z and 0.
        """
        segment = self._walk.links[i].segment
        Q = _identity(self.ring)
        for item in reversed(self._walk.items[: self._walk.ends[i]]):
            while item.segment < segment:
                entry = self._walk.segments[segment]
                Q = _times(Q, _transpose(self._rotation(entry.entry_angle, entry.tilt)))
                segment -= 1
            if isinstance(item, _Shift):
                r = _plus(r, _apply(Q, self._displacement(item)))
            elif isinstance(item, _Motion):
                z = [row[2] * item.sign for row in Q]
                if item.kind == "r":
                    yield item.joint, cross(z, r), z
                else:
                    yield item.joint, z, [self.ring.zero] * 3

    def velocities(self, qd: Sequence[Scalar]) -> Iterator[tuple[Vec, Vec]]:
        """Yield (v, w) of each link's frame, in the axes of its home segment, from base to tip."""
        v, w = [self.ring.zero] * 3, [self.ring.zero] * 3
        segment = 0
        for item in self._walk.items:
            v, w = (self._into(item.segment, u, segment) for u in (v, w))
            segment = item.segment
            if isinstance(item, _Shift):
                v = _plus(v, cross(w, self._displacement(item)))
            elif isinstance(item, _Motion):
                rate = qd[item.joint] * item.sign
                if item.kind == "r":
                    w = [w[0], w[1], w[2] + rate]
                else:
                    v = [v[0], v[1], v[2] + rate]
            else:
                yield v, w

    def along(self, u: Vec) -> Iterator[tuple[Scalar, Vec]]:
        """Yield (u . r, u) for each link: r the origin of its frame, u in its home segment's axes.

        ``u`` is given in frame 0. Heights need no more than this.
        """
        height = self.ring.zero
        segment = 0
        for item in self._walk.items:
            u = self._into(item.segment, u, segment)
            segment = item.segment
            if isinstance(item, _Shift):
                height = height + dot(u, self._displacement(item))
            elif isinstance(item, _End):
                yield height, u

    # -- elements ---------------------------------------------------------------------------------

    def _into(self, segment: int, u: Vec, before: int) -> Vec:
        """Return vector u of segment ``before`` in the axes of a segment further along."""
        for entry in self._walk.segments[before + 1 : segment + 1]:
            u = _apply(_transpose(self._rotation(entry.entry_angle, entry.tilt)), u)
        return u

    def _rotation(self, angle: Any, tilt: Any) -> Mat:
        """Rz(angle) Rx(tilt)."""
        s, c = self.ring.sincos(angle)
        st, ct = self.ring.sincos(tilt)
        zero = self.ring.zero
        return [[c, -s * ct, s * st], [s, c * ct, -c * st], [zero, st, ct]]

    def _displacement(self, shift: _Shift) -> Vec:
        a, d = self.ring.convert(shift.radial), self.ring.convert(shift.axial)
        s, c = self.ring.sincos(shift.angle)
        return [c * a, s * a, d]


class _Walk:
    """The chain of elementary motions as it is built up, row by row."""

    def __init__(self) -> None:
        self.segments = [_Segment(sp.Integer(0), sp.Integer(0))]
        self.groups: list[list[tuple[Any, Any]]] = [[]]
        self.items: list[Any] = []
        self.motions: list[_Motion] = []
        self.links: list[_Link] = []
        self.ends: list[int] = []
        self._angle: Any = sp.Integer(0)
        self._flipped = False  # half a turn about x since the segment began

    def joint(self, i: int, row: Row) -> None:
        sign = -1 if self._flipped else 1
        segment = len(self.segments) - 1
        self.motions.append(_Motion(segment, i, row.kind, sign))
        self.items.append(self.motions[-1])
        if row.kind == "r":
            self._angle = sp.expand(self._angle + sign * (row.theta + row.variable))
            basic = _without_quarter_turns(self._angle)
            self.groups[-1].append((row.variable, basic))
            axial = sign * row.d
        else:
            self._angle = sp.expand(self._angle + sign * row.theta)
            axial = sign * (row.d + row.variable)
        self._shift(axial=axial)

    def advance(self, a: Any) -> None:
        self._shift(radial=a)

    def tilt(self, alpha: Any) -> None:
        half_turns = alpha / sp.pi
        if half_turns.is_Integer:
            self._flipped ^= bool(half_turns % 2)
            return
        self.segments.append(_Segment(self._angle, self._total_tilt(alpha)))
        self.groups.append([])
        self._angle, self._flipped = sp.Integer(0), False

    def link(self, alpha: Any) -> None:
        self.links.append(_Link(len(self.segments) - 1, self._angle, self._total_tilt(alpha)))

    def end(self, i: int) -> None:
        self.items.append(_End(len(self.segments) - 1, i))
        self.ends.append(len(self.items) - 1)

    def _total_tilt(self, alpha: Any) -> Any:
        return alpha + sp.pi if self._flipped else alpha

    def _shift(self, axial: Any = sp.Integer(0), radial: Any = sp.Integer(0)) -> None:  # noqa: B008
        if axial != 0 or radial != 0:
            self.items.append(_Shift(len(self.segments) - 1, axial, radial, self._angle))


def _without_quarter_turns(angle: Any) -> Any:
    """Return ``angle`` less its part in multiples of pi/2, which costs nothing in sin and cos."""
    number = sum((p for p in sp.Add.make_args(angle) if p.is_number), sp.Integer(0))
    rest = angle - number
    return rest if (2 * number / sp.pi).is_Integer else rest + number


# -- vectors and matrices over any scalar ---------------------------------------------------------


def _identity(ring: Any) -> Mat:
    return [[ring.one if i == j else ring.zero for j in range(3)] for i in range(3)]


def _plus(u: Vec, v: Vec) -> Vec:
    return [x + y for x, y in zip(u, v, strict=True)]


def dot(u: Vec, v: Vec) -> Scalar:
    """Return u . v."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Vec, v: Vec) -> Vec:
    """Return u x v."""
    return [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]


def _apply(A: Mat, v: Vec) -> Vec:
    return [dot(row, v) for row in A]


def _transpose(A: Mat) -> Mat:
    return [list(column) for column in zip(*A, strict=True)]


def _times(A: Mat, B: Mat) -> Mat:
    columns = _transpose(B)
    return [[dot(row, column) for column in columns] for row in A]
