"""Accelerations that torques cause."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.articulated_body import joint_accelerations
from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.singular import check_resisted, singular
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Node


def accelerations(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    """Return qdd. Raise ValueError where nothing resists some motion of the joints."""
    still, rotors = [0] * system.model.nv, system.rotors
    check_resisted(system.model, rotors)
    left = [x - y for x, y in zip(tau, system.drives(q, qd, still), strict=True)]

    def by_articulated_bodies(arm: Posture) -> Sequence[Scalar]:
        return joint_accelerations(arm, rotors, qd, left)

    def by_factorization(arm: Posture) -> Sequence[Scalar]:
        bias = joint_torques(arm, qd, still)
        factors = factorized(joint_inertia(arm, rotors), arm)
        return solution(factors, [x - y for x, y in zip(left, bias, strict=True)])

    arm = system.posture(q)
    algorithms = (by_articulated_bodies, by_factorization)
    try:
        return [system.dynamics(arm, *(algorithms if _one_to_one(arm) else algorithms[1:]))]
    except ZeroDivisionError:  # whatever the run-time parameters are
        raise singular(system.model) from None


def _one_to_one(arm: Posture) -> bool:
    """Return whether each coordinate moves one joint of its own, by 1 or -1."""
    ratios = [ratio for link in arm.links for _, ratio in link.terms]
    return len(ratios) == len(arm.links) == arm.nv and all(
        ratio.op == "const" and abs(ratio.value) == 1 for ratio in ratios
    )


FUNCTIONS = (
    Function(
        "forward_dynamics",
        (Q, QD, TAU),
        (QDD,),
        "Forward dynamics: the accelerations that joint torques cause, the inverse of tau.",
        accelerations,
        "articulated bodies, or M = L D L^T, whichever costs fewer operations",
    ),
)
