"""Energies."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.drives import spring_energy
from moro.algorithms.energies import energy_of_motion, energy_of_position
from moro_codegen.functions.arguments import QD, Argument, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Node

K = Argument("K", (), "J", "kinetic energy")
P = Argument("P", (), "J", "potential energy, zero at the origin of frame 0")


def _kinetic_energy(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    rotors = system.rotors
    return [
        system.dynamics(
            system.posture(q),
            lambda arm: [energy_of_motion(arm, rotors, qd)],
            closed_form=system.closed_form("kinetic_energy", q, qd),
        )
    ]


def _potential_energy(system: System, q: Sequence[Node]) -> Outputs:
    closed = system.closed_form("potential_energy", q)
    (gravity,) = system.geometry(q, lambda arm: [energy_of_position(arm)], closed)
    return [[gravity + spring_energy(system.model, q)]]


FUNCTIONS = (
    Function(
        "kinetic_energy",
        (Q, QD),
        (K,),
        "Kinetic energy 1/2 qd^T M(q) qd, with that of the rotors.",
        _kinetic_energy,
        "velocities from the base to the tip; or the closed form",
    ),
    Function(
        "potential_energy",
        (Q,),
        (P,),
        "Potential energy P(q): minus the sum of m_i g . r_Ci.",
        _potential_energy,
        "heights of the centres of mass, from the tip to the base; or the closed form",
    ),
)
