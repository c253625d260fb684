"""A kernel against the symbolic route: the same states through both, and the largest difference.

The symbolic route is ``moro.closed_form``: Jacobian sums, Christoffel symbols, the gradient of the
potential energy. It shares nothing with the recursive algorithms that kernels are made from.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import sympy as sp
from moro_codegen.kernel import Kernel

from moro import Robot
from moro.abc import t
from moro.closed_form import ClosedForm
from moro.dual import DualRing
from moro.trig import TrigRing

Array: TypeAlias = npt.NDArray[np.float64]

#: an error beyond this, relative to the largest torque of its state, is none of rounding
TOLERANCE = 1e-10
#: seconds that closed forms may take; the same formulas are evaluated as numbers otherwise
TIME_LIMIT = 5.0


class SymbolicRoute:
    """tau of a robot by the symbolic route: derived once, evaluated at any states.

    ``is_closed_form`` tells whether the closed forms were done within ``time_limit`` [s]; if not,
    the same formulas are evaluated as numbers that carry their derivatives.
    """

    def __init__(self, robot: Robot, time_limit: float = TIME_LIMIT):
        self.robot = robot
        self._velocities = [sp.Symbol(f"qd_{i}") for i in range(1, robot.dof + 1)]
        try:
            self._derive(TrigRing(time_limit))
            self.is_closed_form = True
        except TimeoutError:
            self.is_closed_form = False

    def _derive(self, ring: TrigRing) -> None:
        form = ClosedForm(self.robot.arm, ring)
        self._ring = ring
        self._M = form.inertia_matrix
        self._C = form.coriolis_matrix([ring.convert(v) for v in self._velocities])
        self._G = form.gravity_vector

    @property
    def name(self) -> str:
        """What kernels are compared with, in words."""
        return "closed form" if self.is_closed_form else "formulas evaluated at the states"

    @property
    def terms(self) -> int:
        """Number of terms of the closed forms M, C and G."""
        return sum(len(p) for row in (*self._M, *self._C, self._G) for p in row)

    def tau(self, q: Array, qd: Array, qdd: Array, parameters: Mapping[Any, float]) -> Array:
        """Return M qdd + C qd + G + friction for states of shape (states, n)."""
        values = {**dict(zip(self.robot.qs, q.T, strict=True)), **parameters}
        evaluate = self._by_closed_form if self.is_closed_form else self._by_formulas
        M, C, G = evaluate(values, qd)
        rigid = np.einsum("ijs,sj->si", M, qdd) + np.einsum("ijs,sj->si", C, qd) + G.T
        tau: Array = rigid + _friction(self.robot, qd, parameters)
        return tau

    def _by_closed_form(self, values: Mapping[Any, Any], qd: Array) -> tuple[Array, Array, Array]:
        values = {**values, **dict(zip(self._velocities, qd.T, strict=True))}

        def numbers(row: Any) -> Array:
            return np.array([self._ring.evaluate(p, values) for p in row])

        M, C = (np.array([numbers(row) for row in matrix]) for matrix in (self._M, self._C))
        return M, C, numbers(self._G)

    def _by_formulas(self, values: Mapping[Any, Any], qd: Array) -> tuple[Array, Array, Array]:
        ring = DualRing(self.robot.qs, values)
        form = ClosedForm(self.robot.arm, ring)

        def numbers(row: Any) -> Array:
            return np.array([x.value for x in row])

        rates = [ring.constant(v) for v in qd.T]
        matrices = form.inertia_matrix, form.coriolis_matrix(rates)
        M, C = (np.array([numbers(row) for row in matrix]) for matrix in matrices)
        return M, C, numbers(form.gravity_vector)


@dataclass(frozen=True)
class Verification:
    """What came of comparing a kernel's tau with the symbolic equations.

    ``errors`` has one entry a state: the largest difference of a torque, relative to the largest
    torque of that state.
    """

    kernel: str
    errors: Array
    #: the states, each (states, n)
    q: Array
    qd: Array
    qdd: Array
    #: "closed form", or "formulas evaluated at the states" where that would take too long
    route: str

    @property
    def max_error(self) -> float:
        """The largest error over all states; NaN if any is."""
        return float(np.max(self.errors))

    @property
    def passed(self) -> bool:
        """Whether every error is one of rounding."""
        return bool(np.all(self.errors <= TOLERANCE))

    def __repr__(self) -> str:
        verdict = "verified" if self.passed else "FAILED"
        return (
            f"<Verification of {self.kernel}: {verdict}, largest error {self.max_error:.1e} "
            f"over {len(self.errors)} states, against the {self.route}>"
        )


def verify(
    kernel: Kernel,
    robot: Robot,
    *,
    states: int = 64,
    seed: int = 0,
    route: SymbolicRoute | None = None,
) -> Verification:
    """Compare ``kernel.tau`` with M qdd + C qd + G + friction of the symbolic route.

    The states are random ones inside the joint limits, and the awkward ones: at rest, all zero, at
    multiples of a quarter turn, at the limits, many turns away. Run-time parameters take their
    defaults, and random values where they have none.
    """
    rng = np.random.default_rng(seed)
    route = route or SymbolicRoute(robot)
    q, qd, qdd = _states(robot, states, rng)
    parameters = parameter_values(robot, rng)
    expected = route.tau(q, qd, qdd, parameters)
    by_name = {str(symbol): value for symbol, value in parameters.items()}
    found = kernel.tau(q, qd, qdd, parameters=by_name or None)
    errors = np.max(np.abs(found - expected), axis=1) / _scale(expected)
    return Verification(kernel.name, errors, q, qd, qdd, route.name)


def _friction(robot: Robot, qd: Array, parameters: Mapping[Any, float]) -> Array:
    """Return the friction torques, (states, n)."""
    rates = [q.diff(t) for q in robot.qs]
    symbols = [sp.Dummy() for _ in rates]
    vector = robot.friction_vector().xreplace(dict(zip(rates, symbols, strict=True)))
    torque = sp.lambdify([*symbols, *parameters], list(vector), "numpy")
    columns = torque(*qd.T, *parameters.values())
    friction: Array = np.stack([np.broadcast_to(x, len(qd)) for x in columns], axis=1)
    return friction.astype(float)


def _states(robot: Robot, states: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    limits = np.array(robot.joint_limits, dtype=float)
    lower, upper = np.minimum(limits[:, 0], limits[:, 1]), limits[:, 1]
    upper = np.where(upper - lower > 2 * math.pi, np.minimum(upper, lower + 2 * math.pi), upper)
    revolute = np.array([kind == "r" for kind in robot.joint_types])
    n = robot.dof
    q = rng.uniform(lower, upper, (states, n))
    qd, qdd = rng.uniform(-3, 3, (states, n)), rng.uniform(-10, 10, (states, n))
    turns = rng.integers(-20, 21, (states // 8, n)) * 2 * math.pi * revolute
    q = np.vstack([q, np.zeros(n), q[0], lower, upper, q[: states // 8] + turns])
    quarters = rng.integers(-2, 3, (states // 8, n)) * (math.pi / 2)  # singular poses
    q = np.vstack([q, np.where(revolute, quarters, q[: states // 8])])
    extra = len(q) - states
    qd = np.vstack([qd, rng.uniform(-3, 3, (extra, n))])
    qdd = np.vstack([qdd, rng.uniform(-10, 10, (extra, n))])
    qd[states : states + 2] = 0  # at rest, at zero and elsewhere
    qdd[states : states + 2] = 0
    qd[: states // 8, rng.integers(n)] = 0  # a joint at rest has no Coulomb friction
    return q, qd, qdd


def parameter_values(robot: Robot, rng: np.random.Generator) -> dict[Any, float]:
    """Return a value for each free symbol: its default, or a random one where it has none."""
    return {
        symbol: float(rng.uniform(0.5, 1.5)) if default is None else float(default)
        for symbol, default in robot.parameters.items()
    }


def _scale(tau: Array) -> Array:
    """Return the largest torque of each state, at least a millionth of the largest of all."""
    largest = np.max(np.abs(tau), axis=1)
    floor = max(1e-6 * float(np.max(largest)), np.finfo(float).tiny)
    scale: Array = np.maximum(largest, floor)
    return scale
