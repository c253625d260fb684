"""Compiled contenders: C and C++ sources to shared libraries, and loops of theirs to time.

A contender's library offers loops (``peers/loops.h``): a function of the dynamics for many samples.
All are called through the same stopwatch, in C, over the same states.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.arms import STATES, Arm, Array
from benchmarks.tasks import Task
from benchmarks.timing import Block

SOURCES = Path(__file__).parent / "peers"
#: kept between runs, beside the peers themselves
LIBRARIES = Path(__file__).parent / ".peers" / "libraries"

CC = os.environ.get("CC", "cc")
CXX = os.environ.get("CXX", "c++")
#: as moro's own kernels: for the processor at hand, nothing that changes results
FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")

_DOUBLES = ctypes.POINTER(ctypes.c_double)


class BuildError(RuntimeError):
    """A contender that does not compile; says what the compiler said."""


@dataclass(frozen=True)
class Loop:
    """One function of one contender, for one arm."""

    contender: str
    task: Task
    function: Any
    #: what the function gets as ``self``
    handle: ctypes.c_void_p | None = None
    #: what has to stay alive
    owner: Any = None


def library(
    name: str,
    texts: Mapping[str, str],
    *,
    compiler: str = CC,
    flags: Sequence[str] = (),
    link: Sequence[str] = (),
) -> ctypes.CDLL:
    """Return the library of these sources (file name: text), built unless it is there already.

    Every source is compiled on its own: no function is inlined into the loop that times it.
    """
    command = [*compiler.split(), *FLAGS, *flags, f"-I{SOURCES}"]
    shaping = repr([command, list(link), sorted(texts.items()), _version(compiler)])
    key = hashlib.sha256((shaping + (SOURCES / "loops.h").read_text()).encode()).hexdigest()
    path = LIBRARIES / f"{name}-{key[:16]}.so"
    if not path.exists():
        LIBRARIES.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=LIBRARIES) as folder:
            for file, text in texts.items():
                (Path(folder) / file).write_text(text)
            beside = Path(folder) / path.name
            _run([*command, "-o", beside.name, *texts, *link, "-lm"], folder)
            beside.replace(path)
    return ctypes.CDLL(str(path))


def compiled(texts: Mapping[str, str]) -> None:
    """Compile C sources into a library that is not kept."""
    with tempfile.TemporaryDirectory() as folder:
        for file, text in texts.items():
            (Path(folder) / file).write_text(text)
        _run([*CC.split(), *FLAGS, "-o", "library.so", *texts, "-lm"], folder)


def compilers() -> dict[str, str]:
    """Return the versions of the compilers used."""
    return {"C": _version(CC), "C++": _version(CXX)}


def handle(constructor: Any, *arguments: Any) -> ctypes.c_void_p:
    """Return what a library's ``arm_new`` makes of numbers, arrays and texts."""
    constructor.restype = ctypes.c_void_p
    kept = [np.ascontiguousarray(a) if isinstance(a, np.ndarray) else a for a in arguments]
    made = constructor(
        *[a.ctypes.data_as(ctypes.c_void_p) if hasattr(a, "ctypes") else a for a in kept]
    )
    if not made:
        raise RuntimeError("the library made no arm of these numbers")
    return ctypes.c_void_p(made)


class Run:
    """A loop with its states and results in place."""

    def __init__(self, loop: Loop, arm: Arm) -> None:
        self.loop = loop
        task, dof = loop.task, arm.dof
        self._inputs = [np.ascontiguousarray(arm.states[name]) for name in task.inputs]
        self.results = [np.full((STATES, size), np.nan) for size in task.output_sizes(dof)]
        self._sizes = [
            (ctypes.c_size_t * len(sizes))(*sizes)
            for sizes in (task.input_sizes(dof), task.output_sizes(dof))
        ]

    def seconds(self, count: int, passes: int, dependent: bool = False) -> float:
        """Return the seconds that all states take, in batches of count, passes times over.

        If ``dependent``, a batch begins when the last is done, else the processor may overlap them.
        """
        in_sizes, out_sizes = self._sizes
        return float(
            _stopwatch()(
                ctypes.cast(self.loop.function, ctypes.c_void_p),
                self.loop.handle,
                ctypes.c_size_t(len(self._inputs)),
                in_sizes,
                _pointers(self._inputs),
                ctypes.c_size_t(len(self.results)),
                out_sizes,
                _pointers(self.results),
                ctypes.c_size_t(STATES),
                ctypes.c_size_t(count),
                ctypes.c_size_t(passes),
                ctypes.c_int(dependent),
            )
        )

    def block(self, count: int = STATES, dependent: bool = False) -> Block:
        """Return a block that evaluates all states once a pass."""
        return lambda passes: self.seconds(count, passes, dependent)

    def computed(self) -> Array:
        """Return the results at all states, one row each."""
        self.seconds(STATES, 1)
        return np.concatenate(self.results, axis=1)


def _pointers(arrays: Sequence[Array]) -> Any:
    return (_DOUBLES * len(arrays))(*[a.ctypes.data_as(_DOUBLES) for a in arrays])


@lru_cache(maxsize=1)
def _stopwatch() -> Any:
    function = library(
        "stopwatch", {"stopwatch.c": (SOURCES / "stopwatch.c").read_text()}
    ).stopwatch
    function.restype = ctypes.c_double
    return function


@lru_cache(maxsize=4)
def _version(compiler: str) -> str:
    done = subprocess.run(
        [*compiler.split(), "--version"], capture_output=True, text=True, check=False
    )
    return done.stdout.splitlines()[0] if done.stdout else ""


def _run(command: Sequence[str], folder: str) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BuildError(f"{' '.join(command)}\n{done.stderr[-4000:]}")
