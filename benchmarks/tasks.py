"""What is asked of every contender: functions of the dynamics, with inputs and results in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Task:
    """A function: moro's name of it, its inputs, and how many numbers its results have."""

    name: str
    #: names of the states of an arm
    inputs: tuple[str, ...]
    #: "v" for n numbers, "m" for n x n, row-major
    outputs: str
    #: what Pinocchio calls it
    pinocchio: str

    def input_sizes(self, dof: int) -> list[int]:
        """Return how many numbers each input has."""
        return [dof] * len(self.inputs)

    def output_sizes(self, dof: int) -> list[int]:
        """Return how many numbers each result has."""
        return [dof if kind == "v" else dof * dof for kind in self.outputs]


TASKS = {
    task.name: task
    for task in (
        Task("tau", ("q", "qd", "qdd"), "v", "rnea"),
        Task("inertia_matrix", ("q",), "m", "crba"),
        Task("forward_dynamics", ("q", "qd", "tau"), "v", "aba"),
        Task("tau_derivatives", ("q", "qd", "qdd"), "mmm", "computeRNEADerivatives"),
        Task("bias", ("q", "qd"), "v", "nonLinearEffects"),
        Task("gravity_vector", ("q",), "v", "computeGeneralizedGravity"),
        Task("coriolis_matrix", ("q", "qd"), "m", "computeCoriolisMatrix"),
        Task("forward_dynamics_derivatives", ("q", "qd", "tau"), "mmm", "computeABADerivatives"),
    )
}


@dataclass(frozen=True)
class Call:
    """tau of one contender, for one arm, from Python."""

    contender: str
    function: Callable[..., Any]
    #: from arrays q, qd, qdd to what the function is called with, outside the measurement
    prepare: Callable[..., Sequence[Any]] = lambda *state: state
