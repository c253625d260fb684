"""An arm at one instant: what the algorithms of dynamics read.

At an instant, the positions of the joints are in the poses of the links' frames and nowhere else.
Any frames fixed in the links give the same torques, as long as a link moves about or along the z
axis of its frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from moro.algorithms.coordinates import Terms, displacements, joint_rates
from moro.model import PRISMATIC, JointType, Model, Placement
from moro.spatial.moments import Moments
from moro.spatial.motion import REST, Velocity
from moro.spatial.transform import Transform, moments_in_parent, velocity_in_link
from moro.spatial.vectors import Scalar, Vector


@dataclass(frozen=True)
class PosedLink(Transform):
    """A joint and its body: where its frame is in its parent's, and how the joint moves it."""

    type: JointType
    #: index of the parent link, -1 for the base
    parent: int
    #: x of the joint: the angle of sin and cos, or how far p has moved along z; 0 where it spins
    position: Scalar
    body: Moments
    #: how much each coordinate moves the joint
    terms: Terms


@dataclass(frozen=True)
class Posture:
    """A tree of links, parents first, moved by nv coordinates."""

    links: tuple[PosedLink, ...]
    #: in the axes of the base [m/s^2]
    gravity: Vector
    nv: int

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
    """Return the model at q: the one entrance to the algorithms.

    ``sincos[i]`` is the pair (sin, cos) of the displacement of joint i (``displacements``) if it
    turns; for another it does not matter, and may be None. With arrays for scalars, many samples
    are computed at once.
    """
    links = []
    ways = displacements(model, q)
    for joint, body, x, pair in zip(model.joints, model.bodies, ways, sincos, strict=True):
        frame = joint.type.transform(joint.placement.R, joint.placement.p, x, pair or (0, 1))
        position = 0 if joint.type.spins else x
        links.append(
            PosedLink(
                frame.R, frame.p, frame.sin, frame.cos,
                joint.type, joint.parent, position, body.moments, joint.terms,
            )
        )  # fmt: skip
    return Posture(tuple(links), model.gravity, model.nv)


def with_frame(arm: Posture, link: int, placement: Placement) -> Posture:
    """Return the arm with a frame fixed in a link as a further link that weighs nothing."""
    still = PosedLink(placement.R, placement.p, 0, 1, PRISMATIC, link, 0, Moments(0), ())
    return replace(arm, links=(*arm.links, still))


def weightless(arm: Posture) -> Posture:
    """Return the arm without gravity."""
    return replace(arm, gravity=(0, 0, 0))


def velocities(arm: Posture, qd: Sequence[Scalar]) -> list[Velocity]:
    """Return the velocity of every link."""
    found: list[Velocity] = []
    for link, rate in zip(arm.links, joint_rates(arm.links, qd, arm.nv), strict=True):
        parent = REST if link.parent < 0 else found[link.parent]
        found.append(link.type.moved(velocity_in_link(link, parent), rate))
    return found


def ancestors(links: Sequence[PosedLink], i: int) -> Iterator[int]:
    """Yield the links that carry link i, from its parent to the base."""
    while (i := links[i].parent) >= 0:
        yield i


def composites(arm: Posture) -> list[Moments]:
    """Return for every link the moments of it and all it carries, as one rigid body."""
    total = [link.body for link in arm.links]
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            total[link.parent] = total[link.parent] + moments_in_parent(link, total[i])
    return total
