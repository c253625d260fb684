"""Torques for a motion: tau and what it is the sum of."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.drives import spring_torques
from moro.algorithms.external_wrench import joint_torques_in_contact
from moro.algorithms.gravity import gravity_torques
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.algorithms.reference_motion import coriolis_product, reference_torques
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import (
    LAST,
    QD,
    QD_R,
    QDD,
    QDD_R,
    TAU,
    WRENCH,
    Argument,
    G,
    Q,
    V,
)
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, sum_of
from moro_codegen.graph.nodes import Node


def _tau(system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]) -> Outputs:
    closed = system.closed_form("tau", q, qd, qdd)
    tau = system.dynamics(
        system.posture(q), lambda arm: joint_torques(arm, qd, qdd), closed_form=closed
    )
    return [sum_of(tau, system.drives(q, qd, qdd))]


def _tau_with_wrench(
    system: System,
    q: Sequence[Node],
    qd: Sequence[Node],
    qdd: Sequence[Node],
    wrench: Sequence[Node],
) -> Outputs:
    def rigid(arm: Posture) -> Sequence[Scalar]:
        return joint_torques_in_contact(arm, qd, qdd, wrench)

    tau = system.dynamics(system.with_tip(q), rigid)
    return [sum_of(tau, system.drives(q, qd, qdd))]


def _bias(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    still = [0] * system.model.nv
    closed = system.closed_form("bias", q, qd)
    bias = system.dynamics(
        system.posture(q), lambda arm: joint_torques(arm, qd, still), closed_form=closed
    )
    return [sum_of(bias, system.drives(q, qd, still))]


def _gravity_vector(system: System, q: Sequence[Node]) -> Outputs:
    still = [0] * system.model.nv
    closed = system.closed_form("gravity_vector", q)
    gravity = system.dynamics(
        system.posture(q),
        gravity_torques,
        lambda arm: joint_torques(arm, still, still),
        closed_form=closed,
    )
    return [sum_of(gravity, spring_torques(system.model, q))]


def _tau_passivity(
    system: System,
    q: Sequence[Node],
    qd: Sequence[Node],
    qd_r: Sequence[Node],
    qdd_r: Sequence[Node],
) -> Outputs:
    def rigid(arm: Posture) -> Sequence[Scalar]:
        return reference_torques(arm, qd, qd_r, qdd_r)

    tau = system.dynamics(system.posture(q), rigid)
    return [sum_of(tau, system.drives(q, qd, qdd_r))]


def _bias_product(
    system: System, q: Sequence[Node], qd: Sequence[Node], v: Sequence[Node]
) -> Outputs:
    return [system.dynamics(system.posture(q), lambda arm: coriolis_product(arm, qd, v))]


FUNCTIONS = (
    Function(
        "tau",
        (Q, QD, QDD),
        (TAU,),
        "Inverse dynamics: M(q) qdd + C(q, qd) qd + G(q), with rotor inertia and friction.",
        _tau,
        "recursive Newton-Euler; or the closed form",
    ),
    Function(
        "tau_with_wrench",
        (Q, QD, QDD, WRENCH),
        (TAU,),
        "Inverse dynamics against a wrench w that the environment exerts on the link of "
        f"{LAST}: M(q) qdd + C(q, qd) qd + G(q) - J(q)^T w, with rotor inertia and friction.",
        _tau_with_wrench,
        f"recursive Newton-Euler, with the wrench on a further link at {LAST}",
        frame="",
    ),
    Function(
        "bias",
        (Q, QD),
        (Argument("bias", ("n",), "N m or N", "torques (forces) for zero acceleration"),),
        "What tau is without joint accelerations: C(q, qd) qd + G(q), with friction.",
        _bias,
        "recursive Newton-Euler for qdd = 0; or the closed form",
    ),
    Function(
        "gravity_vector",
        (Q,),
        (G,),
        "Gravity vector G(q), the gradient of P.",
        _gravity_vector,
        "first moments of what each joint carries; Newton-Euler at rest; or the closed form",
    ),
    Function(
        "tau_passivity",
        (Q, QD, QD_R, QDD_R),
        (TAU,),
        "Torques of passivity-based control (Slotine & Li): M(q) qdd_r + C(q, qd) qd_r + G(q) with "
        "the C of coriolis_matrix, rotor inertia and the friction of qd; tau for qd_r = qd.",
        _tau_passivity,
        "recursive Newton-Euler, with the reference velocity's rate for acceleration",
    ),
    Function(
        "bias_product",
        (Q, QD, V),
        (Argument("Cv", ("n",), "SI", "C(q, qd) v"),),
        "Coriolis matrix of coriolis_matrix times any vector: C(q, qd) v.",
        _bias_product,
        "recursive Newton-Euler, with the reference velocity's rate for acceleration",
    ),
)
