"""Where a frame is, and how it moves."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.center_of_mass import center_of_mass, center_of_mass_jacobian
from moro.algorithms.kinematics import (
    frame_acceleration,
    frame_jacobian,
    frame_velocity,
    poses,
)
from moro.algorithms.posture import Posture
from moro.spatial.motion import Velocity
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import LAST, QD, QDD, Argument, J, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat, parts
from moro_codegen.graph.derivatives import directional, jacobian
from moro_codegen.graph.nodes import Node

T = Argument("T", (4, 4), "1, m", f"pose of {LAST} in frame 0: [[R, p], [0, 1]]")


def _forward_kinematics(system: System, q: Sequence[Node]) -> Outputs:
    def pose(arm: Posture) -> Sequence[Scalar]:
        tip = poses(arm)[-1]
        rows = [(*row, x) for row, x in zip(tip.R, tip.p, strict=True)]
        return flat([*rows, (0, 0, 0, 1)])

    closed = system.closed_form("pose", q)
    return [system.geometry(q, pose, closed)]


def _jacobian(system: System, q: Sequence[Node]) -> Outputs:
    closed = system.closed_form("jacobian", q)
    return [system.geometry(q, lambda arm: flat(frame_jacobian(arm)), closed)]


def _jacobian_rate(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    velocity = dict(zip(q, qd, strict=True))

    def rate(arm: Posture) -> Sequence[Scalar]:
        return directional(system.nodes(flat(frame_jacobian(arm))), velocity)

    return [system.geometry(q, rate)]


def _jacobian_rate_qd(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    return _frame_acceleration(system, q, qd, [system.graph.zero] * len(q))


def jacobian_and_rate(
    system: System, q: Sequence[Node], qd: Sequence[Node]
) -> tuple[list[Sequence[Node]], Sequence[Node]]:
    """Return the rows of J, and dJ/dt qd."""
    (J,), (rate,) = _jacobian(system, q), _jacobian_rate_qd(system, q, qd)
    return parts(J, 6), rate


def _frame_velocity(system: System, q: Sequence[Node], qd: Sequence[Node]) -> Outputs:
    return [system.geometry(q, lambda arm: _linear_first(frame_velocity(arm, qd)))]


def _frame_acceleration(
    system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> Outputs:
    return [system.geometry(q, lambda arm: _linear_first(frame_acceleration(arm, qd, qdd)))]


def _position_hessian(system: System, q: Sequence[Node]) -> Outputs:
    def hessian(arm: Posture) -> Sequence[Scalar]:
        return flat(jacobian(system.nodes(flat(frame_jacobian(arm)[:3])), q))

    return [system.geometry(q, hessian)]


def _center_of_mass(system: System, q: Sequence[Node]) -> Outputs:
    def centre(arm: Posture) -> Sequence[Scalar]:
        return [*center_of_mass(arm), *flat(center_of_mass_jacobian(arm))]

    try:
        found = system.geometry(q, centre)
    except ZeroDivisionError:
        raise ValueError(f"{system.model.name} has no mass, so no centre of mass") from None
    return [found[:3], found[3:]]


def _linear_first(velocity: Velocity) -> Sequence[Scalar]:
    return [*velocity.v, *velocity.omega]


FUNCTIONS = (
    Function(
        "forward_kinematics",
        (Q,),
        (T,),
        f"Forward kinematics: the pose of {LAST}.",
        _forward_kinematics,
        "product of the transforms; or the closed form",
        frame="",
    ),
    Function(
        "jacobian",
        (Q,),
        (J,),
        f"Jacobian of {LAST}: velocity of its origin, angular velocity.",
        _jacobian,
        "joint axes, and the way from each to the frame; or the closed form",
        frame="",
    ),
    Function(
        "jacobian_rate",
        (Q, QD),
        (Argument("dJ_dt", (6, "n"), "m/(rad s), 1/s", f"rate of the Jacobian of {LAST}"),),
        f"Rate of the Jacobian of {LAST}, dJ/dt.",
        _jacobian_rate,
        "the graph of J differentiated along qd",
        frame="",
    ),
    Function(
        "jacobian_rate_qd",
        (Q, QD),
        (Argument("dJ_dt_qd", (6,), "m/s^2, rad/s^2", "dJ/dt qd; in frame 0"),),
        f"Acceleration of {LAST} without joint accelerations: dJ/dt qd.",
        _jacobian_rate_qd,
        "accelerations from the base to the frame, for qdd = 0",
        frame="",
    ),
    Function(
        "frame_velocity",
        (Q, QD),
        (Argument("V", (6,), "m/s, rad/s", f"(v, omega) of {LAST}; in frame 0"),),
        f"Velocity of {LAST}, J qd: of its origin, then angular.",
        _frame_velocity,
        "velocities from the base to the frame",
        frame="",
    ),
    Function(
        "frame_acceleration",
        (Q, QD, QDD),
        (Argument("A", (6,), "m/s^2, rad/s^2", f"(a, alpha) of {LAST}; in frame 0"),),
        f"Acceleration of {LAST}, J qdd + dJ/dt qd: of its origin, without gravity, then angular.",
        _frame_acceleration,
        "accelerations from the base to the frame",
        frame="",
    ),
    Function(
        "jacobian_position_hessian",
        (Q,),
        (Argument("H", (3, "n", "n"), "m/rad^2", f"d^2 p_i/(d q_j d q_k) of {LAST}; in frame 0"),),
        f"Second derivatives of the position p of {LAST}, those of the linear rows of J.",
        _position_hessian,
        "the graph of J differentiated",
        frame="",
    ),
    Function(
        "center_of_mass",
        (Q,),
        (
            Argument("r_C", (3,), "m", "centre of mass of the arm; in frame 0"),
            Argument("J_C", (3, "n"), "m/rad, 1", "velocity of the centre of mass = J_C qd"),
        ),
        "Centre of mass of the arm, and its Jacobian.",
        _center_of_mass,
        "composite rigid bodies",
    ),
)
