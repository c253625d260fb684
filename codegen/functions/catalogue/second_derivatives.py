"""Second derivatives of inverse and forward dynamics: as tensors, and of a weighted sum.

tau is linear in qdd and, but for friction, quadratic in qd, so these are all there are.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, inverse, solution
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, Q
from moro_codegen.functions.catalogue.derivatives import Slopes, each
from moro_codegen.functions.catalogue.products import W, caused_by, torques
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, dot, flat, parts
from moro_codegen.graph.derivatives import gradient, jacobian
from moro_codegen.graph.nodes import Node, replaced

Nodes = Sequence[Node]


def _tau_second_derivatives(system: System, q: Nodes, qd: Nodes, qdd: Nodes) -> Outputs:
    n = len(q)

    def derivatives(slopes: Slopes, arm: Posture) -> Sequence[Scalar]:
        by_q, by_qd = slopes(system, arm, q, qd, qdd)
        M = system.nodes(flat(joint_inertia(arm, system.rotors)))
        by_q_q, by_qd_q, by_qd_qd = (
            [parts(x, n) for x in parts(flat(jacobian(*block)), n)]
            for block in ((by_q, q), (by_qd, q), (by_qd, qd))
        )
        return [
            *flat(flat(map(_symmetric, by_q_q))),
            *flat(flat(map(_columns, by_qd_q))),
            *flat(flat(map(_symmetric, by_qd_qd))),
            *flat(jacobian(M, q)),
        ]

    return parts(system.dynamics(system.posture(q), *each(derivatives)), 4)


def _tau_hessian(system: System, q: Nodes, qd: Nodes, qdd: Nodes, w: Nodes) -> Outputs:
    def hessian(arm: Posture) -> Sequence[Scalar]:
        return flat(_hessian(system, arm, q, qd, qdd, w))

    return parts(system.dynamics(system.posture(q), hessian), 4)


def _forward_dynamics_hessian(system: System, q: Nodes, qd: Nodes, tau: Nodes, w: Nodes) -> Outputs:
    n, graph = len(q), system.graph
    caused, qdd = caused_by(system, q, qd, tau)
    weights = [graph.input("weights", k) for k in range(n)]

    def hessian(arm: Posture) -> Sequence[Scalar]:
        """Differentiate tau(q, qd, qdd(q, qd, tau)) = tau twice, with lambda = M^-1 w.

        w^T qdd_xy = -lambda^T (tau_xy + tau_xqdd qdd_y + (tau_yqdd qdd_x)^T), where tau_xqdd is
        dM/dq for x = q and zero for qd.
        """
        factors = factorized(joint_inertia(arm, system.rotors), arm)
        lamda = system.nodes(solution(factors, w))
        first = torques(system, arm, q, qd, qdd)
        qdd_q, qdd_qd = (
            [solution(factors, [-x for x in column]) for column in _columns(jacobian(first, x))]
            for x in (q, qd)
        )
        qdd_tau = inverse(factors)
        qq, qqd, qdqd, N = (parts(x, n) for x in _hessian(system, arm, q, qd, qdd, weights))
        through = [[dot(row, column) for column in qdd_q] for row in N]
        blocks = (
            [-(qq[i][j] + through[i][j] + through[j][i]) for i in range(n) for j in range(n)],
            [-(qqd[i][j] + dot(N[i], qdd_qd[j])) for i in range(n) for j in range(n)],
            [-x for x in flat(qdqd)],
            [-dot(N[i], qdd_tau[j]) for i in range(n) for j in range(n)],
        )
        known = {**dict(zip(weights, lamda, strict=True)), **caused}
        return replaced(system.nodes(flat(blocks)), known)

    return parts(system.dynamics(system.posture(q), hessian), 4)


def _hessian(
    system: System, arm: Posture, q: Nodes, qd: Nodes, qdd: Nodes, w: Nodes
) -> tuple[list[Node], ...]:
    """Return the second derivatives of w^T tau by (q, q), (q, qd), (qd, qd), (q, qdd), flat."""
    slopes = gradient(torques(system, arm, q, qd, qdd), w, [*q, *qd, *qdd])
    n = len(q)
    by_q, by_qd = slopes[:n], slopes[n : 2 * n]
    q_q, q_qd, qd_qd, q_qdd = (
        jacobian(*block) for block in ((by_q, q), (by_q, qd), (by_qd, qd), (by_q, qdd))
    )
    return flat(_symmetric(q_q)), flat(q_qd), flat(_symmetric(qd_qd)), flat(q_qdd)


def _symmetric(rows: Sequence[Nodes]) -> list[list[Node]]:
    """Return a matrix that is symmetric by its upper half: the lower one need not be computed."""
    n = range(len(rows))
    return [[rows[min(i, j)][max(i, j)] for j in n] for i in n]


def _columns(rows: Sequence[Nodes]) -> list[list[Node]]:
    return [list(column) for column in zip(*rows, strict=True)]


def _tensor(name: str, what: str) -> Argument:
    return Argument(name, ("n", "n", "n"), "SI", what)


def _block(name: str, what: str) -> Argument:
    return Argument(name, ("n", "n"), "SI", what)


FUNCTIONS = (
    Function(
        "tau_second_derivatives",
        (Q, QD, QDD),
        (
            _tensor("d2tau_dq_dq", "d^2 tau_i/(d q_j d q_k)"),
            _tensor("d2tau_dq_dqd", "d^2 tau_i/(d q_j d qd_k)"),
            _tensor("d2tau_dqd_dqd", "d^2 tau_i/(d qd_j d qd_k)"),
            _tensor("dM_dq", "d M_ij/d q_k, that is d^2 tau_i/(d qdd_j d q_k)"),
        ),
        "Second derivatives of tau: all that are not zero.",
        _tau_second_derivatives,
        "the graph of tau differentiated twice, by qd once 2 C; that of M once",
    ),
    Function(
        "tau_hessian",
        (Q, QD, QDD, W),
        (
            _block("H_q_q", "d^2 (w^T tau)/(d q_i d q_j)"),
            _block("H_q_qd", "d^2 (w^T tau)/(d q_i d qd_j)"),
            _block("H_qd_qd", "d^2 (w^T tau)/(d qd_i d qd_j)"),
            _block("H_q_qdd", "d^2 (w^T tau)/(d q_i d qdd_j)"),
        ),
        "Second derivatives of w^T tau: tau_second_derivatives contracted with weights.",
        _tau_hessian,
        "the graph of tau differentiated backwards, then forwards",
    ),
    Function(
        "forward_dynamics_hessian",
        (Q, QD, TAU, W),
        (
            _block("H_q_q", "d^2 (w^T qdd)/(d q_i d q_j)"),
            _block("H_q_qd", "d^2 (w^T qdd)/(d q_i d qd_j)"),
            _block("H_qd_qd", "d^2 (w^T qdd)/(d qd_i d qd_j)"),
            _block("H_q_tau", "d^2 (w^T qdd)/(d q_i d tau_j)"),
        ),
        "Second derivatives of w^T qdd of forward_dynamics, all that are not zero: what DDP and "
        "iLQR contract with a gradient of the value function.",
        _forward_dynamics_hessian,
        "those of tau, contracted with M^-1 w, and the first derivatives of forward dynamics",
    ),
)
