"""Steps in time: the state at the end of a step, from that at its beginning."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.drives import friction, spring_torques, stribeck
from moro.algorithms.factorization import factorized, inverse, solution
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.algorithms.time_step import velocities_after
from moro.model import Drive
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import QD, TAU, Argument, Q
from moro_codegen.functions.catalogue.forward_dynamics import accelerations
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.singular import check_resisted
from moro_codegen.functions.system import System
from moro_codegen.graph.derivatives import directional
from moro_codegen.graph.nodes import Node, constant_value, replaced

Nodes = Sequence[Node]


def _step_rk4(system: System, q: Nodes, qd: Nodes, tau: Nodes, dt: Nodes) -> Outputs:
    """Return the classical Runge-Kutta step of order 4."""
    (at_start,) = accelerations(system, q, qd, tau)
    h, half = dt[0], dt[0] / 2

    def slope(x: Nodes, v: Nodes) -> Nodes:
        return replaced(at_start, dict(zip([*q, *qd], [*x, *v], strict=True)))

    v1, a1 = qd, at_start
    v2, a2 = _ahead(qd, half, a1), slope(_ahead(q, half, v1), _ahead(qd, half, a1))
    v3, a3 = _ahead(qd, half, a2), slope(_ahead(q, half, v2), _ahead(qd, half, a2))
    v4, a4 = _ahead(qd, h, a3), slope(_ahead(q, h, v3), _ahead(qd, h, a3))
    return [
        _ahead(x, h / 6, [a + 2 * (b + c) + d for a, b, c, d in zip(*slopes, strict=True)])
        for x, slopes in ((q, (v1, v2, v3, v4)), (qd, (a1, a2, a3, a4)))
    ]


def _step_semi_implicit(system: System, q: Nodes, qd: Nodes, tau: Nodes, dt: Nodes) -> Outputs:
    n, h, graph = system.model.nv, dt[0], system.graph
    still, rotors = [0] * n, system.rotors
    check_resisted(system.model, rotors)
    drives = [
        _Drive(system, x.drive, rate) for x, rate in zip(system.model.coordinates, qd, strict=True)
    ]
    springs = spring_torques(system.model, q)
    bounds = [d.bounds(h) for d in drives]

    def velocities(arm: Posture) -> Sequence[Scalar]:
        M, bias = joint_inertia(arm, rotors), joint_torques(arm, qd, still)
        impulse = []
        for i, drive in enumerate(drives):
            momentum = sum((m * rate for m, rate in zip(M[i], qd, strict=True)), graph.zero)
            force = tau[i] - bias[i] - springs[i] - drive.remainder
            impulse.append(momentum + h * force)
        for i, (drive, x) in enumerate(zip(drives, system.model.coordinates, strict=True)):
            M[i][i] = M[i][i] + h * (drive.slope + h * x.drive.stiffness)
        factors = factorized(M, arm)
        if not any(bounds):
            return solution(factors, impulse)
        return velocities_after(inverse(factors), impulse, bounds, _clamped)

    after = system.dynamics(system.posture(q), velocities)
    return [_ahead(q, h, after), after]


class _Drive:
    """Friction of a drive for a step: what is linear in the velocity, and what is dry."""

    def __init__(self, system: System, drive: Drive, rate: Node) -> None:
        self.system, self.drive, self.rate = system, drive, rate
        graph = system.graph
        #: friction is remainder + slope v but for what is dry, v being the velocity after the step
        self.remainder: Scalar = graph.zero
        self.slope: Scalar = graph.zero if system.rigid else graph.constant(drive.viscous)
        if self._has_steps and drive.width is not None:
            force = graph.constant(friction(drive, rate, system.functions))
            (self.slope,) = directional([force], {rate: graph.one})
            self.remainder = force - self.slope * rate

    @property
    def _has_steps(self) -> bool:
        """Whether there is friction besides viscous friction."""
        magnitudes = (*self.drive.coulomb, *(self.drive.static or ()))
        return not self.system.rigid and any(constant_value(x) != 0 for x in magnitudes)

    def bounds(self, h: Node) -> tuple[Scalar, Scalar] | None:
        """Return the least and the greatest impulse of dry friction in a step; None without it."""
        drive = self.drive
        if not self._has_steps or drive.width is not None:
            return None
        forward, backward = drive.coulomb
        if drive.static is not None:
            fading = stribeck(drive, self.rate, self.system.functions)
            forward = forward + (drive.static[0] - forward) * fading
            backward = backward + (drive.static[1] - backward) * fading
        return -(h * backward), h * forward


def _clamped(x: Node, lower: Node, upper: Node) -> Node:
    return x.graph.call("fmax", lower, x.graph.call("fmin", upper, x))


def _ahead(x: Nodes, h: Node, slope: Nodes) -> list[Node]:
    return [a + h * b for a, b in zip(x, slope, strict=True)]


DT = Argument("dt", (), "s", "duration of the step")
AFTER = (
    Argument("q_next", ("n",), "rad or m", "joint positions after the step"),
    Argument("qd_next", ("n",), "rad/s or m/s", "joint velocities after the step"),
)

FUNCTIONS = (
    Function(
        "step_rk4",
        (Q, QD, TAU, DT),
        AFTER,
        "A step in time by the classical Runge-Kutta method of order 4, with constant torques: for "
        "arms whose friction is smooth.",
        _step_rk4,
        "forward dynamics, four times",
    ),
    Function(
        "step_semi_implicit",
        (Q, QD, TAU, DT),
        AFTER,
        "A step in time by the semi-implicit Euler method, of order 1: qd_next first, then "
        "q_next = q + dt qd_next. Springs, viscous and smooth friction are taken at the end of the "
        "step, so stiff ones are stable; Coulomb friction brings joints to rest and holds them.",
        _step_semi_implicit,
        "M = L^T D L; impulses of dry friction by projected Gauss-Seidel",
    ),
)
