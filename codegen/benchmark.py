"""How long one call takes: the kernel, the same operations in NumPy, SymPy's lambdify."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from moro_codegen.kernel import Kernel
from moro_codegen.verify import parameter_values

from moro import Robot
from moro.abc import t

#: samples of a batch
BATCH = 4096
#: each function is timed in this many blocks of so many seconds; the fastest block counts
BLOCKS, BLOCK = 7, 0.02
#: more terms than this are too long for SymPy's lambdify to compile within seconds
LAMBDIFY_TERMS = 10_000


@dataclass(frozen=True)
class Timing:
    """Seconds that one evaluation of tau takes, in some way."""

    what: str
    seconds: float
    #: per sample of a batch, not of one call
    batch: bool = False


def time_tau(
    kernel: Kernel, numpy_kernel: Kernel, robot: Robot, lambdified: Callable[..., Any] | None
) -> list[Timing]:
    """Time tau at one random state inside the joint limits, and per sample of a batch."""
    rng = np.random.default_rng(0)
    low, high = np.array(robot.joint_limits, dtype=float).T
    q = rng.uniform(low, high, (BATCH, robot.dof))
    qd, qdd = rng.standard_normal((2, BATCH, robot.dof))
    values = {str(s): x for s, x in parameter_values(robot, rng).items()}
    given = {"parameters": np.array(list(values.values()))} if values else {}
    one, batch = (q[0].copy(), qd[0].copy(), qdd[0].copy()), (q, qd, qdd)
    out, outs = np.empty(robot.dof), np.empty_like(q)
    timings = [
        Timing("compiled kernel", seconds(lambda: kernel.tau(*one, out=out, **given))),
        Timing("the same in NumPy", seconds(lambda: numpy_kernel.tau(*one, **given))),
    ]
    if lambdified is not None:
        arguments = [float(x) for x in np.concatenate([*one, list(values.values())])]
        timings.append(Timing("SymPy lambdify", seconds(lambda: lambdified(*arguments))))
    per_sample = seconds(lambda: kernel.tau(*batch, out=outs, **given)) / BATCH
    timings.append(Timing("compiled kernel", per_sample, batch=True))
    per_sample = seconds(lambda: numpy_kernel.tau(*batch, **given)) / BATCH
    timings.append(Timing("the same in NumPy", per_sample, batch=True))
    return timings


def lambdify_tau(robot: Robot) -> Callable[..., Any]:
    """Return the symbolic equations through SymPy's lambdify, as a user would write it.

    Takes q, qd, qdd and the parameters as separate floats; common subexpressions are shared
    (``cse=True``) and Python's own ``math`` is used, which is faster for single numbers than NumPy.
    """
    n = robot.dof
    variables = [*robot.qs, *(q.diff(t) for q in robot.qs), *(q.diff(t, 2) for q in robot.qs)]
    plain = sp.symbols(f"q1:{n + 1} qd1:{n + 1} qdd1:{n + 1}", cls=sp.Dummy)
    # derivatives first: a position inside a derivative must not be replaced before it
    names = dict(zip(reversed(variables), reversed(plain), strict=True))
    equations = [equation.lhs.xreplace(names) for equation in robot.dynamic_model()]
    return lambdified([*plain, *robot.parameters], equations)


def lambdified(arguments: Sequence[Any], expressions: Sequence[Any]) -> Callable[..., Any]:
    """Return ``sympy.lambdify`` of expressions, for floats."""
    modules = [{"sign": np.sign}, "math"]
    function: Callable[..., Any] = sp.lambdify(arguments, expressions, modules=modules, cse=True)
    return function


def seconds(call: Callable[[], Any]) -> float:
    """Return the time of one call [s]: the mean of a block of calls, of the fastest block."""
    repeats = _repeats(call)
    enabled = gc.isenabled()
    gc.disable()
    try:
        return min(_block(call, repeats) for _ in range(BLOCKS)) / repeats
    finally:
        if enabled:
            gc.enable()


def _repeats(call: Callable[[], Any]) -> int:
    """Return how many calls fill a block."""
    repeats = 1
    while (duration := _block(call, repeats)) < BLOCK / 4:
        repeats *= 4
    return max(1, round(repeats * BLOCK / duration))


def _block(call: Callable[[], Any], repeats: int) -> float:
    count = range(repeats)
    start = time.perf_counter()
    for _ in count:
        call()
    return time.perf_counter() - start
