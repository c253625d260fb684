"""How long one call takes: the kernel, the same operations in NumPy, SymPy's lambdify."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from timeit import Timer
from typing import Any

import numpy as np
import sympy as sp

from moro import Robot
from moro.abc import t
from moro_codegen.kernel.kernel import Kernel
from moro_codegen.progress import tell
from moro_codegen.proof.verification import for_kernel, parameter_values

#: samples of a batch
BATCH = 4096
#: each function is timed in this many blocks of so many seconds; the fastest block counts
BLOCKS, BLOCK = 5, 0.015
#: more terms than this are too long for SymPy's lambdify to compile within seconds
LAMBDIFY_TERMS = 10_000


@dataclass(frozen=True)
class Timing:
    """Seconds that one evaluation of a function takes, in some way."""

    what: str
    seconds: float
    #: per sample of a batch, not of one call
    batch: bool = False
    function: str = "tau"


def time_tau(
    kernel: Kernel, numpy_kernel: Kernel, robot: Robot, lambdified: Callable[..., Any] | None
) -> list[Timing]:
    """Time tau at one random state inside the joint limits, and per sample of a batch."""
    rng = np.random.default_rng(0)
    low, high = np.array(robot.joint_limits, dtype=float).T
    q = rng.uniform(low, high, (BATCH, robot.dof))
    qd, qdd = rng.standard_normal((2, BATCH, robot.dof))
    values = parameter_values(robot.model(), rng)
    dtype = kernel.signatures["tau"].dtype
    numbers = [float(x) for x in (*q[0], *qd[0], *qdd[0], *values.values())]
    q, qd, qdd = (x.astype(dtype) for x in (q, qd, qdd))
    names: dict[str, Any] = {
        "kernel": kernel.tau,
        "in_numpy": numpy_kernel.tau,
        "out": np.empty(robot.dof, dtype),
        "outs": np.empty_like(q),
        "kernels": _parameters(kernel, values, dtype),
        "numpys": _parameters(numpy_kernel, values, dtype),
    }
    for name, array in {"q": q, "qd": qd, "qdd": qdd}.items():
        names |= {name: array[0].copy(), f"{name}s": array}
    given = ", parameters=kernels" if kernel.parameters else ""
    given_in_numpy = ", parameters=numpys" if numpy_kernel.parameters else ""
    timings = [
        Timing("compiled kernel", seconds(f"kernel(q, qd, qdd{given}, out=out)", names)),
        Timing("the same in NumPy", seconds(f"in_numpy(q, qd, qdd{given_in_numpy})", names)),
    ]
    if lambdified is not None:
        names |= {"lambdified": lambdified, "numbers": numbers}
        timings.append(Timing("SymPy lambdify", seconds("lambdified(*numbers)", names)))
    for what, call in (
        ("compiled kernel", f"kernel(qs, qds, qdds{given}, out=outs)"),
        ("the same in NumPy", f"in_numpy(qs, qds, qdds{given_in_numpy})"),
    ):
        timings.append(Timing(what, seconds(call, names) / BATCH, batch=True))
    return timings


def time_function(kernel: Kernel, robot: Robot, name: str) -> list[Timing]:
    """Time a function of a kernel at one random state, and per sample of a batch."""
    tell(f"timing {name}")
    rng = np.random.default_rng(0)
    values = parameter_values(robot.model(), rng)
    signature = kernel.signatures[name]
    dtype = signature.dtype
    batch = [rng.uniform(-1, 1, (BATCH, *a.sizes)).astype(dtype) for a in signature.given]
    names: dict[str, Any] = {
        "function": getattr(kernel, name),
        "one": [x[0].copy() for x in batch],
        "batch": batch,
        "parameters": (
            {"parameters": _parameters(kernel, values, dtype)} if kernel.parameters else {}
        ),
    }
    one = seconds("function(*one, **parameters)", names)
    many = seconds("function(*batch, **parameters)", names) / BATCH
    what = "compiled kernel" if kernel.library else "NumPy kernel"
    return [Timing(what, one, function=name), Timing(what, many, batch=True, function=name)]


def _parameters(kernel: Kernel, values: Mapping[Any, float], dtype: str) -> Any:
    """Return the run-time parameters of a kernel, for the values of a robot's symbols."""
    return np.array(list(for_kernel(kernel.parameters, values).values()), dtype)


def lambdify_tau(robot: Robot) -> Callable[..., Any]:
    """Return the symbolic equations through SymPy's lambdify, as a user would write it.

    Takes q, qd, qdd and the parameters as separate floats; common subexpressions are shared
    (``cse=True``) and Python's own ``math`` is used, which is faster for single numbers than NumPy.
    """
    variables = [*robot.qs, *(q.diff(t) for q in robot.qs), *(q.diff(t, 2) for q in robot.qs)]
    variables += robot.parameters
    # of no name that means something in Python
    plain = sp.symbols(f"x:{len(variables)}", cls=sp.Dummy)
    # derivatives first: a position inside a derivative must not be replaced before it
    names = dict(zip(reversed(variables), reversed(plain), strict=True))
    equations = [equation.lhs.xreplace(names) for equation in robot.dynamic_model()]
    return lambdified(plain, equations)


def lambdified(arguments: Sequence[Any], expressions: Sequence[Any]) -> Callable[..., Any]:
    """Return ``sympy.lambdify`` of expressions, for floats."""
    modules = [{"sign": np.sign}, "math"]
    function: Callable[..., Any] = sp.lambdify(arguments, expressions, modules=modules, cse=True)
    return function


def seconds(statement: str, names: dict[str, Any]) -> float:
    """Return the time of a statement [s]: the mean of a block of runs, of the fastest block."""
    timer = Timer(statement, globals=names)
    repeats = 1
    while (duration := timer.timeit(repeats)) < BLOCK / 4:
        repeats *= 4
    per_block = max(1, round(repeats * BLOCK / duration))
    return min(timer.repeat(BLOCKS, per_block)) / per_block
