"""An arm at one instant: what the algorithms of dynamics read.

At an instant, the positions of the joints are in the poses of the links' frames and nowhere else.
Any frames fixed in the links give the same torques, as long as a link turns about, or slides along,
the z axis of its frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from moro.algorithms.vectors import add, dyad, product, scaled, sum_of, times, transpose
from moro.model import Body, JointKind, Matrix, Model, Scalar, Vector


@dataclass(frozen=True)
class Moments:
    """The inertial parameters of a body: integrals over its mass, r from the frame's origin."""

    #: integral of dm [kg]
    m: Scalar
    #: integral of r dm [kg m]
    h: Vector = (0, 0, 0)
    #: integral of r r^T dm, which is tr(J)/2 1 - J for the tensor of inertia J [kg m^2]
    S: Matrix = ((0, 0, 0), (0, 0, 0), (0, 0, 0))

    @classmethod
    def of(cls, body: Body) -> Moments:
        """Return the moments of a body of a model."""
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = body.inertia
        half = (xx + yy + zz) / 2
        S = (half - xx, -xy, -xz), (-yx, half - yy, -yz), (-zx, -zy, half - zz)
        return cls(body.mass, body.first_moment, S)

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.m + other.m, add(self.h, other.h), sum_of(self.S, other.S))

    def __sub__(self, other: Moments) -> Moments:
        S = scaled(-1, other.S[0]), scaled(-1, other.S[1]), scaled(-1, other.S[2])
        return self + Moments(-other.m, scaled(-1, other.h), S)

    def rotated(self, R: Matrix) -> Moments:
        """Return the moments after r -> R r."""
        return Moments(self.m, times(R, self.h), product(product(R, self.S), transpose(R)))

    def displaced(self, p: Vector) -> Moments:
        """Return the moments after r -> r + p."""
        h = add(self.h, scaled(self.m, p))
        return Moments(self.m, h, sum_of(self.S, sum_of(dyad(self.h, p), dyad(p, h))))


@dataclass(frozen=True)
class Link:
    """A joint and its body: x_parent = R Rz x + p, where Rz turns about z by (sin, cos)."""

    kind: JointKind
    #: index of the parent link, -1 for the base
    parent: int
    R: Matrix
    p: Vector
    sin: Scalar
    cos: Scalar
    #: q + offset of the joint: the angle of sin and cos, or how far p has moved along z
    position: Scalar
    body: Moments

    def rotate(self, v: Vector) -> Vector:
        """Return the components of v in the axes of the parent, given those in the link's."""
        x, y, z = v
        return times(self.R, (self.cos * x - self.sin * y, self.sin * x + self.cos * y, z))

    def rotate_back(self, v: Vector) -> Vector:
        """Return the components of v in the axes of the link, given those in the parent's."""
        x, y, z = times(transpose(self.R), v)
        return self.cos * x + self.sin * y, self.cos * y - self.sin * x, z


@dataclass(frozen=True)
class Posture:
    """A tree of links, parents first, and gravity in the axes of the base [m/s^2]."""

    links: tuple[Link, ...]
    gravity: Vector

    @property
    def children(self) -> list[list[int]]:
        """The indices of every link's children."""
        lists: list[list[int]] = [[] for _ in self.links]
        for i, link in enumerate(self.links):
            if link.parent >= 0:
                lists[link.parent].append(i)
        return lists


def posture(
    model: Model, q: Sequence[Scalar], sincos: Sequence[tuple[Scalar, Scalar] | None]
) -> Posture:
    """Return the model with its joints at q.

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint; for a prismatic
    one it does not matter, and may be None.
    """
    links = []
    for joint, body, x, pair in zip(model.joints, model.bodies, q, sincos, strict=True):
        R, p, position = joint.placement.R, joint.placement.p, x + joint.offset
        sin, cos = pair or (0, 1)
        if joint.kind == "prismatic":
            sin, cos, p = 0, 1, add(p, times(R, (0, 0, position)))
        moments = Moments.of(body)
        links.append(Link(joint.kind, joint.parent, R, p, sin, cos, position, moments))
    return Posture(tuple(links), model.gravity)
