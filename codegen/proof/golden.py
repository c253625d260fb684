"""Golden states: what functions must return at a few states, by the route they were not made from.

What is exported carries them, so that it can be checked where it arrives: whether that compiler and
that processor compute what the equations say.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moro.model import Model
from moro_codegen.backends import numpy
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.own import UserFunction
from moro_codegen.program import Program
from moro_codegen.proof.symbolic_route import Array, ExpectedDynamics, SymbolicRoute, spread
from moro_codegen.proof.verification import (
    INVERTING,
    TOLERANCES,
    WRENCH,
    by_expression,
    for_kernel,
    frame_of,
    parameter_values,
    rounded,
    scales,
    states_of,
)
from moro_codegen.signature import Part, Signature

#: random states; awkward ones are added
STATES = 8
#: those of them at which derivatives are evaluated, each of which takes n evaluations
SLOPES = 4
#: the largest error of results in double precision, relative to their scale
TOLERANCE = 1e-12


@dataclass(frozen=True)
class GoldenResult:
    """A result at the states."""

    argument: Argument
    #: (states, ...)
    expected: Array
    #: what errors are relative to: the largest component, more where M had to be inverted (states)
    scale: Array
    #: index of the result that it is multiplied with before it is compared, a matrix by a vector
    factor: int | None = None


@dataclass(frozen=True)
class GoldenFunction:
    """A function at the states."""

    signature: Signature
    #: by name: (states, ...); the same at all states: (1, ...)
    inputs: Mapping[str, Array]
    #: what is not compared is None: it has no counterpart, or is a factor of another
    results: tuple[GoldenResult | None, ...]

    @property
    def states(self) -> int:
        """How many states there are."""
        return max(len(x) for x in self.inputs.values())


@dataclass(frozen=True)
class Golden:
    """All functions at golden states, with how much they may differ."""

    functions: tuple[GoldenFunction, ...]
    tolerance: float
    #: functions, or parts of them, that the symbolic route does not know
    unchecked: tuple[str, ...]


def golden_states(
    model: Model,
    program: Program,
    functions: Sequence[UserFunction] = (),
    route: SymbolicRoute | None = None,
) -> Golden:
    """Return the functions of a program at golden states; ``functions`` are those of one's own.

    Inputs are numbers that the program's type holds exactly.
    """
    rng = np.random.default_rng(0)
    dtype = program.signatures[0].dtype
    q, qd, qdd = (rounded(x, dtype) for x in states_of(model, STATES, rng))
    values = {s: float(rounded(x, dtype)) for s, x in parameter_values(model, rng).items()}
    rounding = float(np.finfo(dtype).eps)
    x = _AtAll(route or SymbolicRoute(model), q, qd, qdd, values, rounding)
    work = _Work(x, {p.name: p.default for p in program.parameters}, {f.name: f for f in functions})
    found = tuple(work.function(signature) for signature in program.signatures)
    tolerance = TOLERANCE if dtype == "float64" else TOLERANCES[dtype]
    return Golden(found, tolerance, tuple(work.unchecked))


def largest_errors(program: Program, golden: Golden) -> dict[str, float]:
    """Return of each function the largest error of a program that NumPy computes."""
    module: dict[str, Any] = {}
    exec(numpy.functions(program), module)  # noqa: S102 - what we have just written
    errors = {}
    for function in golden.functions:
        s = function.signature
        arrays = [function.inputs[a.name].astype(s.dtype) for a in s.inputs]
        with np.errstate(all="ignore"):  # what is infinite or NaN shows in the errors
            found = module[f"_{s.name}_of_arrays"](*arrays)
        found = found if len(s.outputs) > 1 else (found,)
        compared = [(result, found[k]) for k, result in enumerate(function.results) if result]
        errors[s.name] = max((_error(*pair, found) for pair in compared), default=0.0)
    return errors


def _error(result: GoldenResult, found: Array, all_found: Sequence[Array]) -> float:
    if result.factor is not None:
        found = np.einsum("sij,sj->si", found, all_found[result.factor])
    apart = np.abs(found - result.expected).reshape(len(result.expected), -1)
    return float(np.max(np.max(apart, axis=1) / result.scale))


#: results of the functions of the catalogue that need no more than to be asked for
DIRECT: dict[str, Callable[..., Sequence[Array]]] = {
    "tau": lambda x: [x.tau],
    "tau_with_wrench": lambda x, frame: [x.tau - WRENCH @ x.J(frame)],
    "bias": lambda x: [x.bias],
    "gravity_vector": lambda x: [x.G],
    "inertia_matrix": lambda x: [x.M],
    "coriolis_matrix": lambda x: [x.C],
    "forward_kinematics": lambda x, frame: [x.T(frame)],
    "jacobian": lambda x, frame: [x.J(frame)],
    "kinetic_energy": lambda x: [x.K],
    "potential_energy": lambda x: [x.P],
}


class _AtAll(ExpectedDynamics):
    """Derivatives too are evaluated at all states, however long it takes: the same every time."""

    @property
    def few(self) -> NDArray[np.int_]:
        """All states."""
        return np.arange(len(self.q))


class _Work:
    """The expected results, part by part."""

    def __init__(
        self,
        x: ExpectedDynamics,
        parameters: Mapping[str, float | None],
        own: Mapping[str, UserFunction],
    ) -> None:
        self.x, self.own = x, own
        self.parameters = for_kernel(parameters, x.parameters)
        self.unchecked: dict[str, None] = {}

    def function(self, signature: Signature) -> GoldenFunction:
        """Return a function at the states at which all its parts can be compared."""
        kinds = {part.name for part in signature.parts}
        states = np.arange(len(self.x.q))
        if kinds & {"tau_derivatives", "forward_dynamics_derivatives"}:
            states = spread(len(states), SLOPES)
        if kinds & INVERTING:
            states = states[self.x.regular[states]]
        x = self._at(states)
        outputs = iter(signature.outputs)
        results: list[GoldenResult | None] = []
        for part in signature.parts:
            arguments = [next(outputs) for _ in range(part.outputs)]
            found = self._part(part, x, arguments, len(results))
            if found is None:
                self.unchecked[part.name] = None
                found = [None] * len(arguments)
            results += found
        return GoldenFunction(signature, self._inputs(signature, x), tuple(results))

    def _at(self, states: Any) -> ExpectedDynamics:
        x = self.x
        if len(states) == len(x.q):
            return x
        q, qd, qdd = (y[states] for y in (x.q, x.qd, x.qdd))
        return _AtAll(x.route, q, qd, qdd, x.parameters, x.rounding)

    def _inputs(self, signature: Signature, x: ExpectedDynamics) -> dict[str, Array]:
        given = {"q": x.q, "qd": x.qd, "qdd": x.qdd, "wrench": WRENCH[np.newaxis]}
        if any(a.name == "tau" for a in signature.given):
            given["tau"] = rounded(x.tau, signature.dtype)
        if self.parameters:
            given["parameters"] = np.array([[*self.parameters.values()]])
        return {a.name: given[a.name] for a in signature.inputs}

    def _part(
        self, part: Part, x: ExpectedDynamics, arguments: Sequence[Argument], first: int
    ) -> list[GoldenResult | None] | None:
        """Return the results of a part, the ``first`` of which has that index; None: not known."""
        if part.name in DIRECT:
            return _compared(arguments, DIRECT[part.name](x, *frame_of(part, x.model)))
        if part.name == "regressor":
            return [GoldenResult(arguments[0], x.tau, scales(x.tau), first + 1), None]
        if part.name == "tau_derivatives":
            return _compared(arguments, [*x.tau_slopes, x.M])
        if part.name in INVERTING:
            return _inverted(arguments, x, part.name)
        if part.name in self.own:
            expected = by_expression(self.own[part.name], x, self.parameters)
            if all(np.isfinite(values).all() for values in expected):
                return _compared(arguments, expected)
        return None


def _compared(
    arguments: Sequence[Argument], expected: Sequence[Array]
) -> list[GoldenResult | None]:
    return [
        GoldenResult(a, values, scales(values))
        for a, values in zip(arguments, expected, strict=True)
    ]


def _inverted(
    arguments: Sequence[Argument], x: ExpectedDynamics, name: str
) -> list[GoldenResult | None]:
    """Return the accelerations, or their derivatives: - M^-1 dtau/dq, - M^-1 dtau/dqd, M^-1.

    The last digits of a solution are lost by the condition number of M, measured with each joint's
    own inertia as its unit, and by what the torques cancel to.
    """
    units = np.sqrt(np.diagonal(x.M, axis1=1, axis2=2))
    condition = np.linalg.cond(x.M / units[:, :, np.newaxis] / units[:, np.newaxis, :])
    expected: list[NDArray[Any]] = [x.qdd]
    if name != "forward_dynamics":
        expected = [-np.linalg.solve(x.M, slope) for slope in x.tau_slopes]
        expected.append(np.linalg.inv(x.M))
    found = list[GoldenResult | None]()
    for a, values in zip(arguments, expected, strict=True):
        rows = values.reshape(*units.shape, -1)
        sizes = np.max(np.abs(rows) * units[:, :, np.newaxis], axis=(1, 2))
        if name == "forward_dynamics":
            sizes = np.maximum(sizes, np.max(np.abs(x.tau) / units, axis=1))
        lost = x.model.nv * condition * sizes / units.min(axis=1)
        found.append(GoldenResult(a, values, np.maximum(scales(values), lost)))
    return found
