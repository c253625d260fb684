"""First derivatives of inverse and forward dynamics."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, M, Q
from moro_codegen.functions.catalogue.forward_dynamics import accelerations
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat, sum_of
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

    return _thirds(system.dynamics(system.posture(q), derivatives))


def _forward_dynamics_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    (caused,) = accelerations(system, q, qd, tau)
    qdd = [system.graph.input("qdd", k) for k in range(len(q))]

    def derivatives(arm: Posture) -> Sequence[Scalar]:
        """M dqdd = dtau - (dtau/dq) dq - (dtau/dqd) dqd, for the qdd that tau causes."""
        n, factors = len(q), factorized(joint_inertia(arm, system.rotors), arm)
        by_q, by_qd = _slopes(system, arm, q, qd, qdd)
        by_tau = [system.graph.constant(int(i == j)) for i in range(n) for j in range(n)]
        slopes = []
        for block in ([-x for x in by_q], [-x for x in by_qd], by_tau):
            columns = [solution(factors, block[j::n]) for j in range(n)]
            slopes += [system.graph.constant(x) for row in zip(*columns, strict=True) for x in row]
        return replaced(slopes, dict(zip(qdd, caused, strict=True)))

    return _thirds(system.dynamics(system.posture(q), derivatives))


def _slopes(
    system: System, arm: Posture, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> tuple[list[Node], list[Node]]:
    """Return d tau/dq and d tau/dqd, flat."""
    tau = sum_of(joint_torques(arm, qd, qdd), system.drives(q, qd, qdd))
    nodes = [system.graph.constant(x) for x in tau]
    return flat(jacobian(nodes, q)), flat(jacobian(nodes, qd))


def _thirds(entries: Sequence[Node]) -> Outputs:
    third = len(entries) // 3
    return [entries[k * third : (k + 1) * third] for k in range(3)]


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
