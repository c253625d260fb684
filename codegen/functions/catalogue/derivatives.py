"""First derivatives of inverse and forward dynamics.

C(q, qd) qd is quadratic in qd, with Christoffel's c_ijk = c_ikj, so its derivatives by qd are 2 C:
a candidate beside the graph of tau differentiated, by which those by q are found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.factorization import factorized, inverse, solution
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, M, Q
from moro_codegen.functions.catalogue.products import caused_by, torques
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import Algorithm, System, flat, parts
from moro_codegen.graph.derivatives import directional, jacobian
from moro_codegen.graph.nodes import Node, replaced

TAU_BY_Q = Argument("dtau_dq", ("n", "n"), "N m/rad to N/m", "d tau_i/d q_j")
TAU_BY_QD = Argument("dtau_dqd", ("n", "n"), "N m s/rad to N s/m", "d tau_i/d qd_j")
QDD_BY_Q = Argument("dqdd_dq", ("n", "n"), "1/s^2", "d qdd_i/d q_j")
QDD_BY_QD = Argument("dqdd_dqd", ("n", "n"), "1/s", "d qdd_i/d qd_j")
QDD_BY_TAU = Argument("dqdd_dtau", ("n", "n"), "1/(kg m^2) to 1/kg", "d qdd_i/d tau_j: 1/M")


def _tau_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> Outputs:
    def derivatives(slopes: Slopes, arm: Posture) -> Sequence[Scalar]:
        by_q, by_qd = slopes(system, arm, q, qd, qdd)
        return flat((by_q, by_qd, flat(joint_inertia(arm, system.rotors))))

    return parts(system.dynamics(system.posture(q), *each(derivatives)), 3)


def _forward_dynamics_derivatives(
    system: System, q: Sequence[Node], qd: Sequence[Node], tau: Sequence[Node]
) -> Outputs:
    caused, qdd = caused_by(system, q, qd, tau)

    def derivatives(slopes: Slopes, arm: Posture) -> Sequence[Scalar]:
        """M dqdd = dtau - (dtau/dq) dq - (dtau/dqd) dqd, for the qdd that tau causes."""
        n, factors = len(q), factorized(joint_inertia(arm, system.rotors), arm)
        found: list[Scalar] = []
        for block in slopes(system, arm, q, qd, qdd):
            columns = [solution(factors, [-x for x in block[j::n]]) for j in range(n)]
            found += flat(zip(*columns, strict=True))
        return replaced(system.nodes([*found, *flat(inverse(factors))]), caused)

    return parts(system.dynamics(system.posture(q), *each(derivatives)), 3)


#: returns d tau/dq and d tau/dqd, flat
Slopes: TypeAlias = Callable[..., "tuple[list[Node], list[Node]]"]


def each(derivatives: Callable[[Slopes, Posture], Sequence[Scalar]]) -> list[Algorithm]:
    """Return the algorithms that derivatives are by each way to the slopes of tau."""
    return [
        partial(derivatives, slopes) for slopes in (slopes_by_coriolis, slopes_by_differentiation)
    ]


def slopes_by_differentiation(
    system: System, arm: Posture, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> tuple[list[Node], list[Node]]:
    """Return d tau/dq and d tau/dqd, flat."""
    tau = torques(system, arm, q, qd, qdd)
    return flat(jacobian(tau, q)), flat(jacobian(tau, qd))


def slopes_by_coriolis(
    system: System, arm: Posture, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> tuple[list[Node], list[Node]]:
    """Return d tau/dq, and d tau/dqd as 2 C and the slopes of friction, flat."""
    n, friction = len(q), system.nodes(system.drives(q, qd, qdd))
    slopes = flat(joint_coriolis(arm, [2 * rate for rate in qd]))
    for j in range(n):
        (slope,) = directional([friction[j]], {qd[j]: system.graph.one})
        slopes[j * (n + 1)] = slopes[j * (n + 1)] + slope
    return flat(jacobian(torques(system, arm, q, qd, qdd), q)), system.nodes(slopes)


FUNCTIONS = (
    Function(
        "tau_derivatives",
        (Q, QD, QDD),
        (TAU_BY_Q, TAU_BY_QD, M),
        "Derivatives of tau with respect to q, qd and qdd (that is M); Coulomb friction, which "
        "jumps, has none.",
        _tau_derivatives,
        "the graph of tau differentiated by q, and by qd or 2 C; M by composite rigid bodies",
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
