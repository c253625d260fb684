"""The Robotics Toolbox for Python: its recursive Newton-Euler, which is in C."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata

import numpy as np
import roboticstoolbox as rtb

from benchmarks.arms import Arm
from benchmarks.native import Loop
from benchmarks.tasks import Call, Task

NAME = "Robotics Toolbox"

VERSIONS = {"roboticstoolbox-python": metadata.version("roboticstoolbox-python")}


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield nothing: its C code has no interface of its own."""
    return
    yield


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield rne of an arm made from the same DH rows."""
    robot, links = arm.robot, []
    constant = dict.fromkeys(robot.qs, 0)
    modified = robot.convention == "mdh"
    for i, row in enumerate(robot.dh_parameters):
        a, alpha, d, theta = (float(x.subs(constant)) for x in row[:4])
        body = {
            "m": float(robot.masses[i]),
            "r": np.array(robot.cm_positions[i], dtype=float).ravel(),
            "I": np.array(robot.inertia_tensors[i], dtype=float),
            # the drive
            "Jm": 0.0,
            "G": 1.0,
            "B": 0.0,
            "Tc": [0.0, 0.0],
        }
        if robot.joint_types[i] == "r":
            links.append(
                (rtb.RevoluteMDH if modified else rtb.RevoluteDH)(
                    a=a, alpha=alpha, d=d, offset=theta, **body
                )
            )
        else:
            links.append(
                (rtb.PrismaticMDH if modified else rtb.PrismaticDH)(
                    a=a, alpha=alpha, theta=theta, offset=d, **body
                )
            )
    gravity = np.array(robot.gravity, dtype=float).ravel()
    made = rtb.DHRobot(links, name=arm.label, gravity=gravity)
    yield Call(NAME, made.rne)
