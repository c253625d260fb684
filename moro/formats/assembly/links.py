"""A link in the terms of texts and files: how it is placed on its parent, and how it moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from moro.model import Body, Drive, JointType
from moro.model.placement import Step
from moro.spatial.vectors import Scalar

_FREE = Drive()


@dataclass(frozen=True)
class Motion:
    """A turn about or a slide along z by sum_j ratio_j q_j + offset [rad or m]."""

    type: JointType
    #: (name of a coordinate, ratio): the ratios are constant and not 0
    terms: tuple[tuple[str, Scalar], ...]
    offset: Scalar = 0
    #: of the joint
    name: str = ""
    #: what acts on the motion itself, at its own rate; what acts at a coordinate is given there
    drive: Drive = _FREE


@dataclass(frozen=True)
class Link:
    """A link, whose frame the ``path`` leads to from the frame of its parent (None: the world).

    Constant steps and motions follow each other as the text has them: a row of DH parameters is
    (Motion, Shift, Shift, Turn), of modified ones (Turn, Shift, Motion, Shift), a joint of a URDF
    (origin, axis to z, Motion, axis back). A link whose path has no motion is fixed to its parent;
    one with several moves by all of them: helical and planar joints.
    """

    name: str
    parent: str | None
    path: tuple[Step | Motion, ...] = ()
    #: in the frame of the link
    bodies: tuple[Body, ...] = ()

    @property
    def motions(self) -> tuple[Motion, ...]:
        """How it moves on its parent."""
        return tuple(step for step in self.path if isinstance(step, Motion))

    @property
    def spins(self) -> bool:
        """Whether it is a rotor, which carries nothing."""
        return any(motion.type.spins for motion in self.motions)


#: constant steps only
Steps: TypeAlias = "tuple[Step, ...]"
