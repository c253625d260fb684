"""Golden states: what functions must return at a few states, by the route they were not made from.

What is exported carries them, so that it can be checked where it arrives: whether that compiler and
that processor compute what the equations say.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from moro.model import Model
from moro_codegen.backends import numpy
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.own import UserFunction
from moro_codegen.program import Program
from moro_codegen.proof.by_recursion import recursively
from moro_codegen.proof.expected import CHOSEN, ExpectedDynamics, own_name, scales
from moro_codegen.proof.results import EXPECTED, REGRESSED
from moro_codegen.proof.symbolic_route import Array, SymbolicRoute, spread
from moro_codegen.proof.verification import (
    TOLERANCES,
    by_expression,
    for_kernel,
    frame_of,
    others,
    parameter_values,
    rounded,
    states_of,
)
from moro_codegen.signature import Part, Signature

#: random states; awkward ones are added
STATES = 8
#: those of them at which derivatives are evaluated, each of which takes n evaluations, and second
#: ones, by what ``Expected.at`` says
FEWER = {"few": 4, "fewest": 2}
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
    x = ExpectedDynamics(
        route or SymbolicRoute(model), q, qd, qdd, values, rounding, everywhere=True
    )
    x.others["tau"] = rounded(x.tau, dtype)
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
        known = [EXPECTED[part.name] for part in signature.parts if part.name in EXPECTED]
        states = spread(
            len(self.x.q), min([len(self.x.q), *(FEWER.get(e.at, len(self.x.q)) for e in known)])
        )
        if any(e.at == "moving" for e in known):
            states = np.intersect1d(states, self.x.moving)
        if any(e.inverting for e in known):
            states = states[self.x.regular[states]]
        for argument in signature.given:
            self.x.given(argument)
        x = self.x.at(states)
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

    def _inputs(self, signature: Signature, x: ExpectedDynamics) -> dict[str, Array]:
        """Return the inputs by name; what is the same at all states once."""
        found = {a.name: x.given(a) for a in signature.given}
        found = {name: y[:1] if own_name(name) in CHOSEN else y for name, y in found.items()}
        if self.parameters:
            found["parameters"] = np.array([[*self.parameters.values()]])
        return {a.name: found[a.name] for a in signature.inputs}

    def _part(
        self, part: Part, x: ExpectedDynamics, arguments: Sequence[Argument], first: int
    ) -> list[GoldenResult | None] | None:
        """Return the results of a part, the ``first`` of which has that index; None: not known."""
        if part.name in EXPECTED:
            known = EXPECTED[part.name]
            other, _ = next(others(part, x, recursively(x)))
            results = known.results(other, *frame_of(part, x.model))
            return _compared(arguments, results, x.lost if known.inverting else scales)
        if part.name in REGRESSED and len(arguments) == 2:
            (product,) = EXPECTED[REGRESSED[part.name]].results(x)
            return [GoldenResult(arguments[0], product, scales(product), first + 1), None]
        if part.name in self.own:
            expected = by_expression(self.own[part.name], x, self.parameters)
            if all(np.isfinite(values).all() for values in expected):
                return _compared(arguments, expected)
        return None


def _compared(
    arguments: Sequence[Argument],
    expected: Sequence[Array],
    lost: Callable[[Array], Array] = scales,
) -> list[GoldenResult | None]:
    return [
        GoldenResult(a, values, np.maximum(scales(values), lost(values)))
        for a, values in zip(arguments, expected, strict=True)
    ]
