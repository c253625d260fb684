"""Between joints and generalized coordinates, over any scalar.

The displacements of the joints are affine in the coordinates, x = A q + b with constant A and b.
Their rates are A qd, and of their torques the coordinates bear A^T tau, since the power is one; so
M and C become A^T M A and A^T C A, and dM/dt - 2 C stays skew. Where each joint has a coordinate of
its own, A is 1 and costs nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeAlias

from moro.model import Model
from moro.spatial.vectors import Scalar

#: a row of A: (j, A_ij) for the coordinates that move a joint
Terms: TypeAlias = "tuple[tuple[int, Scalar], ...]"


class Moved(Protocol):
    """A joint or a link: what coordinates move."""

    @property
    def terms(self) -> Terms:
        """Its row of A."""

    @property
    def parent(self) -> int:
        """Index of what carries it, -1 for the base."""


def displacements(model: Model, q: Sequence[Scalar]) -> list[Scalar]:
    """Return x = A q + b of every joint [rad or m]."""
    ways = joint_rates(model.joints, q, model.nv)
    return [x + joint.offset for x, joint in zip(ways, model.joints, strict=True)]


def joint_rates(joints: Iterable[Moved], qd: Sequence[Scalar], nv: int) -> list[Scalar]:
    """Return A qd: the rates of the joints, or their accelerations from qdd."""
    if len(qd) != nv:
        raise ValueError(f"{len(qd)} values for {nv} coordinates")
    return [sum(ratio * qd[j] for j, ratio in joint.terms) for joint in joints]


def generalized(joints: Iterable[Moved], tau: Iterable[Scalar], nv: int) -> list[Scalar]:
    """Return A^T tau: what nv coordinates bear of the torques (forces) of the joints."""
    shares: list[Scalar] = [0] * nv
    for joint, x in zip(joints, tau, strict=True):
        for j, ratio in joint.terms:
            shares[j] = shares[j] + ratio * x
    return shares


def in_coordinates(
    joints: Sequence[Moved], matrix: Iterable[Iterable[Scalar]], nv: int
) -> list[list[Scalar]]:
    """Return A^T M A for a matrix over the joints."""
    columns = zip(*(generalized(joints, row, nv) for row in matrix), strict=True)
    return [list(x) for x in zip(*(generalized(joints, x, nv) for x in columns), strict=True)]


def couplings(joints: Sequence[Moved], nv: int) -> list[list[int]]:
    """Return for each coordinate those before it that it is coupled with in M, the last first.

    Two are coupled where one moves a joint that carries, or is, a joint of the other; and where a
    third, which comes after them, is coupled with both: so elimination from the last to the first
    fills in nothing else. With a coordinate for each joint, they are the joints that carry it.
    """
    coupled: list[set[int]] = [set() for _ in range(nv)]
    moving: list[set[int]] = []
    for joint in joints:
        own = {j for j, _ in joint.terms}
        moving.append(own | (moving[joint.parent] if joint.parent >= 0 else set()))
        for j in own:
            for k in moving[-1] - {j}:
                coupled[max(j, k)].add(min(j, k))
    for before in reversed(coupled):
        for k in before:
            coupled[k] |= {other for other in before if other < k}
    return [sorted(before, reverse=True) for before in coupled]
