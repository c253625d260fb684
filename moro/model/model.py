"""The plain data that every algorithm reads: a tree of joints, each carrying a body, and frames.

Every description is brought to this form once, on entry (``Robot.model()``); both the symbolic and
the recursive route start here. Scalars may be SymPy expressions, numbers, arrays or graph nodes:
``Model.map`` turns one kind into another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

from moro.model.joint_types import JointType
from moro.model.placement import Placement
from moro.spatial.moments import Moments
from moro.spatial.vectors import Matrix, Scalar, Vector


@dataclass(frozen=True)
class Drive:
    """What acts at a coordinate beside the rigid bodies: rotor, friction, spring.

    It adds rotor_inertia qdd + friction(qd) + stiffness (q - rest) to the torque (force), where

        friction = viscous qd + s (coulomb + (static - coulomb) exp(-(qd / stribeck_velocity)^2)),

    s = sign(qd), or tanh(qd / width) with a width. Magnitudes may differ in the two directions.
    """

    #: at the coordinate: of a rotor behind a gear, its inertia times the ratio squared
    #: [kg m^2 or kg]
    rotor_inertia: Scalar = 0
    #: [N m s or N s/m]
    viscous: Scalar = 0
    #: of qd > 0 and of qd < 0, both as magnitudes [N m or N]
    coulomb: tuple[Scalar, Scalar] = (0, 0)
    #: what breaks away from rest, likewise (Stribeck); None: as ``coulomb``
    static: tuple[Scalar, Scalar] | None = None
    stribeck_velocity: Scalar = 1
    #: of the step at rest [rad/s or m/s]; None: it is sharp, sign(qd)
    width: Scalar | None = None
    #: of a spring [N m/rad or N/m], and where it is at rest [rad or m]
    stiffness: Scalar = 0
    rest: Scalar = 0

    @property
    def scalars(self) -> Iterator[Scalar]:
        """All that it holds."""
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                yield from value if isinstance(value, tuple) else (value,)

    def map(self, convert: Callable[[Scalar], Scalar]) -> Drive:
        """Return the same drive with ``convert`` applied to every scalar."""

        def converted(x: Any) -> Any:
            if isinstance(x, tuple):
                return tuple(map(convert, x))
            return x if x is None else convert(x)

        return Drive(*(converted(getattr(self, field.name)) for field in fields(self)))


@dataclass(frozen=True)
class Coordinate:
    """A generalized coordinate q_j: what moves one joint, or several together."""

    #: q_j as closed forms write it; by default q_j(t) of ``moro.abc``
    variable: Any = None
    #: (lower, upper) [rad or m]; None where none are given
    limits: tuple[Scalar, Scalar] | None = None
    drive: Drive = Drive()
    #: "" where it has none: of the joint, as a rule
    name: str = ""


#: of a joint that coordinate i moves alone, joint i
OWN: tuple[tuple[int, Scalar], ...] = ((-1, 1),)


@dataclass(frozen=True)
class Joint:
    """Joint i: placed in the frame of its parent joint, then moved about or along its own z axis.

    It moves by x_i = sum_j A_ij q_j + ``offset`` [rad or m]. ``parent`` is the 0-based index of the
    parent joint, -1 for the base, and less than i.
    """

    type: JointType
    parent: int
    placement: Placement
    offset: Scalar = 0
    #: (j, A_ij) of the coordinates that move it, A_ij constant and not 0; by default (i, 1)
    terms: tuple[tuple[int, Scalar], ...] = OWN
    #: "" where it has none
    name: str = ""


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
    #: by default as many as the joints need: one for each joint, where none says otherwise
    coordinates: tuple[Coordinate, ...] = ()
    #: the symbols among the scalars, in the order in which kernels take them
    parameters: tuple[Parameter, ...] = ()
    #: what was not set and is zero here: "masses", "rotor_inertias", ...
    not_set: frozenset[str] = frozenset()
    #: "dh" or "mdh" where the frames are those of a table of such rows
    convention: str = ""

    def __post_init__(self) -> None:
        joints = tuple(
            replace(joint, terms=((i, 1),)) if joint.terms == OWN else joint
            for i, joint in enumerate(self.joints)
        )
        count = 1 + max((j for joint in joints for j, _ in joint.terms), default=-1)
        object.__setattr__(self, "joints", joints)
        object.__setattr__(self, "coordinates", self.coordinates or (Coordinate(),) * count)

    @property
    def dof(self) -> int:
        """Degrees of freedom: the number of coordinates, n."""
        return len(self.coordinates)

    @property
    def nv(self) -> int:
        """Number of generalized velocities, and of torques."""
        return self.dof

    @property
    def nq(self) -> int:
        """Number of generalized coordinates."""
        return self.nv

    @property
    def qs(self) -> list[Any]:
        """The coordinates as closed forms write them."""
        from moro.abc import joint_variable  # SymPy, which help does without

        return [
            joint_variable(j) if x.variable is None else x.variable
            for j, x in enumerate(self.coordinates, 1)
        ]

    @property
    def types(self) -> list[JointType]:
        """Of each coordinate, the type of the first joint that it moves: angle or length."""
        first: dict[int, JointType] = {}
        for joint in self.joints:
            for j, _ in joint.terms:
                first.setdefault(j, joint.type)
        return [first[j] for j in range(self.nv)]

    @property
    def ranges(self) -> list[tuple[Scalar, Scalar]]:
        """The limits of each coordinate, or those that are assumed for its type."""
        return [
            kind.assumed_limits if x.limits is None else x.limits
            for x, kind in zip(self.coordinates, self.types, strict=True)
        ]

    @property
    def is_coupled(self) -> bool:
        """Whether the joints are anything but the coordinates in their order."""
        own = (((i, 1),) for i in range(len(self.joints)))
        return [joint.terms for joint in self.joints] != list(own)

    @property
    def defaults(self) -> dict[Any, Any]:
        """The parameters' symbols and their defaults."""
        return {parameter.symbol: parameter.default for parameter in self.parameters}

    @property
    def tip(self) -> Frame:
        """The last frame."""
        return self.frames[-1] if self.frames else Frame("tip", len(self.joints) - 1, Placement())

    def ancestors(self, i: int) -> Iterator[int]:
        """Yield the joints that carry joint i, from its parent to the base."""
        while (i := self.joints[i].parent) >= 0:
            yield i

    def displacement(self, joint: Joint) -> Any:
        """Return x of a joint in the variables of closed forms, A q + b."""
        return sum((ratio * self.qs[j] for j, ratio in joint.terms), joint.offset)

    def moving(self, i: int) -> list[int]:
        """Return the coordinates that move link i, in order."""
        carrying = (self.joints[k] for k in (i, *self.ancestors(i)))
        return sorted({j for joint in carrying for j, _ in joint.terms})

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
                terms=tuple((k, convert(ratio)) for k, ratio in j.terms),
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
            coordinates=tuple(replace(x, drive=x.drive.map(convert)) for x in self.coordinates),
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
