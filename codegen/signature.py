"""What a kernel's function takes and returns: kept in the manifest, said in docstrings, checked.

``Signature.checked`` makes the Python function that takes whatever NumPy makes an array of,
broadcasts leading axes, and says of everything else what is wrong with it.
"""

from __future__ import annotations

import difflib
import inspect
import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from moro_codegen.emit.describe import all_inputs, argument_lines, core_shapes, operations, shape
from moro_codegen.functions import Argument
from moro_codegen.generate import Parameter, Program, Routine
from moro_codegen.threads import WORTHWHILE, in_threads

Array: TypeAlias = NDArray[np.floating[Any]]
#: fills arrays of results: run(inputs, results)
Run: TypeAlias = Callable[[Sequence[Array], Sequence[Array]], None]

#: NumPy's names of C's types
DTYPES = {"double": "float64", "float": "float32"}

#: more work than this to find out whether two arrays overlap, and we say they do
OVERLAP_WORK = 10_000

_OPTIONAL = ("parameters", "out")
_KEYWORDS = frozenset(_OPTIONAL)


@dataclass(frozen=True)
class Signature:
    """A function of a kernel: what it computes, from what, with how many operations."""

    name: str
    summary: str
    #: run-time parameters, as one array, are the last input if there are any
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    parameters: tuple[Parameter, ...]
    ops: Mapping[str, int]
    #: of all arrays: float64 or float32
    dtype: str = "float64"

    @classmethod
    def of(cls, program: Program, routine: Routine) -> Signature:
        """Return the signature of a routine."""
        return cls(
            routine.function.name,
            routine.function.summary,
            all_inputs(program, routine),
            routine.outputs,
            program.parameters,
            routine.ops,
            DTYPES[program.scalar],
        )

    def as_json(self) -> dict[str, Any]:
        """Return the signature in the types of JSON."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Signature:
        """Return the signature that ``as_json`` wrote."""

        def arguments(items: Sequence[Mapping[str, Any]]) -> tuple[Argument, ...]:
            return tuple(Argument(**{**item, "shape": tuple(item["shape"])}) for item in items)

        return cls(
            **{
                **data,
                "inputs": arguments(data["inputs"]),
                "outputs": arguments(data["outputs"]),
                "parameters": tuple(Parameter(**item) for item in data["parameters"]),
            }
        )

    # -- in words --------------------------------------------------------------------------------

    @property
    def core(self) -> str:
        """The shapes as NumPy writes them for its generalized functions: (6),(6),(6)->(6)."""
        return core_shapes(self.inputs, self.outputs)

    @cached_property
    def given(self) -> tuple[Argument, ...]:
        """The inputs that a call must name: all but the run-time parameters."""
        return self.inputs[:-1] if self.parameters else self.inputs

    @property
    def call(self) -> str:
        """The call: tau(q, qd, qdd, parameters=None, out=None, *, threads=1)."""
        names = ", ".join(a.name for a in self.given)
        return f"{self.name}({names}, parameters=None, out=None, *, threads=1)"

    @property
    def doc(self) -> str:
        """What the function's users read."""
        returned = ", ".join(a.name for a in self.outputs)
        lines = [
            self.summary,
            "",
            f"Takes arrays of {self.dtype}, or what NumPy makes them of. Further axes in front are",
            "samples, and are broadcast against each other.",
            "",
            *argument_lines(self.given),
            "",
            f"Returns {returned}:",
            "",
            *argument_lines(self.outputs),
            "",
        ]
        if self.parameters:
            lines += [
                "Run-time parameters, as a dict by name, a sequence in this order, or None for the",
                "defaults:",
                "",
                *(_parameter_line(p) for p in self.parameters),
                "",
            ]
        else:
            lines += ["The model has no run-time parameters: ``parameters`` is None.", ""]
        out = "a tuple of arrays" if len(self.outputs) > 1 else "an array"
        return "\n".join(
            [
                *lines,
                f"``out``: {out} of {self.dtype} for the result; it must not overlap an input.",
                "``threads``: so many share a large batch's samples; the results are the same.",
                "",
                f"Takes {operations(self)}.",
            ]
        )

    # -- in code ---------------------------------------------------------------------------------

    def checked(self, run: Run) -> Callable[..., Any]:
        """Return a function that checks its arguments, then lets ``run`` fill the results."""
        cores = [shape(a) for a in self.outputs]

        def function(*args: Any, **keywords: Any) -> Any:
            given, parameters, out, threads = self._bind(args, keywords)
            inputs = [self._array(a, x) for a, x in zip(self.given, given, strict=True)]
            if self.parameters:
                inputs.append(self._parameter_array(parameters))
            elif parameters is not None:
                raise TypeError(f"{self.name}: the model has no run-time parameters")
            samples = self._samples(inputs)
            shapes = [samples + core for core in cores]
            if out is None:
                results = [np.empty(shape, self.dtype) for shape in shapes]
            else:
                results = self._checked_out(out, shapes, inputs)
            if threads == 1:
                run(inputs, results)
            else:
                self._run_in_threads(run, inputs, results, samples, threads)
            if out is not None:
                return out
            values = tuple([result if result.ndim else result[()] for result in results])
            return values if len(values) > 1 else values[0]

        function.__name__ = function.__qualname__ = self.name
        function.__doc__ = self.doc
        function.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [
                inspect.Parameter(
                    name,
                    inspect.Parameter.POSITIONAL_OR_KEYWORD,
                    default=None if name in _OPTIONAL else inspect.Parameter.empty,
                )
                for name in (*(a.name for a in self.given), *_OPTIONAL)
            ]
            + [inspect.Parameter("threads", inspect.Parameter.KEYWORD_ONLY, default=1)]
        )
        return function

    def _bind(
        self, args: Sequence[Any], keywords: Mapping[str, Any]
    ) -> tuple[Sequence[Any], Any, Any, int]:
        """Return the inputs in order, the parameters, ``out`` and ``threads``."""
        threads = 1
        if "threads" in keywords:
            keywords = dict(keywords)
            threads = self._count_of_threads(keywords.pop("threads"))
        if len(args) == len(self.given) and keywords.keys() <= _KEYWORDS:
            return args, keywords.get("parameters"), keywords.get("out"), threads
        names = [*[a.name for a in self.given], *_OPTIONAL]
        if len(args) > len(names):
            raise TypeError(f"{self.call} takes {len(names)} arguments, found {len(args)}")
        bound = dict(zip(names, args, strict=False))
        for name, value in keywords.items():
            if name not in names:
                raise TypeError(f"{self.call} has no argument {name!r}{_nearest(name, names)}")
            if name in bound:
                raise TypeError(f"{self.call}: {name} is given twice")
            bound[name] = value
        missing = [a.name for a in self.given if a.name not in bound]
        if missing:
            raise TypeError(f"{self.call}: {', '.join(missing)} missing")
        given = [bound[a.name] for a in self.given]
        return given, bound.get("parameters"), bound.get("out"), threads

    def _count_of_threads(self, given: Any) -> int:
        try:
            threads = operator.index(given)
        except TypeError:
            raise TypeError(f"{self.name}: threads must be an integer, not {given!r}") from None
        if threads < 1:
            raise ValueError(f"{self.name}: threads must be at least 1, not {threads}")
        return threads

    def _run_in_threads(
        self,
        run: Run,
        inputs: Sequence[Array],
        results: Sequence[Array],
        samples: tuple[int, ...],
        threads: int,
    ) -> None:
        """Run in at most so many threads, each with enough to do."""
        work = math.prod(samples) * sum(self.ops.values())
        wide = [
            np.broadcast_to(x, samples + shape(a)) for a, x in zip(self.inputs, inputs, strict=True)
        ]
        in_threads(run, wide, results, samples, min(threads, work // WORTHWHILE))

    def _array(self, argument: Argument, value: Any) -> Array:
        """Return an input as an array of the right type and with the right last axes."""
        try:
            array = np.asarray(value)
        except ValueError as error:
            raise ValueError(f"{self.name}: {argument.name} is no array: {error}") from None
        if array.dtype.kind not in "iuf":
            raise TypeError(
                f"{self.name}: {argument.name} must hold real numbers, found {array.dtype} "
                f"({_short(value)})"
            )
        core = argument.shape
        if array.shape[max(array.ndim - len(core), 0) :] != core:
            raise ValueError(
                f"{self.name}: {argument.name} ({argument.description}) must have shape "
                f"{_shape_text(core)}, found {array.shape}"
            )
        return np.asarray(array, dtype=self.dtype)

    def _parameter_array(self, given: Any) -> Array:
        """Return the run-time parameters as the last axis of one array."""
        argument = self.inputs[-1]
        if given is not None and not isinstance(given, Mapping):
            return self._array(argument, given)
        by_name = {str(name): value for name, value in (given or {}).items()}
        names = [parameter.name for parameter in self.parameters]
        for name in by_name:
            if name not in names:
                raise TypeError(f"{self.name}: no parameter {name!r}{_nearest(name, names)}")
        values = [by_name.get(p.name, p.default) for p in self.parameters]
        missing = [name for name, value in zip(names, values, strict=True) if value is None]
        if missing:
            hint = ", ".join(f"{name!r}: ..." for name in missing)
            raise TypeError(
                f"{self.name}: no value and no default for {', '.join(missing)}: "
                f"give parameters={{{hint}}}"
            )
        columns = [
            self._array(Argument(name, (), argument.unit, "a run-time parameter"), value)
            for name, value in zip(names, values, strict=True)
        ]
        return np.stack(np.broadcast_arrays(*columns), axis=-1)

    def _samples(self, inputs: Sequence[Array]) -> tuple[int, ...]:
        """Return the shape of the samples: all axes in front of the components, broadcast."""
        leading = {
            array.shape[: array.ndim - len(a.shape)]
            for a, array in zip(self.inputs, inputs, strict=True)
        }
        if len(leading) == 1:
            return leading.pop()
        try:
            return np.broadcast_shapes(*leading)
        except ValueError:
            found = ", ".join(
                f"{a.name} {array.shape}" for a, array in zip(self.inputs, inputs, strict=True)
            )
            raise ValueError(
                f"{self.name}: the axes in front of the components do not match: {found}"
            ) from None

    def _checked_out(
        self, out: Any, shapes: Sequence[tuple[int, ...]], inputs: Sequence[Array]
    ) -> list[Array]:
        """Return ``out`` as a list of arrays, if results of these shapes can be put there."""
        if len(shapes) == 1:
            given = [out]
        elif isinstance(out, tuple) and len(out) == len(shapes):
            given = list(out)
        else:
            raise TypeError(f"{self.name}: out must be a tuple of {len(shapes)} arrays")
        for k, (expected, result) in enumerate(zip(shapes, given, strict=True)):
            self._check_result(result, expected)
            for a, other in [
                *zip(self.inputs, inputs, strict=True),
                *zip(self.outputs, given[:k], strict=False),
            ]:
                if _overlap(result, other):
                    raise ValueError(f"{self.name}: out overlaps {a.name} in memory")
        return given

    def _check_result(self, out: Any, expected: tuple[int, ...]) -> None:
        if not isinstance(out, np.ndarray):
            raise TypeError(f"{self.name}: out must be a NumPy array, found {_short(out)}")
        if out.dtype != self.dtype:
            raise TypeError(f"{self.name}: out must hold {self.dtype}, found {out.dtype}")
        if out.shape != expected:
            raise ValueError(f"{self.name}: out must have shape {expected}, found {out.shape}")
        if not out.flags.writeable:
            raise ValueError(f"{self.name}: out is read-only")
        if out.size and any(n > 1 and s == 0 for s, n in zip(out.strides, out.shape, strict=True)):
            raise ValueError(f"{self.name}: out has several components in one place of memory")


def _overlap(a: Array, b: Array) -> bool:
    try:
        return np.shares_memory(a, b, max_work=OVERLAP_WORK)  # type: ignore[arg-type]
    except np.exceptions.TooHardError:
        return True


def _shape_text(core: Sequence[str | int]) -> str:
    """Return ``(6,) or (..., 6)``."""
    if not core:
        return "() or (...)"
    return f"{tuple(core)} or (..., {', '.join(map(str, core))})"


def _nearest(name: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(name, names, n=1)
    return f", did you mean {near[0]!r}?" if near else f": there are {', '.join(names)}"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _parameter_line(parameter: Parameter) -> str:
    default = "no default" if parameter.default is None else f"default {parameter.default!r}"
    return f"{parameter.name}  ({default})  {parameter.description}".rstrip()
