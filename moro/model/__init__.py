"""The model: the one meeting point of readers and algorithms.

joint_types   what a joint does to a posture, a velocity, a wrench: one class a type
placement     constant poses, as the elementary motions that they are given by
model         joints, bodies, coordinates and their drives, frames
"""

from moro.model.joint_types import (
    JOINT_TYPES,
    PRISMATIC,
    REVOLUTE,
    ROTOR,
    JointType,
    Prismatic,
    Revolute,
    Rotor,
)
from moro.model.model import (
    Body,
    Central,
    Coordinate,
    Drive,
    Frame,
    Joint,
    Model,
    Parameter,
    as_model,
)
from moro.model.placement import Placement, Rotation, Shift, Turn

__all__ = [
    "JOINT_TYPES",
    "PRISMATIC",
    "REVOLUTE",
    "ROTOR",
    "Body",
    "Central",
    "Coordinate",
    "Drive",
    "Frame",
    "Joint",
    "JointType",
    "Model",
    "Parameter",
    "Placement",
    "Prismatic",
    "Revolute",
    "Rotation",
    "Rotor",
    "Shift",
    "Turn",
    "as_model",
]
