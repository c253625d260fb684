"""A kernel against the route it was not made by: the same states, and the largest difference.

What recursions made is compared with the symbolic route, closed forms with recursions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import sympy as sp

from moro import Robot
from moro.checks.frame_called import frame_called
from moro.model import Frame, Model, as_model
from moro_codegen.functions.catalogue import KNOWN
from moro_codegen.functions.own import Formula, Scope, UserFunction
from moro_codegen.kernel.kernel import Kernel
from moro_codegen.progress import shown, tell
from moro_codegen.proof.by_recursion import RecursiveDynamics, recursively
from moro_codegen.proof.expected import ExpectedDynamics, applied, evaluated, scales
from moro_codegen.proof.results import EXPECTED, REGRESSED
from moro_codegen.proof.symbolic_route import STATES_LIMIT, Array, SymbolicRoute, spread
from moro_codegen.signature import Part

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
#: what a solution loses besides, of the condition number
SOLVED = 1e-2


@dataclass(frozen=True)
class Pair:
    """Two arrays that must be equal, states first."""

    found: Array
    expected: Array
    #: what rounding is measured by (states) where that is larger than the largest component
    size: Array | float = 0.0


Pairs = Iterable[Pair]


def _by_route(name: str, x: ExpectedDynamics, *frame_and_results: Any) -> Pairs:
    """Put the results found beside those of the symbolic route."""
    expected = EXPECTED[name]
    states = getattr(x, expected.at)
    if expected.inverting:
        states = states[x.regular[states]]
    there = x.at(states)
    frame = [item for item in frame_and_results if isinstance(item, Frame)]
    results = frame_and_results[len(frame) :]
    for found, values in zip(results, expected.results(there, *frame), strict=True):
        lost = SOLVED * there.lost(values) if expected.inverting else 0.0
        yield Pair(found[states], values, lost)


def _accelerations(x: ExpectedDynamics, qdd: Array) -> Pairs:
    """Put the accelerations found into the equations: their torques are those given."""
    ok = x.regular
    caused = _product(x.M[ok], qdd[ok], x.tau[ok] - x.bias[ok])
    yield Pair(caused.found + x.bias[ok], x.tau[ok], caused.size)


def _acceleration_derivatives(
    x: ExpectedDynamics, by_q: Array, by_qd: Array, by_tau: Array
) -> Pairs:
    """M times the derivatives of qdd are minus those of tau: no matrix has to be inverted."""
    few = x.few[x.regular[x.few]]
    for slope, of_tau in zip((by_q, by_qd), x.tau_slopes, strict=True):
        yield _product(-x.M[few], slope[few], of_tau[x.regular[x.few]])
    ok = x.regular
    yield _product(x.M[ok], by_tau[ok], np.broadcast_to(np.eye(x.model.nv), x.M[ok].shape))


def _regressed(of: str, x: ExpectedDynamics, Y: Array, p: Array | None = None) -> Pairs:
    """Put Y p beside what it is the regressor of; p is that of the model if it is no result."""
    (expected,) = EXPECTED[of].results(x)
    p = x.inertial_parameters(Y.shape[-1]) if p is None else p
    yield Pair(applied(Y, np.broadcast_to(p, (len(Y), Y.shape[-1]))), expected)


def _product(M: Array, factor: Array, expected: Array) -> Pair:
    """Return M factor, whose rounding is measured by |M| |factor|.

    So a solution near a singular posture, where that is larger than what it cancels to, is judged
    by what a solver can do: by its residual.
    """
    vector = factor.ndim == M.ndim - 1
    columns = factor[..., np.newaxis] if vector else factor
    found, sizes = M @ columns, np.abs(M) @ np.abs(columns)
    return Pair(found[..., 0] if vector else found, expected, np.max(sizes, axis=(1, 2), initial=0))


#: for each function of the catalogue, what its results are compared with; of a frame, it is given
CHECKS: dict[str, Callable[..., Pairs]] = {
    **{name: partial(_by_route, name) for name in EXPECTED},
    "forward_dynamics": _accelerations,
    "forward_dynamics_derivatives": _acceleration_derivatives,
    **{name: partial(_regressed, of) for name, of in REGRESSED.items()},
}
#: those that M must be inverted for
INVERTING = frozenset(name for name, expected in EXPECTED.items() if expected.inverting)


@dataclass(frozen=True)
class Verification:
    """What came of comparing a kernel with the symbolic equations.

    ``errors`` has an array for each function, with one entry for each result and state: the largest
    difference of a component, relative to the largest component of that result in that state.
    Results that M must be inverted for have entries only where that can be done.
    """

    kernel: str
    errors: Mapping[str, Array]
    #: the states, each (states, n)
    q: Array
    qd: Array
    qdd: Array
    #: what each function was compared with: "closed form", or "formulas evaluated at the states"
    #: where that would take too long; "recursion" if the kernel's was made from the closed form
    routes: Mapping[str, str]
    #: functions that have no symbolic counterpart here
    unchecked: tuple[str, ...] = field(default=())
    #: the largest error that passes, ``TOLERANCES`` of the kernel's type
    tolerance: float = TOLERANCE
    #: postures q, (postures, n), of the states at which M is singular and forward dynamics and its
    #: derivatives were not compared; the rest was. Empty if the kernel has neither
    singular: Array = field(default_factory=lambda: np.empty((0, 0)))
    #: states that were left out because the formulas at them would have taken too long
    left_out: int = 0

    @property
    def route(self) -> str:
        """What the kernel was compared with, in words: all that its functions were."""
        return " and ".join(dict.fromkeys(self.routes.values()))

    @property
    def max_errors(self) -> dict[str, float]:
        """The largest error of each function; NaN if any is, or if no state counted."""
        return {
            name: float(np.max(errors)) if errors.size else math.nan
            for name, errors in self.errors.items()
        }

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
        singular = f", M singular at {self.singular_postures}" if len(self.singular) else ""
        return (
            f"<Verification of {self.kernel}: {verdict}, largest error {self.max_error:.1e} of "
            f"{', '.join(self.errors)} over {self.states}, against the {self.route}"
            f"{singular}{unchecked}>"
        )

    @property
    def states(self) -> str:
        """How many states were compared, in words."""
        compared = len(self.q)
        if not self.left_out:
            return f"{compared} states"
        return f"{compared} of {compared + self.left_out} states (more would take too long)"

    @property
    def singular_postures(self) -> str:
        """The first of the postures at which M is singular, and how many more there are."""
        first = ", ".join(f"{x:.4g}" for x in self.singular[0])
        more = len(self.singular) - 1
        return f"q = ({first})" + (f" and {more} more posture{'s' * (more > 1)}" if more else "")


@shown()
def verify(
    kernel: Kernel,
    robot: Robot | Model,
    *,
    states: int = 64,
    seed: int = 0,
    route: SymbolicRoute | None = None,
    functions: Sequence[UserFunction] = (),
) -> Verification:
    """Compare every function of a kernel with the route that it was not made by.

    What recursions made is compared with the symbolic route, and what was made from a closed form
    with the recursions, evaluated by NumPy.

    tau with M qdd + C qd + G + friction, and so on. Forward dynamics, and its derivatives, are put
    into the equations of motion; derivatives of tau are compared, at a few states, with
    complex-step derivatives. ``functions`` are those of one's own that the kernel was compiled
    with, whose expressions are evaluated as SymPy and NumPy do it; others are listed as unchecked.

    The states are random ones inside the joint limits, and the awkward ones there: at rest, all
    zero (or as near as the limits allow), at multiples of a quarter turn, at the limits, and many
    turns away for joints without limits. Where M is singular nothing is asked of forward dynamics.
    Run-time parameters take their defaults, and random values where they have none. A kernel in
    single precision and the symbolic route, in double, get the same numbers, rounded before: the
    errors are the kernel's own.

    Raises ValueError for a robot with another number of joints, or without a parameter that the
    kernel needs.
    """
    model = as_model(robot)
    _check_alike(kernel, model)
    rng = np.random.default_rng(seed)
    route = route or SymbolicRoute(model)
    dtype = next(s.dtype for s in kernel.signatures.values())
    state = [rounded(x, dtype) for x in states_of(model, states, rng)]
    values = parameter_values(model, rng)
    parameters = {symbol: float(rounded(value, dtype)) for symbol, value in values.items()}
    total = len(state[0])
    chosen = spread(total, route.affordable(state[0], parameters, STATES_LIMIT))
    q, qd, qdd = (x[chosen] for x in state)
    expected = ExpectedDynamics(route, q, qd, qdd, parameters, float(np.finfo(dtype).eps))
    recursive = recursively(expected)
    own = {function.name: function for function in functions}
    errors, unchecked = dict[str, Array](), dict[str, None]()
    routes = dict[str, dict[str, None]]()
    inverting = False
    for name in kernel.signatures:
        tell(f"comparing {name} with the equations")
        pairs: list[Pair] = []
        with np.errstate(all="ignore"):  # what is infinite or NaN shows in the errors
            for part, results in _results(kernel, name, expected):
                if part.name in CHECKS:
                    for x, against in others(part, expected, recursive):
                        pairs += CHECKS[part.name](x, *frame_of(part, model), *results)
                        routes.setdefault(name, {})[against] = None
                    inverting |= part.name in INVERTING
                elif part.name in own:
                    pairs += _by_expression(own[part.name], kernel, expected, results)
                    routes.setdefault(name, {})["expressions"] = None
                else:
                    unchecked[part.name] = None
            if pairs:
                errors[name] = np.concatenate([_errors(pair) for pair in pairs])
    return Verification(
        kernel.name,
        errors,
        q,
        qd,
        qdd,
        {name: ", ".join(found) for name, found in routes.items()},
        tuple(unchecked),
        TOLERANCES[dtype],
        q[~expected.regular] if inverting else q[:0],
        total - len(q),
    )


def _check_alike(kernel: Kernel, model: Model) -> None:
    """Raise unless the kernel can be one of the robot."""
    if kernel.dof != model.nv:
        raise ValueError(
            f"the kernel of {kernel.name} has {kernel.dof} joints, the robot {model.name} has "
            f"{model.nv}: verify takes the robot that the kernel was made of"
        )
    if any(part.name not in CHECKS for s in kernel.signatures.values() for part in s.parts):
        return  # functions of one's own bring parameters that the robot does not have
    there = {str(symbol) for symbol in model.defaults}
    missing = [n for n, value in kernel.parameters.items() if value is None and n not in there]
    if missing:
        raise ValueError(
            f"the kernel of {kernel.name} takes {', '.join(missing)}, which the robot {model.name} "
            "does not have: verify takes the robot that the kernel was made of"
        )


def _results(kernel: Kernel, name: str, x: ExpectedDynamics) -> Iterator[tuple[Part, list[Array]]]:
    """Yield the results of a function at the states, for each function that it is made of."""
    signature = kernel.signatures[name]
    parameters = for_kernel(kernel.parameters, x.parameters) or None
    found = getattr(kernel, name)(*map(x.given, signature.given), parameters)
    results = iter(found if len(signature.outputs) > 1 else (found,))
    for part in signature.parts:
        yield part, [next(results) for _ in range(part.outputs)]


def others(
    part: Part, symbolic: ExpectedDynamics, recursive: RecursiveDynamics
) -> Iterator[tuple[ExpectedDynamics, str]]:
    """Yield what results must be by the routes that a part was not made by, and their names."""
    if "closed form" in part.route:
        yield recursive, "recursion"
    if part.route != "closed form":
        yield symbolic, symbolic.route.name


def frame_of(part: Part, model: Model) -> list[Frame]:
    """Return the frame that a function is of, if it is of any."""
    if KNOWN[part.name].frame is None:
        return []
    return [frame_called(model, part.frame) if part.frame else model.tip]


def _by_expression(
    function: UserFunction, kernel: Kernel, x: ExpectedDynamics, found: Sequence[Array]
) -> Pairs:
    """Yield the results of a function of the user's own with the values of its expressions."""
    parameters = for_kernel(kernel.parameters, x.parameters)
    for array, expected in zip(found, by_expression(function, x, parameters), strict=True):
        undefined = np.isnan(array) & np.isnan(expected)  # a root of what is negative at a state
        yield Pair(np.where(undefined, 0, array), np.where(undefined, 0, expected))


def by_expression(
    function: UserFunction, x: ExpectedDynamics, parameters: Mapping[str, float]
) -> list[Array]:
    """Return the values of the expressions of a function of the user's own, states first."""
    scope = Scope.of(x.model, function.parameters, function.name)
    used = Formula.of(function.name, function.results, scope).used
    motion = {"q": x.q, "qd": x.qd, "qdd": x.qdd}
    values = {s: motion[a][:, i] for s, (a, i) in scope.motion.items() if s in used}
    values |= {s: parameters[str(s)] for s in scope.parameters if s in used}
    return [
        evaluated(result.entries, values, len(x.q)).reshape(-1, *result.shape)
        for result in function.results
    ]


def rounded(numbers: Any, dtype: str) -> Array:
    """Return numbers as doubles that the type holds exactly."""
    return np.asarray(numbers).astype(dtype).astype(float)


def _errors(pair: Pair) -> Array:
    """Return the errors of all states."""
    scale = np.maximum(scales(pair.expected), pair.size)
    axes = tuple(range(1, pair.expected.ndim))
    errors: Array = np.max(np.abs(pair.found - pair.expected), axis=axes) / scale
    return errors


def states_of(model: Model, states: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return states that the robot can be in: random ones first, then awkward ones."""
    n, some = model.nv, states // 8
    limits = np.array(model.ranges, dtype=float)
    lower, upper = limits[:, 0], np.minimum(limits[:, 1], limits[:, 0] + 2 * math.pi)
    revolute = np.array([kind.is_angle for kind in model.types])
    q = rng.uniform(lower, upper, (states, n))
    turned = q[:some] + 2 * math.pi * _turns(q[:some], limits, revolute, rng)
    still = np.clip(np.zeros(n), lower, upper)
    singular = np.where(revolute, _quarters(q[:some], lower, upper, rng), q[:some])
    q = np.vstack([q, still, q[0], lower, upper, turned, singular])
    qd, qdd = rng.uniform(-3, 3, q.shape), rng.uniform(-10, 10, q.shape)
    qd[states : states + 2] = 0  # at rest, at zero and elsewhere
    qdd[states : states + 2] = 0
    qd[:some, rng.integers(n)] = 0  # a joint at rest has no Coulomb friction
    return q, qd, qdd


def _turns(q: Array, limits: Array, revolute: Array, rng: np.random.Generator) -> Array:
    """Return whole turns that joints can make from q: many, where no limits are set."""
    free = (limits == (-math.pi, math.pi)).all(axis=1)
    fewest = np.where(free, -20, np.ceil((limits[:, 0] - q) / (2 * math.pi)))
    most = np.where(free, 20, np.floor((limits[:, 1] - q) / (2 * math.pi)))
    turns: Array = rng.integers(fewest.astype(int), most.astype(int), endpoint=True) * revolute
    return turns


def _quarters(q: Array, lower: Array, upper: Array, rng: np.random.Generator) -> Array:
    """Return multiples of a quarter turn inside the limits; q where there is none."""
    quarter = math.pi / 2
    first, last = np.ceil(lower / quarter), np.floor(upper / quarter)
    some = rng.integers(
        first.astype(int), np.maximum(first, last).astype(int), q.shape, endpoint=True
    )
    quarters: Array = np.where(first <= last, some * quarter, q)
    return quarters


def parameter_values(model: Model, rng: np.random.Generator) -> dict[Any, float]:
    """Return a value for each free symbol: its default, or a random one.

    That is for symbols without a default, and for those of something that the model is divided by
    and that is zero for the defaults.
    """
    defaults = {symbol: x for symbol, x in model.defaults.items() if x is not None}
    free = set(model.defaults) - set(defaults) | _divided_by_zero(model, defaults)
    return {
        symbol: float(rng.uniform(0.5, 1.5)) if symbol in free else float(default)
        for symbol, default in model.defaults.items()
    }


def _divided_by_zero(model: Model, values: Mapping[Any, Any]) -> set[Any]:
    """Return the symbols of what a scalar of the model is divided by, where that is zero."""
    free: set[Any] = set()

    def look(scalar: Any) -> Any:
        for power in sp.sympify(scalar).atoms(sp.Pow):
            if power.exp.is_negative and power.base.xreplace(values).is_zero:
                free.update(power.base.free_symbols)
        return scalar

    model.map(look)
    return free


def for_kernel(
    defaults: Mapping[str, float | None], values: Mapping[Any, float]
) -> dict[str, float]:
    """Return a value by name for each of a kernel's parameters: those of the robot, defaults, 1."""
    known = {str(symbol): value for symbol, value in values.items()}
    return {name: known.get(name, 1.0 if x is None else x) for name, x in defaults.items()}
