"""The whole job of the command: derive, generate, compile, compare, time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from moro import Robot
from moro_codegen.benchmark import LAMBDIFY_TERMS, Timing, lambdify_tau, time_function, time_tau
from moro_codegen.exported import written
from moro_codegen.kernel.kernel import Kernel
from moro_codegen.pipeline import built, compile
from moro_codegen.program import generate
from moro_codegen.progress import shown, tell
from moro_codegen.proof.verification import SymbolicRoute, Verification, verify


@dataclass(frozen=True)
class Exports:
    """What to write for places without moro, and where to."""

    folder: Path
    targets: tuple[str, ...]
    batch: bool
    prefix: str | None
    #: the robot's file or name
    loaded: str


@dataclass(frozen=True)
class Order:
    """What the command was asked for, besides the robot."""

    functions: tuple[Any, ...]
    output: Path
    backend: Any
    scalar: Any
    exports: Exports | None
    arch: str
    benchmark: bool


@dataclass(frozen=True)
class Outcome:
    """What came of it."""

    robot: Robot
    kernel: Kernel
    route: SymbolicRoute
    verification: Verification
    #: how long each step took [s]: "derive", "generate", "compile", "verify"
    times: Mapping[str, float]
    timings: tuple[Timing, ...]
    #: operations without friction and rotor inertia, of the one function of an arm that has them
    rigid: Mapping[str, int] | None
    #: the folders of what was exported, nothing unless the kernel is right
    exported: tuple[Path, ...]

    @property
    def files(self) -> list[str]:
        """What lies in the kernel's folder; folders end with a slash."""
        return files(self.kernel.directory)


def files(folder: Path) -> list[str]:
    """Return what lies in a folder; folders end with a slash."""
    return sorted(path.name + "/" * path.is_dir() for path in folder.iterdir())


@shown()
def run(robot: Robot, order: Order, source: Mapping[str, Any]) -> Outcome:
    """Return the verified kernel of a robot; ``source`` is what the manifest says of its file."""
    times: dict[str, float] = {}
    tell("deriving the equations of motion")
    with _timed(times, "derive"):
        route = SymbolicRoute(robot)
    kernel = _built(robot, order, source, times)
    with _timed(times, "verify"):
        verification = verify(kernel, robot, route=route)
    exported = _exported(robot, order, route) if verification.passed else ()
    timings = tuple(_timings(kernel, robot, route)) if order.benchmark else ()
    rigid = _rigid(robot, order)
    return Outcome(robot, kernel, route, verification, times, timings, rigid, exported)


def _exported(robot: Robot, order: Order, route: SymbolicRoute) -> tuple[Path, ...]:
    """Export what was asked for."""
    asked = order.exports
    if asked is None:
        return ()
    return written(
        robot, asked.folder, asked.targets, order.functions, order.scalar, batch=asked.batch,
        prefix=asked.prefix, loaded=Path(asked.loaded).name, route=route,
    )  # fmt: skip


@contextmanager
def _timed(times: dict[str, float], step: str) -> Iterator[None]:
    start = time.perf_counter()
    yield
    times[step] = time.perf_counter() - start


def _built(
    robot: Robot, order: Order, source: Mapping[str, Any], times: dict[str, float]
) -> Kernel:
    """Return the kernel in its folder."""
    kernel = built(
        robot,
        order.functions,
        order.output / robot.name,
        order.backend,
        dtype=order.scalar,
        arch=order.arch,
        source=source,
    )
    times["generate"] = kernel.timings["generate"] + kernel.timings["emit"]
    times["compile"] = kernel.timings["compile"]
    return kernel


def _rigid(robot: Robot, order: Order) -> Mapping[str, int] | None:
    """Return what the one function costs without what the drives add, if they add anything."""
    drives = robot.viscous_friction, robot.coulomb_friction, robot.rotor_inertias
    if len(order.functions) != 1 or not any(x != 0 for values in drives for x in values or ()):
        return None
    return generate(robot, order.functions, rigid=True).routines[0].ops


def _timings(kernel: Kernel, robot: Robot, route: SymbolicRoute) -> list[Timing]:
    """Time tau, also as NumPy code and as the equations through lambdify; and the others."""
    others = [
        timing
        for name in kernel.signatures
        if name != "tau"
        for timing in time_function(kernel, robot, name)
    ]
    if "tau" not in kernel.signatures:
        return others
    tell("timing tau")
    short = route.terms is not None and route.terms <= LAMBDIFY_TERMS
    lambdified = lambdify_tau(robot) if short else None
    with TemporaryDirectory() as folder:
        dtype = kernel.signatures["tau"].dtype
        in_numpy = compile(robot, directory=folder, backend="numpy", dtype=dtype)
        return [*time_tau(kernel, in_numpy, robot, lambdified), *others]
