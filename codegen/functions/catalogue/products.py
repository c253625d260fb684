"""First derivatives of inverse and forward dynamics times a vector, from either side.

Along a direction they take a few times the operations of the function, and so do those of a
weighted sum (``graph.derivatives``), where the matrices take n times as many.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, Q
from moro_codegen.functions.catalogue.forward_dynamics import accelerations
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, parts, sum_of
from moro_codegen.graph.derivatives import directional, gradient
from moro_codegen.graph.nodes import Node, replaced

Nodes = Sequence[Node]


def _tau_jvp(
    system: System, q: Nodes, qd: Nodes, qdd: Nodes, dq: Nodes, dqd: Nodes, dqdd: Nodes
) -> Outputs:
    direction = _direction((q, qd, qdd), (dq, dqd, dqdd))

    def product(arm: Posture) -> Sequence[Scalar]:
        return directional(torques(system, arm, q, qd, qdd), direction)

    return [system.dynamics(system.posture(q), product)]


def _tau_vjp(system: System, q: Nodes, qd: Nodes, qdd: Nodes, w: Nodes) -> Outputs:
    def product(arm: Posture) -> Sequence[Scalar]:
        return gradient(torques(system, arm, q, qd, qdd), w, [*q, *qd, *qdd])

    return parts(system.dynamics(system.posture(q), product), 3)


def _forward_dynamics_jvp(
    system: System, q: Nodes, qd: Nodes, tau: Nodes, dq: Nodes, dqd: Nodes, dtau: Nodes
) -> Outputs:
    caused, qdd = caused_by(system, q, qd, tau)
    direction = _direction((q, qd), (dq, dqd))

    def product(arm: Posture) -> Sequence[Scalar]:
        """M dqdd = dtau - (dtau/dq) dq - (dtau/dqd) dqd, for the qdd that tau causes."""
        slopes = directional(torques(system, arm, q, qd, qdd), direction)
        factors = factorized(joint_inertia(arm, system.rotors), arm)
        found = solution(factors, [x - y for x, y in zip(dtau, slopes, strict=True)])
        return replaced(system.nodes(found), caused)

    return [system.dynamics(system.posture(q), product)]


def _forward_dynamics_vjp(system: System, q: Nodes, qd: Nodes, tau: Nodes, w: Nodes) -> Outputs:
    caused, qdd = caused_by(system, q, qd, tau)

    def product(arm: Posture) -> Sequence[Scalar]:
        """w^T dqdd = (M^-1 w)^T (dtau - (dtau/dq) dq - (dtau/dqd) dqd)."""
        factors = factorized(joint_inertia(arm, system.rotors), arm)
        felt = system.nodes(solution(factors, w))
        slopes = gradient(torques(system, arm, q, qd, qdd), felt, [*q, *qd])
        return replaced([*(-x for x in slopes), *felt], caused)

    return parts(system.dynamics(system.posture(q), product), 3)


def torques(system: System, arm: Posture, q: Nodes, qd: Nodes, qdd: Nodes) -> list[Node]:
    """Return tau of an arm in a posture, with the drives."""
    return system.nodes(sum_of(joint_torques(arm, qd, qdd), system.drives(q, qd, qdd)))


def caused_by(
    system: System, q: Nodes, qd: Nodes, tau: Nodes
) -> tuple[dict[Node, Node], list[Node]]:
    """Return accelerations that stand for those caused by tau, and these by them."""
    (found,) = accelerations(system, q, qd, tau)
    qdd = [system.graph.input("qdd", k) for k in range(len(q))]
    return dict(zip(qdd, found, strict=True)), qdd


def _direction(variables: Sequence[Nodes], components: Sequence[Nodes]) -> dict[Node, Node]:
    return {
        x: dx
        for pair in zip(variables, components, strict=True)
        for x, dx in zip(*pair, strict=True)
    }


DQ = Argument("dq", ("n",), "rad or m", "direction of q")
DQD = Argument("dqd", ("n",), "rad/s or m/s", "direction of qd")
W = Argument("w", ("n",), "SI", "weights of the results")


def _slope(name: str, of: str) -> Argument:
    return Argument(f"w_{name}", ("n",), "SI", f"w^T d {of}/d {name.removeprefix('d')}")


FUNCTIONS = (
    Function(
        "tau_jvp",
        (Q, QD, QDD, DQ, DQD, Argument("dqdd", ("n",), "rad/s^2 or m/s^2", "direction of qdd")),
        (Argument("dtau", ("n",), "N m or N", "derivative of tau along the direction"),),
        "Directional derivative of tau: (dtau/dq) dq + (dtau/dqd) dqd + M dqdd; Coulomb friction, "
        "which jumps, has none.",
        _tau_jvp,
        "the graph of tau differentiated forwards",
    ),
    Function(
        "tau_vjp",
        (Q, QD, QDD, W),
        (_slope("dq", "tau"), _slope("dqd", "tau"), _slope("dqdd", "tau")),
        "Gradient of w^T tau by q, qd and qdd (that is M w): the adjoint of tau_jvp.",
        _tau_vjp,
        "the graph of tau differentiated backwards",
    ),
    Function(
        "forward_dynamics_jvp",
        (Q, QD, TAU, DQ, DQD, Argument("dtau", ("n",), "N m or N", "direction of tau")),
        (Argument("dqdd", ("n",), "rad/s^2 or m/s^2", "derivative of qdd along the direction"),),
        "Directional derivative of forward_dynamics.",
        _forward_dynamics_jvp,
        "M = L^T D L, and the graph of tau differentiated forwards",
    ),
    Function(
        "forward_dynamics_vjp",
        (Q, QD, TAU, W),
        (_slope("dq", "qdd"), _slope("dqd", "qdd"), _slope("dtau", "qdd")),
        "Gradient of w^T qdd by q, qd and tau: the adjoint of forward_dynamics_jvp.",
        _forward_dynamics_vjp,
        "M = L^T D L, and the graph of tau differentiated backwards",
    ),
)
