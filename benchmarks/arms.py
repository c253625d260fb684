"""The arms that are measured, as robots for moro and as plain numbers for everybody else."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

import moro
from moro import Model, Robot
from moro.abc import joint_variable
from moro.model import REVOLUTE

Array = NDArray[np.float64]

#: samples of a batch, and states that every measurement cycles through
STATES = 4096

PACKAGED = ("two_link", "stanford_arm", "puma560", "ur5", "panda")
SEVEN_AXIS = Path(__file__).parent / "seven_axis.yaml"


@dataclass(frozen=True)
class Chain:
    """A serial arm in numbers: joint i is placed at (R, p) in joint i - 1, then moves along z."""

    revolute: tuple[bool, ...]
    R: Array
    p: Array
    mass: Array
    #: centres of mass and tensors about them, in the axes of the joints' frames
    com: Array
    inertia: Array
    gravity: Array

    @property
    def dof(self) -> int:
        """Number of joints."""
        return len(self.revolute)

    @classmethod
    def of(cls, model: Model) -> Chain:
        """Return the numbers of a model that has no run-time parameters.

        Computed exactly and rounded last: what is 0 or 1 stays so, which spares others work.
        """
        if any(joint.parent != i - 1 for i, joint in enumerate(model.joints)):
            raise ValueError(f"{model.name} is a tree; the peers get serial arms")
        revolute = [joint.type == REVOLUTE for joint in model.joints]
        R, p = [], []
        for joint, turns in zip(model.joints, revolute, strict=True):
            axes, origin = sp.Matrix(joint.placement.R), sp.Matrix(joint.placement.p)
            R.append(axes * sp.rot_axis3(-joint.offset) if turns else axes)
            p.append(origin if turns else origin + axes[:, 2] * joint.offset)
        coms, tensors = [], []
        for body in model.bodies:
            com = sp.Matrix(body.first_moment) / (body.mass or 1)
            coms.append(com)
            of_point = body.mass * (com.dot(com) * sp.eye(3) - com * com.T)
            tensors.append(sp.Matrix(body.inertia) - of_point)
        return cls(
            tuple(revolute),
            _floats(R).reshape(-1, 3, 3),
            _floats(p).reshape(-1, 3),
            _floats([body.mass for body in model.bodies]),
            _floats(coms).reshape(-1, 3),
            _floats(tensors).reshape(-1, 3, 3),
            _floats(model.gravity),
        )


@dataclass(frozen=True)
class Arm:
    """An arm of rigid bodies: what rotor inertia and friction add is the same for everybody."""

    label: str
    robot: Robot

    @property
    def dof(self) -> int:
        """Number of joints."""
        return self.robot.dof

    @cached_property
    def chain(self) -> Chain:
        """The arm in numbers."""
        return Chain.of(self.robot.model())

    @cached_property
    def states(self) -> dict[str, Array]:
        """Random states inside the joint limits, one row each, always the same."""
        rng = np.random.default_rng(7)
        low, high = np.array(self.robot.joint_limits, dtype=float).T
        q = rng.uniform(np.maximum(low, -np.pi), np.minimum(high, np.pi), (STATES, self.dof))
        qd, qdd, tau = rng.standard_normal((3, STATES, self.dof))
        return {"q": q, "qd": qd, "qdd": qdd, "tau": 10 * tau}


def measured() -> Iterator[Arm]:
    """Yield the packaged arms and the synthetic one with full tensors."""
    for name in PACKAGED:
        yield Arm(name, rigid(moro.load(name)))
    yield Arm("seven_axis", rigid(moro.load(SEVEN_AXIS)))


def rigid(robot: Robot) -> Robot:
    """Return the robot without rotor inertia and friction."""
    robot.rotor_inertias = robot.viscous_friction = robot.coulomb_friction = None
    return robot


def chain(n: int) -> Arm:
    """Return a synthetic arm of n revolute joints that alternate, with full tensors everywhere."""
    numbers = itertools.cycle(sp.Rational(k, 100) for k in (13, -7, 21, 5, -11, 17, 3))
    rows = [
        (next(numbers), sp.pi / 2 * (-1) ** i, next(numbers), joint_variable(i + 1))
        for i in range(n)
    ]
    robot = Robot(*rows, convention="mdh", name=f"chain{n}")
    robot.masses = [2 + next(numbers) for _ in range(n)]
    robot.cm_positions = [[next(numbers) for _ in range(3)] for _ in range(n)]
    robot.inertia_tensors = [_tensor([next(numbers) / 10 for _ in range(6)]) for _ in range(n)]
    robot.gravity = [0, 0, sp.Rational("-9.81")]
    return Arm(robot.name, robot)


def _tensor(x: list[sp.Rational]) -> sp.Matrix:
    """Return a tensor of inertia with these deviations from that of a ball."""
    ball = sp.Rational(3, 10)
    return sp.Matrix(
        [[ball + x[0], x[3], x[4]], [x[3], ball + x[1], x[5]], [x[4], x[5], ball + x[2]]]
    )


def _floats(values: Iterable[Any]) -> Array:
    """Return the floats nearest to exact numbers."""
    return np.array([sp.matrix2numpy(sp.Matrix([x]), float).ravel() for x in values]).squeeze()
