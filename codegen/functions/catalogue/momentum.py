"""Generalized momentum, and what observers of disturbances integrate."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.gravity import gravity_torques
from moro.algorithms.momentum import joint_momentum, transposed_coriolis_product
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, Argument, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Node


def _momentum(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    return [system.dynamics(system.posture(q), lambda arm: joint_momentum(arm, rotors, qd))]


def _momentum_bias(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    still = [0] * system.model.nv

    def rigid(arm: Posture) -> Sequence[Scalar]:
        gravity = gravity_torques(arm)
        return [x - g for x, g in zip(transposed_coriolis_product(arm, qd), gravity, strict=True)]

    changes = system.dynamics(system.posture(q), rigid)
    return [[x - y for x, y in zip(changes, system.drives(q, qd, still), strict=True)]]


FUNCTIONS = (
    Function(
        "momentum",
        (Q, QD),
        (Argument("p", ("n",), "N m s or N s", "generalized momentum"),),
        "Generalized momentum p = M(q) qd, with that of the rotors.",
        _momentum,
        "momenta of composite bodies, from the tips to the base",
    ),
    Function(
        "momentum_bias",
        (Q, QD),
        (Argument("momentum_bias", ("n",), "N m or N", "dp/dt - tau"),),
        "What changes the momentum besides torques, dp/dt - tau = C(q, qd)^T qd - G(q) - friction: "
        "for observers of disturbances (De Luca).",
        _momentum_bias,
        "momenta of composite bodies for C^T qd, first moments for G",
    ),
)
