"""From what a robot file says to the description of an arm."""

from __future__ import annotations

from typing import Any

import sympy

from moro.abc import joint_variable
from moro.checks.plausibility import unremarked
from moro.formats.dh.description import Description
from moro.formats.yaml.schema import Friction, Link, RobotFile


def build(file: RobotFile) -> Description:
    """Return the arm that ``file`` describes. What the file leaves out is not set."""
    with unremarked():
        return _build(file)


def _build(file: RobotFile) -> Description:
    rows = [_row(link, joint_variable(i)) for i, link in enumerate(file.links, start=1)]
    arm = Description(*rows, convention=file.convention, name=file.name)
    links = file.links
    arm.gravity = file.gravity
    arm.declare(file.parameters)
    if links[0].mass is not None:  # one has it: all have mass, com and inertia
        arm.masses = [link.mass for link in links]
        arm.cm_positions = [link.com for link in links]
        arm.inertia_tensors = [link.inertia for link in links]
    if any(link.rotor_inertia is not None for link in links):
        arm.rotor_inertias = [link.rotor_inertia or sympy.Integer(0) for link in links]
    if any(link.friction is not None for link in links):
        friction = [link.friction or Friction() for link in links]
        arm.viscous_friction = [each.viscous for each in friction]
        arm.coulomb_friction = [each.coulomb for each in friction]
    if any(link.limits is not None for link in links):
        arm.joint_limits = [link.limits for link in links]
    return arm


def _row(link: Link, q: Any) -> tuple[Any, ...]:
    """Return the row of the DH table; the joint variable is added to theta or to d."""
    if link.joint == "revolute":
        return (link.a, link.alpha, link.d, q + link.theta, "r")
    return (link.a, link.alpha, q + link.d, link.theta, "p")
