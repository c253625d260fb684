"""First derivatives of inverse and forward dynamics."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, M, Q
from moro_codegen.functions.catalogue.products import caused_by, torques
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat, parts
from moro_codegen.graph.derivatives import jacobian
from moro_codegen.graph.nodes import Node, replaced

TAU_BY_Q = Argument("dtau_dq", ("n", "n"), "N m/rad to N/m", "d tau_i/d q_j")
TAU_BY_QD = Argument("dtau_dqd", ("n", "n"), "N m s/rad to N s/m", "d tau_i/d qd_j")
QDD_BY_Q = Argument("dqdd_dq", ("n", "n"), "1/s^2", "d qdd_i/d q_j")
QDD_BY_QD = Argument("dqdd_dqd", ("n", "n"), "1/s", "d qdd_i/d qd_j")
QDD_BY_TAU = Argument("dqdd_dtau", ("n", "n"), "1/(kg m^2) to 1/kg", "d qdd_i/d tau_j: 1/M")


def _tau_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> Outputs:
    def derivatives(arm: Posture) -> Sequence[Scalar]:
        return flat((*_slopes(system, arm, q, qd, qdd), flat(joint_inertia(arm, system.rotors))))

    return parts(system.dynamics(system.posture(q), derivatives), 3)


def _forward_dynamics_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    caused, qdd = caused_by(system, q, qd, tau)

    def derivatives(arm: Posture) -> Sequence[Scalar]:
        """M dqdd = dtau - (dtau/dq) dq - (dtau/dqd) dqd, for the qdd that tau causes."""
        n, factors = len(q), factorized(joint_inertia(arm, system.rotors), arm)
        by_q, by_qd = _slopes(system, arm, q, qd, qdd)
        by_tau = [system.graph.constant(int(i == j)) for i in range(n) for j in range(n)]
        slopes = []
        for block in ([-x for x in by_q], [-x for x in by_qd], by_tau):
            columns = [solution(factors, block[j::n]) for j in range(n)]
            slopes += [system.graph.constant(x) for row in zip(*columns, strict=True) for x in row]
        return replaced(slopes, caused)

    return parts(system.dynamics(system.posture(q), derivatives), 3)


def _slopes(
    system: System, arm: Posture, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> tuple[list[Node], list[Node]]:
    """Return d tau/dq and d tau/dqd, flat."""
    tau = torques(system, arm, q, qd, qdd)
    return flat(jacobian(tau, q)), flat(jacobian(tau, qd))


FUNCTIONS = (
    Function(
        "tau_derivatives",
        (Q, QD, QDD),
        (TAU_BY_Q, TAU_BY_QD, M),
        "Derivatives of tau with respect to q, qd and qdd (that is M); Coulomb friction, which "
        "jumps, has none.",
        _tau_derivatives,
        "the graph of tau differentiated; M by composite rigid bodies",
    ),
    Function(
        "forward_dynamics_derivatives",
        (Q, QD, TAU),
        (QDD_BY_Q, QDD_BY_QD, QDD_BY_TAU),
        "Derivatives of forward_dynamics with respect to q, qd and tau.",
        _forward_dynamics_derivatives,
        "M = L D L^T and the derivatives of tau",
    ),
)
