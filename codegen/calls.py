"""Calls of a kernel's functions: what they give is checked, what they get back is made.

This file needs nothing but NumPy. moro's own kernels use it, and a copy of it is part of every
Python module and Cython package that moro writes: all take the same arguments, and say the same of
wrong ones.
"""

from __future__ import annotations

import difflib
import inspect
import itertools
import math
import operator
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np

#: what is worth a thread, in operations: fewer take less time than waking it
WORTHWHILE = 1_000_000
#: threads at work at one time, whatever is asked for: more than a few for each core gain nothing
MOST_THREADS = 4 * (os.cpu_count() or 1)
#: samples that NumPy works on at once, so that its intermediate results stay in the cache
CHUNK = 4096
#: more work than this to find out whether two arrays overlap, and we say they do
OVERLAP_WORK = 10_000

_OPTIONAL = ("parameters", "out")


class Operand(NamedTuple):
    """An array that a function takes or returns: its shape for one sample, and what it is."""

    name: str
    shape: tuple[int, ...]
    description: str = ""


def parameters_operand(count: int) -> tuple[Operand, ...]:
    """Return so many run-time parameters as one array, the last input; none if there are none."""
    return (Operand("parameters", (count,), "run-time parameters, in order"),) if count else ()


class Calls:
    """The calls of one function: f(*inputs, parameters=None, out=None, *, threads=1).

    Inputs are whatever NumPy makes arrays of real numbers of; axes in front of those of one sample
    are broadcast. Everything else raises TypeError or ValueError, which name the argument, what was
    expected and what was found.
    """

    def __init__(
        self,
        name: str,
        inputs: tuple[Operand, ...],
        outputs: tuple[Operand, ...],
        parameters: Mapping[str, float | None],
        operations: int,
        dtype: str = "float64",
    ) -> None:
        """Describe a function whose arrays are of ``dtype``, float64 or float32.

        ``parameters`` are the names and defaults (None: has to be given) of run-time parameters, in
        order; a sample takes so many ``operations``.
        """
        self.name, self.inputs, self.outputs = name, inputs, outputs
        self.parameters, self.operations, self.dtype = parameters, operations, dtype

    @cached_property
    def operands(self) -> tuple[Operand, ...]:
        """What is read: the inputs, then the run-time parameters as one array if there are any."""
        return (*self.inputs, *parameters_operand(len(self.parameters)))

    @property
    def text(self) -> str:
        """The call: tau(q, qd, qdd, parameters=None, out=None, *, threads=1)."""
        names = ", ".join(a.name for a in self.inputs)
        return f"{self.name}({names}, parameters=None, out=None, *, threads=1)"

    # -- functions ---------------------------------------------------------------------------------

    def function(
        self,
        run: Callable[[Sequence[Any], Sequence[Any]], None],
        doc: str | None,
        direct: Callable[..., Any] | None = None,
        module: str = __name__,
    ) -> Callable[..., Any]:
        """Return the function: it checks its arguments, then ``run(operands, results)`` fills.

        ``direct(*operands)``, if there is one, is tried first: it returns the results for arrays
        that need no check, and NotImplemented for others. What other processes get for the function
        is its attribute ``public``, if it has one.
        """

        def general(*args: Any, **keywords: Any) -> Any:
            given, parameters, out, threads = self._bind(args, keywords)
            arrays = [self._array(a, x) for a, x in zip(self.inputs, given, strict=True)]
            arrays += self._parameter_arrays(parameters)
            if any(map(_is_lazy, arrays)):
                return self._lazily(getattr(function, "public", function), arrays, out, threads)
            samples = self._samples(arrays)
            shapes = [samples + a.shape for a in self.outputs]
            if out is None:
                results = [np.empty(shape, self.dtype) for shape in shapes]
            else:
                results = self._results(out, shapes, arrays)
            if threads == 1:
                run(arrays, results)
            else:
                self._run_in_threads(run, arrays, results, samples, threads)
            if out is not None:
                return out
            values = tuple([result if result.ndim else result[()] for result in results])
            return values if len(values) > 1 else values[0]

        function = general if direct is None else self._first(direct, general)
        function.__name__ = function.__qualname__ = self.name
        function.__doc__, function.__module__ = doc, module
        function.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [
                *(inspect.Parameter(a.name, _EITHER_WAY) for a in self.inputs),
                *(inspect.Parameter(name, _EITHER_WAY, default=None) for name in _OPTIONAL),
                inspect.Parameter("threads", inspect.Parameter.KEYWORD_ONLY, default=1),
            ]
        )
        return function

    def of_arrays(self, function: Callable[..., Any], module: str = __name__) -> Callable[..., Any]:
        """Return the function of one that computes with arrays of NumPy, and returns new ones."""
        return self.function(self.in_chunks(function), function.__doc__, module=module)

    def in_chunks(
        self, function: Callable[..., Any]
    ) -> Callable[[Sequence[Any], Sequence[Any]], None]:
        """Return a run of such a function, through many samples CHUNK by CHUNK."""

        def fill(arrays: Sequence[Any], results: Sequence[Any]) -> None:
            values = function(*arrays)
            for result, value in zip(
                results, values if len(self.outputs) > 1 else (values,), strict=True
            ):
                result[...] = value

        def run(arrays: Sequence[Any], results: Sequence[Any]) -> None:
            samples = results[0].shape[: results[0].ndim - len(self.outputs[0].shape)]
            count = math.prod(samples)
            with np.errstate(all="ignore"):
                if count <= CHUNK:
                    fill(arrays, results)
                    return
                rows = [
                    x.reshape(count, *a.shape)
                    for a, x in zip(self.operands, self._broadcast(arrays, samples), strict=True)
                ]
                flat = [np.empty((count, *a.shape), self.dtype) for a in self.outputs]
                for start in range(0, count, CHUNK):
                    part = slice(start, start + CHUNK)
                    fill([x[part] for x in rows], [y[part] for y in flat])
            for result, value in zip(results, flat, strict=True):
                result[...] = value.reshape(result.shape)

        return run

    def _first(self, direct: Callable[..., Any], general: Callable[..., Any]) -> Callable[..., Any]:
        defaults = [default for default in self.parameters.values() if default is not None]
        if len(defaults) < len(self.parameters):
            return general
        constants = [np.array(defaults, self.dtype)] if defaults else []
        count = len(self.inputs)

        def function(*args: Any, **keywords: Any) -> Any:
            if not keywords and len(args) == count:
                found = direct(*args, *constants)
                if found is not NotImplemented:
                    return found
            return general(*args, **keywords)

        return function

    # -- arguments ---------------------------------------------------------------------------------

    def _bind(
        self, args: Sequence[Any], keywords: Mapping[str, Any]
    ) -> tuple[Sequence[Any], Any, Any, int]:
        """Return the inputs in order, the parameters, ``out`` and ``threads``."""
        threads = 1
        if "threads" in keywords:
            keywords = dict(keywords)
            threads = self._count_of_threads(keywords.pop("threads"))
        names = [*[a.name for a in self.inputs], *_OPTIONAL]
        if len(args) > len(names):
            raise TypeError(f"{self.text} takes {len(names)} arguments, found {len(args)}")
        bound = dict(zip(names, args, strict=False))
        for name, value in keywords.items():
            if name not in names:
                raise TypeError(f"{self.text} has no argument {name!r}{_nearest(name, names)}")
            if name in bound:
                raise TypeError(f"{self.text}: {name} is given twice")
            bound[name] = value
        missing = [a.name for a in self.inputs if a.name not in bound]
        if missing:
            raise TypeError(f"{self.text}: {', '.join(missing)} missing")
        given = [bound[a.name] for a in self.inputs]
        return given, bound.get("parameters"), bound.get("out"), threads

    def _count_of_threads(self, given: Any) -> int:
        try:
            threads = operator.index(given)
        except TypeError:
            raise TypeError(f"{self.name}: threads must be an integer, not {given!r}") from None
        if threads < 1:
            raise ValueError(f"{self.name}: threads must be at least 1, not {threads}")
        return threads

    def _array(self, a: Operand, value: Any) -> Any:
        """Return an input as an array of the right type and with the right last axes."""
        if _is_masked(value):
            raise ValueError(f"{self.name}: {a.name} has masked entries")
        try:
            array = value if _is_lazy(value) else np.asarray(value)
        except ValueError as error:
            raise ValueError(f"{self.name}: {a.name} is no array: {error}") from None
        if array.dtype.kind not in "iuf":
            raise TypeError(
                f"{self.name}: {a.name} must hold real numbers, found {array.dtype} "
                f"({_short(value)})"
            )
        if array.shape[max(array.ndim - len(a.shape), 0) :] != a.shape:
            if _is_asked_by_dask():
                return np.zeros((*array.shape[: array.ndim - len(a.shape)], *a.shape), self.dtype)
            raise ValueError(
                f"{self.name}: {a.name} ({a.description}) must have shape "
                f"{_either_shape(a.shape)}, found {array.shape}"
            )
        return array if _is_lazy(array) else np.asarray(array, dtype=self.dtype)

    def _parameter_arrays(self, given: Any) -> list[Any]:
        """Return the run-time parameters as the last axis of one array; none if there are none."""
        if not self.parameters:
            empty = len(given) == 0 if isinstance(given, Mapping) else np.size(given) == 0
            if given is not None and not empty:
                raise TypeError(f"{self.name}: the model has no run-time parameters")
            return []
        if given is not None and not isinstance(given, Mapping):
            return [self._array(self.operands[-1], given)]
        by_name = {str(name): value for name, value in (given or {}).items()}
        names = list(self.parameters)
        for name in by_name:
            if name not in names:
                raise TypeError(f"{self.name}: no parameter {name!r}{_nearest(name, names)}")
        values = [by_name.get(name, default) for name, default in self.parameters.items()]
        missing = [name for name, value in zip(names, values, strict=True) if value is None]
        if missing:
            hint = ", ".join(f"{name!r}: ..." for name in missing)
            raise TypeError(
                f"{self.name}: no value and no default for {', '.join(missing)}: "
                f"give parameters={{{hint}}}"
            )
        columns = [
            self._array(Operand(name, (), "a run-time parameter"), value)
            for name, value in zip(names, values, strict=True)
        ]
        return [np.stack(np.broadcast_arrays(*columns), axis=-1)]

    def _samples(self, arrays: Sequence[Any]) -> tuple[int, ...]:
        """Return the shape of the samples: all axes in front of the components, broadcast."""
        operands = list(zip(self.operands, arrays, strict=True))
        leading: set[tuple[int, ...]] = {x.shape[: x.ndim - len(a.shape)] for a, x in operands}
        if len(leading) == 1:
            return leading.pop()
        try:
            return np.broadcast_shapes(*leading)
        except ValueError:
            found = ", ".join(f"{a.name} {x.shape}" for a, x in operands)
            raise ValueError(
                f"{self.name}: the axes in front of the components do not match: {found}"
            ) from None

    def _broadcast(self, arrays: Sequence[Any], samples: tuple[int, ...]) -> list[Any]:
        """Return the arrays with all samples."""
        return [
            np.broadcast_to(x, samples + a.shape)
            for a, x in zip(self.operands, arrays, strict=True)
        ]

    # -- results -----------------------------------------------------------------------------------

    def _results(
        self, out: Any, shapes: Sequence[tuple[int, ...]], arrays: Sequence[Any]
    ) -> list[Any]:
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
                *zip(self.operands, arrays, strict=True),
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
        if _is_masked(out):
            raise ValueError(f"{self.name}: out has masked entries")
        if _meets_itself(out):
            raise ValueError(f"{self.name}: out has several components in one place of memory")

    # -- arrays of Dask ----------------------------------------------------------------------------

    def _lazily(
        self, function: Callable[..., Any], arrays: Sequence[Any], out: Any, threads: int
    ) -> Any:
        """Return results as arrays of Dask: ``function`` of every chunk of the samples."""
        if out is not None:
            raise TypeError(f"{self.name}: results of Dask's arrays are Dask's: leave out= out")
        if not any(np.isnan(n) for x in arrays for n in x.shape):
            self._samples(arrays)
        before, after = (
            ",".join(f"({','.join(map(str, a.shape))})" for a in operands)
            for operands in (self.operands, self.outputs)
        )
        dask: Any = sys.modules["dask.array"]  # which nobody here imports: its arrays are given
        return dask.apply_gufunc(
            function,
            f"{before}->{after}",
            *arrays,
            output_dtypes=[self.dtype] * len(self.outputs),
            output_sizes={str(n): n for a in self.outputs for n in a.shape},
            allow_rechunk=True,
            **({} if threads == 1 else {"threads": threads}),
        )

    # -- threads -----------------------------------------------------------------------------------

    def _run_in_threads(
        self,
        run: Callable[[Sequence[Any], Sequence[Any]], None],
        arrays: Sequence[Any],
        results: Sequence[Any],
        samples: tuple[int, ...],
        threads: int,
    ) -> None:
        """Run in at most so many threads, each with enough to do."""
        work = math.prod(samples) * self.operations
        wide = self._broadcast(arrays, samples)
        in_threads(run, wide, results, samples, min(threads, work // WORTHWHILE))


def in_threads(
    run: Callable[[Sequence[Any], Sequence[Any]], None],
    arrays: Sequence[Any],
    results: Sequence[Any],
    samples: tuple[int, ...],
    threads: int,
) -> None:
    """Call ``run(arrays, results)`` for parts of the samples, each in a thread.

    ``samples`` are the first axes of all arrays; the longest of them is divided. ``run`` should
    let go of the interpreter's lock while it computes.
    """
    axis = int(np.argmax(samples)) if samples else 0
    threads = min(threads, samples[axis] if samples else 1, MOST_THREADS)
    if threads <= 1:
        run(arrays, results)
        return
    ends = [samples[axis] * k // threads for k in range(threads + 1)]
    parts = [(*(slice(None),) * axis, slice(start, end)) for start, end in itertools.pairwise(ends)]

    def compute(part: tuple[slice, ...]) -> None:
        run([x[part] for x in arrays], [y[part] for y in results])

    others = [_pool().submit(compute, part) for part in parts[1:]]
    try:
        compute(parts[0])
    finally:
        wait(others)
    for other in others:
        other.result()


@cache
def _pool() -> ThreadPoolExecutor:
    """Return the threads that wait for work: it starts one only where none is idle."""
    return ThreadPoolExecutor(MOST_THREADS, thread_name_prefix="moro")


if hasattr(os, "register_at_fork"):  # a child process has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)

_EITHER_WAY = inspect.Parameter.POSITIONAL_OR_KEYWORD


def _is_masked(value: Any) -> bool:
    """Tell whether entries of an array, or of arrays in a list, are masked."""
    if isinstance(value, (list, tuple)):
        return any(np.ma.is_masked(x) for x in value if isinstance(x, np.ma.MaskedArray))
    return isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value)


def _is_lazy(value: Any) -> bool:
    """Tell whether this is an array of Dask."""
    dask = sys.modules.get("dask.array")
    return dask is not None and isinstance(value, getattr(dask, "Array", ()))


def _is_asked_by_dask() -> bool:
    """Tell whether Dask tries the function, on arrays of size 0 or 1, to see what it returns."""
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        asks = frame.f_code.co_name in ("apply_infer_dtype", "compute_meta")
        if asks and frame.f_globals.get("__name__", "").startswith("dask."):
            return True
    return False


def _overlap(a: Any, b: Any) -> bool:
    try:
        return np.shares_memory(a, b, max_work=OVERLAP_WORK)  # type: ignore[arg-type]
    except np.exceptions.TooHardError:
        return True


def _meets_itself(a: Any) -> bool:
    """Tell whether two components of an array share memory, as those of sliding windows do."""
    if not a.size:
        return False
    axes = sorted((abs(s), n) for s, n in zip(a.strides, a.shape, strict=True) if n > 1)
    reach = a.itemsize
    for step, n in axes:
        if step < reach:
            break
        reach += step * (n - 1)
    else:
        return False  # each step goes beyond all that the shorter ones reach
    places = np.zeros(1, np.intp)
    for step, n in axes:
        places = (places[:, None] + step * np.arange(n)).ravel()
    return bool(np.diff(np.sort(places)).min() < a.itemsize)


def _either_shape(shape: tuple[int, ...]) -> str:
    """Return ``(6,) or (..., 6)``."""
    if not shape:
        return "() or (...)"
    return f"{shape} or (..., {', '.join(map(str, shape))})"


def _nearest(name: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(name, names, n=1)
    return f", did you mean {near[0]!r}?" if near else f": there are {', '.join(names)}"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."
