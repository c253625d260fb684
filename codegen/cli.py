"""``moro-codegen robot.yaml``: from the description of an arm to a verified, compiled kernel."""

from __future__ import annotations

import hashlib
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from moro_codegen.benchmark import Timing
    from moro_codegen.kernel import Kernel
    from moro_codegen.verify import SymbolicRoute, Verification

    from moro import Robot


def _epilog() -> str:
    from moro.io import packaged

    return (
        f"Packaged arms: {', '.join(packaged())}. "
        "Exit code: 0 if the kernel verified, 1 if it did not, 2 if something given was wrong."
    )


@click.command(epilog=_epilog(), context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("robot")
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("build"),
    show_default=True,
    help="Folder in which the kernel gets a folder of its own, named like the robot.",
)
@click.option(
    "--backend",
    type=click.Choice(["c", "numpy"]),
    default="c",
    show_default=True,
    help="Compiled C, or a Python module with NumPy, which needs no compiler.",
)
@click.option("--no-benchmark", is_flag=True, help="Leave out the times per call.")
@click.version_option(package_name="moro", prog_name="moro-codegen")
def main(robot: str, output: Path, backend: str, no_benchmark: bool) -> None:
    """Make a compiled inverse-dynamics kernel of an arm, and prove it.

    ROBOT is a robot.yaml, or the name of a packaged arm. The equations of motion are derived
    symbolically; a kernel tau(q, qd, qdd) is generated on an independent route, compiled, compared
    with the equations at random and awkward states, and timed. BUILD/NAME/ gets the C source, its
    header, the shared library and a manifest.
    """
    try:
        passed = _run(robot, output, backend, not no_benchmark)
    except _expected_errors() as error:
        click.echo(f"moro-codegen: error: {_message(error)}", err=True)
        sys.exit(2)
    sys.exit(0 if passed else 1)


def _run(source: str, output: Path, backend: str, with_benchmark: bool) -> bool:
    """Do the whole job and print the table; tell whether the kernel verified."""
    times: dict[str, float] = {}
    with _step("reading", times):
        robot, source_record = _read(source)
    from moro_codegen.verify import SymbolicRoute, verify

    with _step("deriving the equations of motion", times, "derive"):
        route = SymbolicRoute(robot)
    with _step("generating and compiling", times):
        kernel = _build(robot, output, backend, source_record, times)
    with _step("comparing the kernel with the equations", times, "verify"):
        verification = verify(kernel, robot, route=route)
    timings = []
    if with_benchmark:
        with _step("timing", times):
            timings = _benchmark(kernel, robot, route)
    _print_table(robot, kernel, route, verification, times, timings)
    return verification.passed


def _read(source: str) -> tuple[Robot, dict[str, str]]:
    """Return the robot, and what the manifest says of its file; warnings go to standard error."""
    from moro.io import load, locate

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = load(source)
    for warning in caught:
        click.echo(f"moro-codegen: warning: {warning.message}", err=True)
    if robot.masses is None:
        raise ValueError(f"{source} gives no masses, so there is no tau: add mass, com and inertia")
    path = locate(source)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return robot, {"file": path.name, "sha256": digest}


def _build(
    robot: Robot, output: Path, backend: Any, source: dict[str, str], times: dict[str, float]
) -> Kernel:
    """Return the kernel in its folder."""
    from moro_codegen import build
    from moro_codegen.generate import generate

    start = time.perf_counter()
    program = generate(robot.model(), ("tau",), robot.parameters)
    generated = time.perf_counter() - start
    kernel = build(program, output / robot.name, backend, source=source)
    times["generate"] = generated + kernel.timings["emit"]
    times["compile"] = kernel.timings["compile"]
    return kernel


def _benchmark(kernel: Kernel, robot: Robot, route: SymbolicRoute) -> list[Timing]:
    """Time the kernel, the same program as NumPy code, and the equations through lambdify."""
    from moro_codegen import compile
    from moro_codegen.benchmark import LAMBDIFY_TERMS, lambdify_tau, time_tau

    short = route.is_closed_form and route.terms <= LAMBDIFY_TERMS
    lambdified = lambdify_tau(robot) if short else None
    with TemporaryDirectory() as folder:
        in_numpy = compile(robot, directory=folder, backend="numpy")
        return time_tau(kernel, in_numpy, robot, lambdified)


def _print_table(
    robot: Robot,
    kernel: Kernel,
    route: SymbolicRoute,
    verification: Verification,
    times: dict[str, float],
    timings: list[Timing],
) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, show_header=False, padding=(0, 3, 0, 0))
    table.add_column()
    table.add_column(justify="right")
    table.add_column(style="dim")
    for row in _facts(robot, kernel, route, verification, times):
        table.add_row(*row)
    if timings:
        table.add_row()
    for row in _comparison(timings, route):
        table.add_row(*row)
    console = Console(highlight=False)
    console.print(f"\n[bold]{kernel.name}: tau(q, qd, qdd)[/]\n")
    console.print(table)
    files = ", ".join(sorted(path.name for path in kernel.directory.iterdir()))
    console.print(f"\n{_shown(kernel.directory)}: {files}", soft_wrap=True)


def _facts(
    robot: Robot,
    kernel: Kernel,
    route: SymbolicRoute,
    verification: Verification,
    times: dict[str, float],
) -> Iterator[tuple[str, str, str]]:
    """Yield what the kernel is, how long it took, and whether it is right."""
    ops = kernel.ops["tau"]
    arithmetic = {kind: ops[kind] for kind in ("add", "sub", "mul", "div") if ops[kind]}
    counts = " + ".join(f"{count} {kind}" for kind, count in arithmetic.items())
    yield "joints", str(robot.dof), f"{_kinds(robot)}, {robot.convention} convention"
    if kernel.parameters:
        yield "parameters", str(len(kernel.parameters)), ", ".join(kernel.parameters)
    yield "operations", str(sum(arithmetic.values())), f"{counts}; {ops['sincos']} sin-cos pairs"
    length = f"{route.terms} terms" if route.is_closed_form else "too long to write out"
    yield "time to derive", _duration(times["derive"]), f"M, C, G: {length}"
    yield "time to generate", _duration(times["generate"]), "from model to source text"
    compiler = (kernel.manifest["compiler"] or {}).get("version", "no compiler needed")
    if kernel.reused:
        yield "time to compile", "-", "built before from the same input"
    else:
        yield "time to compile", _duration(times["compile"]), compiler
    states = f"{len(verification.errors)} states, against the {verification.route}"
    verdict = "verified" if verification.passed else "[bold red]NOT VERIFIED[/]"
    yield "largest error", f"{verification.max_error:.1e}", f"{verdict}: {states}"


def _comparison(timings: list[Timing], route: SymbolicRoute) -> Iterator[tuple[str, str, str]]:
    """Yield the times per call, and per sample of a batch, as multiples of the kernel's."""
    from moro_codegen.benchmark import BATCH

    for batch, title in ((False, "one call from Python"), (True, f"per sample of {BATCH}")):
        same = [timing for timing in timings if timing.batch == batch]
        for timing in same:
            ratio = timing.seconds / same[0].seconds
            multiple = "" if timing is same[0] else f", {_ratio(ratio)} the kernel"
            yield timing.what, _duration(timing.seconds), f"{title}{multiple}"
        if same and not batch and not any(timing.what == "SymPy lambdify" for timing in same):
            yield "SymPy lambdify", "-", f"left out: {route.terms:,} terms take it too long"


def _kinds(robot: Robot) -> str:
    return "".join(robot.joint_types).upper()


def _shown(directory: Path) -> str:
    """Return a path as short as it can be said from here."""
    here = Path.cwd()
    return f"{directory.relative_to(here) if directory.is_relative_to(here) else directory}/"


def _ratio(ratio: float) -> str:
    return f"{ratio:.1f} x" if ratio < 10 else f"{ratio:,.0f} x"


def _duration(seconds: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 1e-9:.0f} ns"


@contextmanager
def _step(what: str, times: dict[str, float], key: str | None = None) -> Iterator[None]:
    """Show on a terminal what is going on, and keep the time it takes."""
    from rich.console import Console

    start = time.perf_counter()
    with Console(stderr=True).status(what):
        yield
    times[key or what] = time.perf_counter() - start


def _expected_errors() -> tuple[type[Exception], ...]:
    """Return what a person can cause: bad input, no compiler, a folder that cannot be written."""
    from moro_codegen.toolchain import ToolchainError

    return (ValueError, TypeError, OSError, ToolchainError)


def _message(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}"
    return str(error)


if __name__ == "__main__":
    main()
