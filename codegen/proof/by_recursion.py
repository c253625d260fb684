"""The recursions, evaluated: what a kernel's results must be that were made from closed forms.

The algorithms of ``moro.algorithms`` over arrays: composite bodies for M, the recursion of the
Christoffel symbols for C, Newton-Euler at rest for G. They share nothing with closed forms but the
model: neither the geometry nor a formula, and no node of a graph.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coordinates import displacements
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.drives import spring_energy, spring_torques
from moro.algorithms.energies import energy_of_position
from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture, posture, with_frame
from moro.checks.frame_called import frame_called
from moro.model import Frame, Model
from moro_codegen.proof.expected import ExpectedDynamics, evaluated
from moro_codegen.proof.symbolic_route import Array


def recursively(x: ExpectedDynamics) -> RecursiveDynamics:
    """Return the recursions at the same states, for the same inputs."""
    return RecursiveDynamics(
        x.route, x.q, x.qd, x.qdd, x.parameters, x.rounding, x.others, x.everywhere
    )


class RecursiveDynamics(ExpectedDynamics):
    """Every quantity of the dynamics at given states by recursion."""

    @cached_property
    def _numbers(self) -> Model:
        """The model in numbers."""
        scalars: dict[Any, None] = {}
        self.model.map(lambda x: scalars.setdefault(sp.sympify(x)))
        (values,) = evaluated(scalars, self.parameters, 1)
        known = dict(zip(scalars, values.tolist(), strict=True))
        return self.model.map(lambda x: known[sp.sympify(x)])

    @cached_property
    def _arm(self) -> Posture:
        q = list(self.q.T)
        angles = displacements(self._numbers, q)
        return posture(self._numbers, q, [(np.sin(x), np.cos(x)) for x in angles])

    @cached_property
    def _matrices(self) -> tuple[Array, Array, Array]:
        """M, C and G."""
        still, qd = [0] * self.model.nv, list(self.qd.T)
        rotors = [x.drive.rotor_inertia for x in self._numbers.coordinates]
        M, C = joint_inertia(self._arm, rotors), joint_coriolis(self._arm, qd)
        G = joint_torques(self._arm, still, still)
        springs = spring_torques(self._numbers, list(self.q.T))
        total = self._vector(x + y for x, y in zip(G, springs, strict=True))
        return self._matrix(M), self._matrix(C), total

    @cached_property
    def P(self) -> Array:
        """The potential energy, with that of springs."""
        springs = spring_energy(self._numbers, list(self.q.T))
        energy: Array = self._vector([energy_of_position(self._arm) + springs])[:, 0]
        return energy

    def T(self, frame: Frame) -> Array:
        """Return the pose of a frame in frame 0, (states, 4, 4)."""
        pose = poses(self._ending_at(frame))[-1]
        rows = [(*row, x) for row, x in zip(pose.R, pose.p, strict=True)]
        return self._matrix([*rows, (0, 0, 0, 1)])

    def J(self, frame: Frame) -> Array:
        """Return the Jacobian of a frame, (states, 6, n), linear rows first."""
        return self._matrix(frame_jacobian(self._ending_at(frame)))

    def _ending_at(self, frame: Frame) -> Posture:
        """Return the arm with a frame of the model as its last link."""
        numbers = self._numbers
        found = numbers.tip if frame == self.model.tip else frame_called(numbers, frame.name)
        return with_frame(self._arm, found.link, found.placement)

    def _vector(self, entries: Iterable[Any]) -> Array:
        """Return entries, numbers or arrays over the states, as an array with states first."""
        columns = [np.broadcast_to(x, len(self.q)) for x in entries]
        return np.stack(columns, axis=1).astype(float)

    def _matrix(self, rows: Iterable[Iterable[Any]]) -> Array:
        return np.stack([self._vector(row) for row in rows], axis=1)
