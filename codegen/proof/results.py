"""What the results of every function of the catalogue must be, by the symbolic route.

The regressors are compared as Y p, so they are not among them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from moro.algorithms.time_step import velocities_after
from moro.model import Frame
from moro_codegen.proof.expected import ExpectedDynamics, applied, is_dry, solved, weighted

#: of numbers that NumPy says nothing more of
Array: TypeAlias = NDArray[Any]


class Expected(NamedTuple):
    """What the results of a function must be."""

    #: of the dynamics, and of the frame if the function is of one
    results: Callable[..., Sequence[Array]]
    #: at which states: "every", "moving", "few" or "fewest"
    at: str = "every"
    #: whether M must be inverted
    inverting: bool = False


def _passivity(x: ExpectedDynamics) -> list[Array]:
    beyond = x.others["qdd_r"] - x.qdd, x.others["qd_r"] - x.qd
    return [x.tau + applied(x.M, beyond[0]) + applied(x.C, beyond[1])]


def _frame_acceleration(x: ExpectedDynamics, frame: Frame) -> list[Array]:
    return [applied(x.J(frame), x.qdd) + applied(x.J_rate(frame), x.qd)]


def _operational_space(x: ExpectedDynamics, frame: Frame) -> list[Array]:
    """Return Lambda (states, 6, 6), mu (states, 6) and J_bar (states, n, 6)."""
    J, rate = x.J(frame), applied(x.J_rate(frame), x.qd)
    caused = np.linalg.solve(x.M, J.swapaxes(1, 2))
    damping = x.others["damping"][:, np.newaxis, np.newaxis] * np.eye(6)
    inertia: Array = np.linalg.inv(J @ caused + damping)
    inverse = caused @ inertia
    forces: Array = weighted(applied(x.C, x.qd) + x.G, inverse)
    return [inertia, forces - applied(inertia, rate), inverse]


def _tau_jvp(x: ExpectedDynamics) -> list[Array]:
    slopes = (*x.tau_slopes, x.M)
    directions = (x.others[name] for name in ("dq", "dqd", "dqdd"))
    return [_along(slopes, directions)]


def _along(slopes: Iterable[Array], directions: Iterable[Array]) -> Array:
    pairs = zip(slopes, directions, strict=True)
    total: Array = np.sum([applied(*pair) for pair in pairs], axis=0)
    return total


def _tau_vjp(x: ExpectedDynamics) -> list[Array]:
    return [weighted(x.others["w"], slope) for slope in (*x.tau_slopes, x.M)]


def _forward_slopes(x: ExpectedDynamics) -> list[Array]:
    """Return the derivatives of qdd by q, qd and tau."""
    return [*(-np.linalg.solve(x.M, slope) for slope in x.tau_slopes), np.linalg.inv(x.M)]


def _forward_jvp(x: ExpectedDynamics) -> list[Array]:
    directions = (x.others[name] for name in ("dq", "dqd", "dtau"))
    return [_along(_forward_slopes(x), directions)]


def _forward_vjp(x: ExpectedDynamics) -> list[Array]:
    return [weighted(x.others["w"], slope) for slope in _forward_slopes(x)]


def _tau_hessian(x: ExpectedDynamics, weights: Array) -> list[Array]:
    """Return the second derivatives of weights . tau by (q, q), (q, qd), (qd, qd), (q, qdd)."""
    q_q, q_qd, qd_qd, M = (np.einsum("si,sijk->sjk", weights, T) for T in x.second_slopes)
    return [q_q, q_qd, qd_qd, M.swapaxes(1, 2)]


def _forward_hessian(x: ExpectedDynamics) -> list[Array]:
    """Return those of w . qdd, with tau(q, qd, qdd(q, qd, tau)) = tau differentiated twice."""
    q_q, q_qd, qd_qd, N = _tau_hessian(x, solved(x.M, x.others["w"]))
    by_q, by_qd, by_tau = _forward_slopes(x)
    through = N @ by_q
    mixed = through + through.swapaxes(1, 2)
    return [-(q_q + mixed), -(q_qd + N @ by_qd), -qd_qd, -(N @ by_tau)]


def _runge_kutta(x: ExpectedDynamics) -> list[Array]:
    """Return the state after a step of the classical Runge-Kutta method."""
    h, tau = x.others["dt"][:, np.newaxis], x.others["tau"]

    def slope(y: Array) -> Array:
        there = x.moved(q=y[0], qd=y[1])
        return np.stack([y[1], solved(there.M, tau - there.bias)])

    y = np.stack([x.q, x.qd])
    a = slope(y)
    b = slope(y + h / 2 * a)
    c = slope(y + h / 2 * b)
    return [*(y + h / 6 * (a + 2 * b + 2 * c + slope(y + h * c)))]


def _semi_implicit(x: ExpectedDynamics) -> list[Array]:
    """Return the state after a semi-implicit step: M, C and G are the route's."""
    h, dt = x.others["dt"][:, np.newaxis], x.others["dt"]
    slopes, remainders, bounds = x.friction_slopes, x.friction.copy(), list[Any]()
    for i, drive in enumerate(x.drives):
        if is_dry(drive):
            forwards, backwards = x.magnitudes(drive, x.qd[:, i])
            slopes[:, i], remainders[:, i] = drive.viscous, 0
            bounds.append((-dt * backwards, dt * forwards))
        else:
            bounds.append(None)
            remainders[:, i] -= slopes[:, i] * x.qd[:, i]
    stiffness = np.array([drive.stiffness for drive in x.drives], dtype=float)
    M = x.M + np.eye(x.model.nv) * (h * (slopes + h * stiffness))[:, np.newaxis]
    force = x.others["tau"] - applied(x.C, x.qd) - x.G - remainders
    impulse = applied(x.M, x.qd) + h * force
    inverse = np.moveaxis(np.linalg.inv(M), 0, -1)
    after = np.stack(velocities_after([*inverse], [*impulse.T], bounds, np.clip), axis=1)
    return [x.q + h * after, after]


#: by the name of the function
EXPECTED: dict[str, Expected] = {
    "tau": Expected(lambda x: [x.tau]),
    "tau_with_wrench": Expected(
        lambda x, frame: [x.tau - weighted(x.others["wrench"], x.J(frame))]
    ),
    "bias": Expected(lambda x: [x.bias]),
    "gravity_vector": Expected(lambda x: [x.G]),
    "tau_passivity": Expected(_passivity),
    "bias_product": Expected(lambda x: [applied(x.C, x.others["v"])]),
    "inertia_matrix": Expected(lambda x: [x.M]),
    "coriolis_matrix": Expected(lambda x: [x.C]),
    "inertia_matrix_rate": Expected(lambda x: [x.C + x.C.swapaxes(1, 2)]),
    "inertia_matrix_inverse": Expected(lambda x: [np.linalg.inv(x.M)], inverting=True),
    "forward_dynamics": Expected(lambda x: [solved(x.M, x.others["tau"] - x.bias)], inverting=True),
    "tau_derivatives": Expected(lambda x: [*x.tau_slopes, x.M], "few"),
    "forward_dynamics_derivatives": Expected(_forward_slopes, "few", inverting=True),
    "forward_kinematics": Expected(lambda x, frame: [x.T(frame)]),
    "jacobian": Expected(lambda x, frame: [x.J(frame)]),
    "jacobian_rate": Expected(lambda x, frame: [x.J_rate(frame)]),
    "jacobian_rate_qd": Expected(lambda x, frame: [applied(x.J_rate(frame), x.qd)]),
    "frame_velocity": Expected(lambda x, frame: [applied(x.J(frame), x.qd)]),
    "frame_acceleration": Expected(_frame_acceleration),
    "jacobian_position_hessian": Expected(lambda x, frame: [x.J_slopes(frame)[:, :3]]),
    "center_of_mass": Expected(lambda x: [*x.center_of_mass]),
    "kinetic_energy": Expected(lambda x: [x.K]),
    "potential_energy": Expected(lambda x: [x.P]),
    "momentum": Expected(lambda x: [applied(x.M, x.qd)]),
    "momentum_bias": Expected(lambda x: [weighted(x.qd, x.C) + applied(x.C, x.qd) - x.bias]),
    "operational_space": Expected(_operational_space, inverting=True),
    "tau_jvp": Expected(_tau_jvp, "few"),
    "tau_vjp": Expected(_tau_vjp, "few"),
    "forward_dynamics_jvp": Expected(_forward_jvp, "few", inverting=True),
    "forward_dynamics_vjp": Expected(_forward_vjp, "few", inverting=True),
    "tau_second_derivatives": Expected(lambda x: [*x.second_slopes], "fewest"),
    "tau_hessian": Expected(lambda x: _tau_hessian(x, x.others["w"]), "fewest"),
    "forward_dynamics_hessian": Expected(_forward_hessian, "fewest", inverting=True),
    "tau_parameter_derivatives": Expected(lambda x: [x.parameter_slopes], "few"),
    "forward_dynamics_parameter_derivatives": Expected(
        lambda x: [-np.linalg.solve(x.M, x.parameter_slopes)], "few", inverting=True
    ),
    "step_rk4": Expected(_runge_kutta, "moving", inverting=True),
    "step_semi_implicit": Expected(_semi_implicit, inverting=True),
}

#: of regressors with their parameters: what Y p is
REGRESSED = {
    "regressor": "tau",
    "standard_regressor": "tau",
    "passivity_regressor": "tau_passivity",
    "momentum_regressor": "momentum",
}
