"""The matrices of the equations of motion."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.factorization import factorized, inverse
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, Argument, C, M, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.singular import check_resisted
from moro_codegen.functions.system import System, flat
from moro_codegen.graph.derivatives import directional
from moro_codegen.graph.nodes import Node


def _inertia_matrix(system: System, q: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    closed = system.closed_form("inertia_matrix", q)
    return [
        system.dynamics(
            system.posture(q), lambda arm: flat(joint_inertia(arm, rotors)), closed_form=closed
        )
    ]


def _coriolis_matrix(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    closed = system.closed_form("coriolis_matrix", q, qd)
    return [
        system.dynamics(
            system.posture(q), lambda arm: flat(joint_coriolis(arm, qd)), closed_form=closed
        )
    ]


def _inertia_matrix_rate(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    velocity = dict(zip(q, qd, strict=True))

    def by_coriolis(arm: Posture) -> Sequence[Scalar]:
        C = joint_coriolis(arm, qd)
        return [x + C[j][i] for i, row in enumerate(C) for j, x in enumerate(row)]

    def by_differentiation(arm: Posture) -> Sequence[Scalar]:
        return directional(system.nodes(flat(joint_inertia(arm, system.rotors))), velocity)

    return [system.dynamics(system.posture(q), by_coriolis, by_differentiation)]


def _inertia_matrix_inverse(system: System, q: Sequence[Node]) -> Outputs:
    check_resisted(system.model, system.rotors)

    def inverted(arm: Posture) -> Sequence[Scalar]:
        return flat(inverse(factorized(joint_inertia(arm, system.rotors), arm)))

    return [system.dynamics(system.posture(q), inverted)]


FUNCTIONS = (
    Function(
        "inertia_matrix",
        (Q,),
        (M,),
        "Inertia matrix M(q), rotor inertias on its diagonal.",
        _inertia_matrix,
        "composite rigid bodies; or the closed form",
    ),
    Function(
        "coriolis_matrix",
        (Q, QD),
        (C,),
        "Coriolis matrix C(q, qd) of the Christoffel symbols: dM/dt - 2 C is skew-symmetric.",
        _coriolis_matrix,
        "recursion over composite bodies, of the Christoffel symbols; or the closed form",
    ),
    Function(
        "inertia_matrix_rate",
        (Q, QD),
        (Argument("dM_dt", ("n", "n"), "SI", "rate of the inertia matrix, symmetric"),),
        "Rate of the inertia matrix, dM/dt = C + C^T.",
        _inertia_matrix_rate,
        "C + C^T, or the graph of M differentiated, whichever costs fewer operations",
    ),
    Function(
        "inertia_matrix_inverse",
        (Q,),
        (Argument("M_inverse", ("n", "n"), "1/(kg m^2) to 1/kg", "1/M, symmetric"),),
        "Inverse of the inertia matrix; not finite where M is singular.",
        _inertia_matrix_inverse,
        "M = L^T D L, solved for the columns of 1",
    ),
)
