"""The plain data that every dynamics algorithm reads: a tree of joints, each carrying a body.

Every convention is brought to this form once, on entry (``Robot.model()``). Scalars may be SymPy
expressions, numbers, arrays or graph nodes: ``Model.map`` turns one kind into another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

Scalar: TypeAlias = Any
Vector: TypeAlias = tuple[Scalar, Scalar, Scalar]
Matrix: TypeAlias = tuple[Vector, Vector, Vector]
JointKind: TypeAlias = Literal["revolute", "prismatic"]


@dataclass(frozen=True)
class Placement:
    """A constant pose of one frame in another: ``x_parent = R x + p``."""

    R: Matrix
    p: Vector


@dataclass(frozen=True)
class Joint:
    """Joint i: placed in the frame of its parent joint, then moved about or along its own z axis.

    A revolute joint turns by ``q_i + offset`` [rad], a prismatic one slides by it [m]. ``parent``
    is the 0-based index of the parent joint, -1 for the base, and less than i.
    """

    kind: JointKind
    parent: int
    placement: Placement
    offset: Scalar = 0
    #: link side, adds ``rotor_inertia * qdd_i`` to ``tau_i`` [kg m^2 or kg]
    rotor_inertia: Scalar = 0
    #: viscous friction coefficient, adds ``viscous * qd_i`` to ``tau_i``
    viscous: Scalar = 0
    #: Coulomb friction for ``qd_i > 0`` and for ``qd_i < 0``, both as magnitudes
    coulomb: tuple[Scalar, Scalar] = (0, 0)


@dataclass(frozen=True)
class Body:
    """The ten inertial parameters of a body, in the frame of its joint.

    ``inertia`` is the tensor about the *origin of the joint's frame*, not about the centre of mass:
    the dynamics is linear in (mass, first_moment, inertia).
    """

    mass: Scalar
    #: mass times centre of mass [kg m]
    first_moment: Vector
    #: about the frame's origin [kg m^2]
    inertia: Matrix


@dataclass(frozen=True)
class Model:
    """A robot arm as the algorithms read it; joint i carries body i."""

    name: str
    joints: tuple[Joint, ...]
    bodies: tuple[Body, ...]
    #: gravitational acceleration in the base frame [m/s^2]
    gravity: Vector
    #: pose of frame n (the last frame of the convention) in the frame of the last joint
    tip: Placement

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self.joints)

    def map(self, convert: Callable[[Scalar], Scalar]) -> Model:
        """Return the same model with ``convert`` applied to every scalar."""

        def vector(v: Vector) -> Vector:
            x, y, z = v
            return convert(x), convert(y), convert(z)

        def matrix(m: Matrix) -> Matrix:
            x, y, z = m
            return vector(x), vector(y), vector(z)

        def placement(p: Placement) -> Placement:
            return Placement(matrix(p.R), vector(p.p))

        def joint(j: Joint) -> Joint:
            return replace(
                j,
                placement=placement(j.placement),
                offset=convert(j.offset),
                rotor_inertia=convert(j.rotor_inertia),
                viscous=convert(j.viscous),
                coulomb=(convert(j.coulomb[0]), convert(j.coulomb[1])),
            )

        def body(b: Body) -> Body:
            return Body(convert(b.mass), vector(b.first_moment), matrix(b.inertia))

        return replace(
            self,
            joints=tuple(joint(j) for j in self.joints),
            bodies=tuple(body(b) for b in self.bodies),
            gravity=vector(self.gravity),
            tip=placement(self.tip),
        )
