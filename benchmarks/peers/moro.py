"""moro's own kernels: one sample a call, and whole batches."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator

import numpy as np

import moro
import moro_codegen as mc
from benchmarks.arms import Arm
from benchmarks.native import LIBRARIES, Loop, library
from benchmarks.tasks import Call, Task
from benchmarks.timing import seconds_of
from moro_codegen.backends.toolchain import find_compiler

MADE = CALL = "moro"
BATCH = "moro, batch"

VERSIONS = {"moro": moro.__version__}
FLAGS = find_compiler().flags
KERNELS = LIBRARIES / "kernels"


def kernel(arm: Arm, function: str) -> mc.Kernel:
    """Return the kernel of one function of an arm."""
    return mc.compile(arm.robot, functions=(function,), directory=KERNELS)


def offers(function: str) -> bool:
    """Tell whether moro has this function."""
    return function in mc.FUNCTIONS


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield the function as calls and as one batch."""
    if not offers(task.name):
        return
    compiled = kernel(arm, task.name)
    signature = compiled.signatures[task.name]
    sizes = [int(np.prod(a.shape)) for a in (*signature.inputs, *signature.outputs)]
    expected = task.input_sizes(arm.dof) + task.output_sizes(arm.dof)
    names = tuple(a.name for a in signature.inputs)
    if sum(sizes) != sum(expected) or names != task.inputs:
        raise ValueError(f"{task.name} of {arm.label} takes and returns {names}, {sizes}")
    places = [f"in[{k}]" for k in range(len(names))]
    places += [f"out[{k}]" for k in range(len(signature.outputs))]
    call = ", ".join(f"{place} + i * {n}" for place, n in zip(places, sizes, strict=True))
    strides = ", ".join(
        ", ".join([place, str(n), *_steps(a.shape)])
        for place, n, a in zip(places, sizes, (*signature.inputs, *signature.outputs), strict=True)
    )
    name = f"{compiled.name}_{task.name}"
    text = f"""\
#include "loops.h"
#include "{compiled.header}"

void calls(void *self, size_t count, const double *const *in, double *const *out) {{
  (void)self;
  for (size_t i = 0; i < count; ++i) {name}({call});
}}

void batch(void *self, size_t count, const double *const *in, double *const *out) {{
  (void)self;
  {name}_batch(count, {strides});
}}
"""
    link = (str(compiled.library), f"-Wl,-rpath,{compiled.directory}")
    made = library(f"moro-{name}", {"loops.c": text}, link=link)
    yield Loop(CALL, task, made.calls, owner=made)
    yield Loop(BATCH, task, made.batch, owner=made)


def _steps(shape: tuple[int, ...]) -> list[str]:
    """Return the strides along the axes of one sample, row-major."""
    return [str(int(np.prod(shape[k + 1 :]))) for k in range(len(shape))]


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield tau from Python, in the ways that a user has."""
    tau, out = kernel(arm, "tau").tau, np.empty(arm.dof)
    yield Call("moro, out=", lambda q, qd, qdd: tau(q, qd, qdd, out=out))
    yield Call("moro", tau)
    yield Call("moro, NumPy backend", mc.compile(arm.robot, directory=KERNELS, backend="numpy").tau)


def making(arm: Arm) -> tuple[float, float]:
    """Return the seconds of generating C text of tau and of the compiler, from nothing."""
    with tempfile.TemporaryDirectory() as folder:
        return seconds_of(lambda: mc.compile(arm.robot, directory=folder))
