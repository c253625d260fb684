"""What a robot file may say: one class for each mapping.

Which fields go together, ``fields.py`` says; how messages are put, ``problems.py``.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import Annotated, Any

import sympy
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from moro.formats.yaml import values
from moro.formats.yaml.document import MAX_ITEMS, List

MAX_LINKS = MAX_ITEMS


class Mapping(BaseModel):
    """A mapping of the file, with no other fields than those that are known."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class Pose(Mapping):
    """Where a frame is: the position, and the orientation by angles or as a matrix."""

    xyz: values.Shift | None = None
    rpy: values.Angles | None = None
    R: values.Rotation | None = None


class Placed(Pose):
    """A pose, or several one after the other, each in the frame that those before have made."""

    placement: tuple[Pose, ...] | None = None

    @property
    def poses(self) -> Sequence[Pose]:
        """All of them."""
        return self.placement or (self,)


class Body(Mapping):
    """What weighs something; its moments are about its centre of mass, or about the origin."""

    mass: values.NotNegative | None = Field(default=None, description="the mass, in kg")
    com: values.Position | None = Field(
        default=None,
        description="the centre of mass [x, y, z], in m, in the frame of the link",
    )
    first_moment: values.FirstMoment | None = None
    inertia: values.Tensor | None = Field(
        default=None,
        description="the inertia, in kg m^2, about the centre of mass, in the axes of the link's"
        " frame",
    )
    inertia_about: values.About = "com"


class PlacedBody(Body, Placed):
    """A further body on a link, in a frame of its own, which by default is the link's."""


class Friction(Mapping):
    """Friction of a joint, on either side of the gear."""

    viscous: values.NotNegative = sympy.Integer(0)
    #: for qd > 0 and for qd < 0, both as magnitudes
    coulomb: values.Coulomb = (sympy.Integer(0), sympy.Integer(0))
    #: what breaks away from rest, likewise (Stribeck)
    static: values.Coulomb | None = None
    stribeck_velocity: values.Positive | None = None
    #: the width of the step at rest
    smooth: values.Positive | None = None
    side: values.Side = "link"


class Driven(Mapping):
    """What is said of a coordinate: its limits, its drive, its name."""

    joint_name: values.Label | None = None
    limits: values.Range | None = None
    rotor_inertia: values.NotNegative | None = None
    motor_inertia: values.NotNegative | None = None
    gear_ratio: values.Positive | None = None
    friction: Friction | None = None
    stiffness: values.NotNegative | None = None
    rest: values.Angle | None = None


class Row(Mapping):
    """A joint, as a row of DH parameters."""

    joint: values.JointType = Field(description="`revolute` or `prismatic`")
    a: values.Number | None = Field(default=None, description="the length along x, in m")
    alpha: values.Angle | None = Field(default=None, description="the angle about x, in rad")
    d: values.Displacement | None = Field(
        default=None,
        description="the length along z, in m (prismatic: the offset added to q)",
    )
    theta: values.Displacement | None = Field(
        default=None,
        description="the angle about z, in rad (revolute: the offset added to q)",
    )


class Link(Driven, Body, Placed, Row):
    """A joint and the link that it moves: a row of DH parameters, or a placement; and bodies."""

    axis: values.Axis | None = None
    pitch: values.NotZero | None = Field(
        default=None, description="how far it slides while it turns once, in m"
    )
    name: values.Label | None = None
    parent: values.Reference | None = None
    bodies: tuple[PlacedBody, ...] | None = None
    frames: dict[values.LabelKey, Placed] = {}


class Tool(Placed):
    """The frame of a tool."""

    link: values.Reference | None = None


def _links_shape(node: object) -> List:
    if not isinstance(node, List):
        values.refuse(
            f"found {values.found(node)}; expected a list with one entry (`- joint: ...`) per joint"
        )
    if not node:
        values.refuse(f"no links; an arm has 1 to {MAX_LINKS}")
    return node


class RobotFile(Mapping):
    """A robot as its file describes it, in exact numbers and SymPy symbols."""

    name: values.Name = Field(description="a name for generated code")
    convention: values.Convention = "dh"
    gravity: values.Acceleration = (sympy.Integer(0), sympy.Integer(0), sympy.Rational("-9.81"))
    #: symbol: default value, None where the value is given at run time only
    parameters: dict[values.ParameterKey, values.Default] = {}
    base: Placed | None = None
    tool: Tool | None = None
    tip: values.Reference | None = None
    #: of those that no row has to itself
    coordinates: dict[values.CoordinateKey, Driven] = {}
    links: Annotated[tuple[Link, ...], BeforeValidator(_links_shape)] = Field(
        description="a list with one entry (`- joint: ...`) per joint"
    )


#: the fields of a placement
PLACEMENT = ("xyz", "rpy", "R", "placement", "axis")


def is_row(fields: Container[str], joint: str) -> bool:
    """Whether a link, with these fields, is given by a row of DH parameters."""
    if joint == "rotor" or any(name in fields for name in PLACEMENT):
        return False
    return joint != "fixed" or any(name in fields for name in ("a", "alpha", "d", "theta"))


def model_at(location: tuple[Any, ...]) -> type[BaseModel]:
    """Return the class of the mapping that the field at ``location`` is in."""
    within: dict[Any, type[BaseModel]] = {
        "links": Link,
        "friction": Friction,
        "bodies": PlacedBody,
        "frames": Placed,
        "placement": Pose,
        "base": Placed,
        "tool": Tool,
        "coordinates": Driven,
    }
    found: type[BaseModel] = RobotFile
    for step in location[:-1]:
        found = within.get(step, found)
    return found
