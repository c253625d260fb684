"""The matrices of the equations of motion."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coriolis import joint_coriolis
from moro_codegen.functions.arguments import QD, C, M, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat
from moro_codegen.graph.nodes import Node


def _inertia_matrix(system: System, q: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    return [system.dynamics(system.posture(q), lambda arm: flat(joint_inertia(arm, rotors)))]


def _coriolis_matrix(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    return [system.dynamics(system.posture(q), lambda arm: flat(joint_coriolis(arm, qd)))]


FUNCTIONS = (
    Function(
        "inertia_matrix",
        (Q,),
        (M,),
        "Inertia matrix M(q), rotor inertias on its diagonal.",
        _inertia_matrix,
        "composite rigid bodies",
    ),
    Function(
        "coriolis_matrix",
        (Q, QD),
        (C,),
        "Coriolis matrix C(q, qd) of the Christoffel symbols: dM/dt - 2 C is skew-symmetric.",
        _coriolis_matrix,
        "recursion over composite bodies, of the Christoffel symbols",
    ),
)
