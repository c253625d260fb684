"""The plain data that every algorithm reads: a tree of joints, each carrying a body, and frames.

Every description is brought to this form once, on entry (``Robot.model()``); both the symbolic and
the recursive route start here. Scalars may be SymPy expressions, numbers, arrays or graph nodes:
``Model.map`` turns one kind into another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from moro.model.joint_types import JointType
from moro.model.placement import Placement
from moro.spatial.moments import Moments
from moro.spatial.vectors import Matrix, Scalar, Vector


@dataclass(frozen=True)
class Joint:
    """Joint i: placed in the frame of its parent joint, then moved about or along its own z axis.

    It moves by ``q_i + offset`` [rad or m]. ``parent`` is the 0-based index of the parent joint, -1
    for the base, and less than i.
    """

    type: JointType
    parent: int
    placement: Placement
    offset: Scalar = 0
    #: link side, adds ``rotor_inertia * qdd_i`` to ``tau_i`` [kg m^2 or kg]
    rotor_inertia: Scalar = 0
    #: viscous friction coefficient, adds ``viscous * qd_i`` to ``tau_i``
    viscous: Scalar = 0
    #: Coulomb friction for ``qd_i > 0`` and for ``qd_i < 0``, both as magnitudes
    coulomb: tuple[Scalar, Scalar] = (0, 0)
    #: q_i as closed forms write it; by default q_i(t) of ``moro.abc``
    variable: Any = None
    #: (lower, upper) of q_i [rad or m]; None where none are given
    limits: tuple[Scalar, Scalar] | None = None

    @property
    def range(self) -> tuple[Scalar, Scalar]:
        """The limits, or those that are assumed for joints of its type."""
        return self.type.assumed_limits if self.limits is None else self.limits


_NOWHERE = Placement()


@dataclass(frozen=True)
class Central:
    """A body as it is described about its centre of mass, in a frame of its link."""

    #: the centre of mass [m]
    com: Vector
    #: the tensor about it [kg m^2]
    inertia: Matrix
    #: the frame, in that of the joint
    frame: Placement = _NOWHERE


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
    #: whether a zero among these is a number that was given, rather than an assumption
    in_numbers: bool = True
    #: how it was given, if it was about its centre of mass; closed forms of that read it
    central: Central | None = None

    @property
    def moments(self) -> Moments:
        """The same as integrals over the body."""
        return Moments.of(self.mass, self.first_moment, self.inertia)


@dataclass(frozen=True)
class Frame:
    """A named frame fixed in a link (0-based; -1 is the base), placed in the frame of its joint."""

    name: str
    link: int
    placement: Placement


@dataclass(frozen=True)
class Parameter:
    """A symbol that a model leaves free: its number is given at run time."""

    symbol: Any
    #: its number, if no other is given; None: one has to be given
    default: Any = None
    #: what it is of the robot: "mass of link 2"
    meaning: str = ""


@dataclass(frozen=True)
class Model:
    """A robot as the algorithms read it; joint i carries body i, and parents come first."""

    name: str
    joints: tuple[Joint, ...]
    bodies: tuple[Body, ...]
    #: gravitational acceleration in the base frame [m/s^2]
    gravity: Vector
    #: the last is the tip: what functions speak of that name no frame; by default the last joint's
    frames: tuple[Frame, ...] = ()
    #: the symbols among the scalars, in the order in which kernels take them
    parameters: tuple[Parameter, ...] = ()
    #: what was not set and is zero here: "masses", "rotor_inertias", ...
    not_set: frozenset[str] = frozenset()
    #: "dh" or "mdh" where the frames are those of a table of such rows
    convention: str = ""

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self.joints)

    @property
    def nq(self) -> int:
        """Number of joint positions."""
        return sum(joint.type.nq for joint in self.joints)

    @property
    def nv(self) -> int:
        """Number of joint velocities."""
        return sum(joint.type.nv for joint in self.joints)

    @property
    def qs(self) -> list[Any]:
        """The joint variables of closed forms."""
        from moro.abc import joint_variable  # SymPy, which help does without

        return [
            joint_variable(i) if joint.variable is None else joint.variable
            for i, joint in enumerate(self.joints, 1)
        ]

    @property
    def defaults(self) -> dict[Any, Any]:
        """The parameters' symbols and their defaults."""
        return {parameter.symbol: parameter.default for parameter in self.parameters}

    @property
    def tip(self) -> Frame:
        """The last frame."""
        return self.frames[-1] if self.frames else Frame("tip", self.dof - 1, Placement())

    def ancestors(self, i: int) -> Iterator[int]:
        """Yield the joints that carry joint i, from its parent to the base."""
        while (i := self.joints[i].parent) >= 0:
            yield i

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
            return replace(
                b,
                mass=convert(b.mass),
                first_moment=vector(b.first_moment),
                inertia=matrix(b.inertia),
                central=None,
            )

        return replace(
            self,
            joints=tuple(joint(j) for j in self.joints),
            bodies=tuple(body(b) for b in self.bodies),
            gravity=vector(self.gravity),
            frames=tuple(replace(f, placement=placement(f.placement)) for f in self.frames),
        )


def as_model(robot: Any) -> Model:
    """Return the model of a robot, or a model as it is. Raise TypeError for anything else."""
    if isinstance(robot, Model):
        return robot
    model = getattr(robot, "model", None)
    if not callable(model):
        raise TypeError(f"a Robot or a Model is needed, not {robot!r}")
    found: Model = model()
    return found
