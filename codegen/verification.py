"""A kernel against the symbolic route: the same states through both, and the largest difference."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from moro import Robot
from moro_codegen.described import constants
from moro_codegen.functions import KNOWN
from moro_codegen.kernel import Kernel
from moro_codegen.progress import shown, tell
from moro_codegen.symbolic_route import Array, Dynamics, SymbolicRoute

__all__ = [
    "CHECKS",
    "TOLERANCE",
    "TOLERANCES",
    "SymbolicRoute",
    "Verification",
    "parameter_values",
    "verify",
]

#: an error beyond this, relative to the largest component of its state, is none of rounding: in
#: double precision 4.5e5 units of it, which leaves room for arms and states where terms cancel
TOLERANCE = 1e-10
#: by type; single precision has not so many units to lose, so 1700 of them: kernels of the packaged
#: arms stay below 300
TOLERANCES = {"float64": TOLERANCE, "float32": 2e-4}
#: components of a state that are all smaller than this part of those of all states have no digits
FLOOR = 1e-3

#: on the last link, in functions that take one; the same in single and double precision
WRENCH: Array = np.array([3.0, -5.0, 7.0, 1.125, 1.25, -1.75])

#: pairs of arrays that must be equal, states first
Pairs = Iterable[tuple[Array, Array]]


def _derivatives(x: Dynamics, by_q: Array, by_qd: Array, M: Array) -> Pairs:
    if x.route.is_closed_form:
        few = x.few
        yield from zip((by_q[few], by_qd[few]), x.tau_slopes, strict=True)
    yield M, x.M


def _acceleration_derivatives(x: Dynamics, by_q: Array, by_qd: Array, by_tau: Array) -> Pairs:
    """M times the derivatives of qdd are minus those of tau: no matrix has to be inverted."""
    if x.route.is_closed_form:
        few = x.few
        for slope, of_tau in zip((by_q, by_qd), x.tau_slopes, strict=True):
            yield -x.M[few] @ slope[few], of_tau
    yield x.M @ by_tau, np.broadcast_to(np.eye(x.robot.dof), x.M.shape)


#: for each function, what its results are compared with
CHECKS: dict[str, Callable[..., Pairs]] = {
    "tau": lambda x, tau: [(tau, x.tau)],
    "tau_with_wrench": lambda x, tau: [(tau, x.tau - WRENCH @ x.J)],
    "bias": lambda x, bias: [(bias, x.bias)],
    "gravity_vector": lambda x, G: [(G, x.G)],
    "inertia_matrix": lambda x, M: [(M, x.M)],
    "coriolis_matrix": lambda x, C: [(C, x.C)],
    # the torques of the accelerations found are those given
    "forward_dynamics": lambda x, qdd: [(np.einsum("sij,sj->si", x.M, qdd) + x.bias, x.tau)],
    "tau_derivatives": _derivatives,
    "forward_dynamics_derivatives": _acceleration_derivatives,
    "forward_kinematics": lambda x, T: [(T, x.T)],
    "jacobian": lambda x, J: [(J, x.J)],
    "kinetic_energy": lambda x, K: [(K, x.K)],
    "potential_energy": lambda x, P: [(P, x.P)],
    "regressor": lambda x, Y, p: [(np.einsum("sij,sj->si", Y, p), x.tau)],
}


@dataclass(frozen=True)
class Verification:
    """What came of comparing a kernel with the symbolic equations.

    ``errors`` has an array for each function, with one entry for each result and state: the largest
    difference of a component, relative to the largest component of that result in that state.
    """

    kernel: str
    errors: Mapping[str, Array]
    #: the states, each (states, n)
    q: Array
    qd: Array
    qdd: Array
    #: "closed form", or "formulas evaluated at the states" where that would take too long
    route: str
    #: functions that have no symbolic counterpart here
    unchecked: tuple[str, ...] = field(default=())
    #: the largest error that passes, ``TOLERANCES`` of the kernel's type
    tolerance: float = TOLERANCE

    @property
    def max_errors(self) -> dict[str, float]:
        """The largest error of each function; NaN if any is."""
        return {name: float(np.max(errors)) for name, errors in self.errors.items()}

    @property
    def max_error(self) -> float:
        """The largest error of all functions; NaN if any is, or if nothing was checked."""
        return float(np.max([*self.max_errors.values()])) if self.errors else math.nan

    @property
    def passed(self) -> bool:
        """Whether there are errors, and every one is one of rounding."""
        return bool(self.max_error <= self.tolerance)

    def __repr__(self) -> str:
        verdict = "verified" if self.passed else "FAILED"
        unchecked = f", not checked: {', '.join(self.unchecked)}" if self.unchecked else ""
        return (
            f"<Verification of {self.kernel}: {verdict}, largest error {self.max_error:.1e} of "
            f"{', '.join(self.errors)} over {len(self.q)} states, against the {self.route}"
            f"{unchecked}>"
        )


@shown()
def verify(
    kernel: Kernel,
    robot: Robot,
    *,
    states: int = 64,
    seed: int = 0,
    route: SymbolicRoute | None = None,
) -> Verification:
    """Compare every function of a kernel with the symbolic route.

    tau with M qdd + C qd + G + friction, and so on. Forward dynamics, and its derivatives, are put
    into the equations of motion; derivatives of tau are compared with complex-step derivatives of
    the closed form, where there is one.

    The states are random ones inside the joint limits, and the awkward ones: at rest, all zero, at
    multiples of a quarter turn, at the limits, many turns away. Run-time parameters take their
    defaults, and random values where they have none. A kernel in single precision and the symbolic
    route, in double, get the same numbers, rounded before: the errors are the kernel's own.
    """
    rng = np.random.default_rng(seed)
    route = route or SymbolicRoute(robot)
    dtype = next(s.dtype for s in kernel.signatures.values())
    q, qd, qdd = (_rounded(x, dtype) for x in _states(robot, states, rng))
    values = parameter_values(robot, rng)
    parameters = {symbol: float(_rounded(value, dtype)) for symbol, value in values.items()}
    expected = Dynamics(route, q, qd, qdd, parameters)
    by_name = for_kernel(kernel, parameters) or None
    errors: dict[str, Array] = {}
    unchecked = []
    for name, signature in kernel.signatures.items():
        tell(f"comparing {name} with the equations")
        parts = _parts(name)
        if not parts:
            unchecked.append(name)
            continue
        inputs = {"q": q, "qd": qd, "qdd": qdd, "wrench": WRENCH}
        if any(a.name == "tau" for a in signature.given):
            inputs["tau"] = expected.tau
        found = getattr(kernel, name)(*[inputs[a.name] for a in signature.given], by_name)
        results = iter(found if len(signature.outputs) > 1 else (found,))
        pairs = [
            pair
            for part in parts
            for pair in CHECKS[part](expected, *[next(results) for _ in KNOWN[part].outputs])
        ]
        errors[name] = _errors(pairs)
    tolerance = TOLERANCES[dtype]
    return Verification(kernel.name, errors, q, qd, qdd, route.name, tuple(unchecked), tolerance)


def _rounded(numbers: Any, dtype: str) -> Array:
    """Return numbers as doubles that the type holds exactly."""
    return np.asarray(numbers).astype(dtype).astype(float)


def _parts(name: str) -> list[str]:
    """Return the functions that a function computes together; none if they are not all known."""
    if name in CHECKS:
        return [name]
    for part in sorted(CHECKS, key=len, reverse=True):
        if name.startswith(f"{part}_") and (rest := _parts(name.removeprefix(f"{part}_"))):
            return [part, *rest]
    return []


def _errors(pairs: Pairs) -> Array:
    """Return the errors of all states, pair by pair."""
    errors = []
    for found, expected in pairs:
        axes = tuple(range(1, expected.ndim))
        errors.append(np.max(np.abs(found - expected), axis=axes) / _scale(expected, axes))
    return np.concatenate(errors)


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
    """Return a value for each free symbol: its default, or a random one.

    That is for symbols without a default, and for those of something that the robot's description
    is divided by and that is zero for the defaults.
    """
    defaults = {symbol: x for symbol, x in robot.parameters.items() if x is not None}
    free = set(robot.parameters) - set(defaults)
    for _, _, _, value in constants(robot):
        for power in value.atoms(sp.Pow):
            if power.exp.is_negative and power.base.xreplace(defaults).is_zero:
                free |= power.base.free_symbols
    return {
        symbol: float(rng.uniform(0.5, 1.5)) if symbol in free else float(default)
        for symbol, default in robot.parameters.items()
    }


def for_kernel(kernel: Kernel, values: Mapping[Any, float]) -> dict[str, float]:
    """Return a value by name for each of a kernel's parameters: those of the robot, defaults, 1."""
    known = {str(symbol): value for symbol, value in values.items()}
    defaults = {name: 1.0 if x is None else x for name, x in kernel.parameters.items()}
    return {name: known.get(name, default) for name, default in defaults.items()}


def _scale(expected: Array, axes: tuple[int, ...]) -> Array:
    """Return the largest component of each state, at least ``FLOOR`` times that of all.

    Where everything must be zero, errors are absolute.
    """
    largest = np.max(np.abs(expected), axis=axes)
    scale: Array = np.maximum(largest, FLOOR * float(np.max(largest)) or 1.0)
    return scale
