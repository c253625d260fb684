"""Derivatives by run-time parameters: a payload's mass, a length, a coefficient of friction."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.factorization import factorized, solution
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, QDD, TAU, Argument, Q
from moro_codegen.functions.catalogue.products import caused_by, torques
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat
from moro_codegen.graph.derivatives import jacobian
from moro_codegen.graph.nodes import Node, replaced

Nodes = Sequence[Node]


def _tau_by_parameters(system: System, q: Nodes, qd: Nodes, qdd: Nodes) -> Outputs:
    parameters = _parameters(system)

    def derivatives(arm: Posture) -> Sequence[Scalar]:
        return flat(jacobian(torques(system, arm, q, qd, qdd), parameters))

    return [system.dynamics(system.posture(q), derivatives)]


def _forward_dynamics_by_parameters(system: System, q: Nodes, qd: Nodes, tau: Nodes) -> Outputs:
    parameters = _parameters(system)
    caused, qdd = caused_by(system, q, qd, tau)

    def derivatives(arm: Posture) -> Sequence[Scalar]:
        """M dqdd = -(dtau/dp) dp, for the qdd that tau causes."""
        factors = factorized(joint_inertia(arm, system.rotors), arm)
        slopes = zip(*jacobian(torques(system, arm, q, qd, qdd), parameters), strict=True)
        columns = [solution(factors, [-x for x in slope]) for slope in slopes]
        return replaced(system.nodes(flat(zip(*columns, strict=True))), caused)

    return [system.dynamics(system.posture(q), derivatives)]


def _parameters(system: System) -> list[Node]:
    """Return the run-time parameters of the model. Raise ValueError if it has none."""
    if not system.model.defaults:
        raise ValueError(
            f"{system.model.name} has no run-time parameters to differentiate by: leave a value "
            "of the robot a symbol"
        )
    return [system.parameters[symbol] for symbol in system.model.defaults]


def _by_parameters(of: str) -> Argument:
    return Argument(
        f"d{of}_dparameters", ("n", "p"), "SI", f"d {of}_i/d parameter_j, the robot's in order"
    )


FUNCTIONS = (
    Function(
        "tau_parameter_derivatives",
        (Q, QD, QDD),
        (_by_parameters("tau"),),
        "Derivatives of tau with respect to the robot's run-time parameters; by inertial "
        "parameters they are the columns of the regressor.",
        _tau_by_parameters,
        "the graph of tau differentiated",
    ),
    Function(
        "forward_dynamics_parameter_derivatives",
        (Q, QD, TAU),
        (_by_parameters("qdd"),),
        "Derivatives of forward_dynamics with respect to the robot's run-time parameters.",
        _forward_dynamics_by_parameters,
        "M = L^T D L and the derivatives of tau",
    ),
)
