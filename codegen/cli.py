"""``moro-codegen robot.yaml``: from the description of an arm to a verified, compiled kernel."""

from __future__ import annotations

import difflib
import hashlib
import sys
import textwrap
import time
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from moro import Robot
    from moro_codegen.benchmark import Timing
    from moro_codegen.kernel import Kernel
    from moro_codegen.verify import SymbolicRoute, Verification


#: columns of --help
WIDTH = 78
LANGUAGES = ("c", "cython", "python")


def _epilog() -> str:
    from moro.io import packaged
    from moro_codegen import FUNCTIONS

    functions = [
        line
        for function in FUNCTIONS.values()
        for line in (f"  {function.name}", *_indented(function.summary))
    ]
    return "\n\n".join(
        [
            "\b\n" + "\n".join(["Functions:", *functions]),
            f"Packaged arms: {', '.join(packaged())}.",
            "Exit code: 0 if the kernel verified, 1 if it did not, 2 if something given was wrong.",
        ]
    )


def _indented(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6)


class _Names(click.ParamType):  # type: ignore[type-arg]
    """Names with commas between them, of those there are; ``+`` joins what is done together."""

    name = "names"

    def __init__(self, there: Iterable[str], joined: bool = False) -> None:
        self.there = tuple(there)
        self.joined = joined

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        if not isinstance(value, str):
            return tuple(value)
        items = [item.strip() for item in value.split(",") if item.strip()]
        names = [item.split("+") if self.joined else [item] for item in items]
        for name in (name for group in names for name in group):
            if name not in self.there:
                near = difflib.get_close_matches(name, self.there, n=1)
                hint = f"did you mean {near[0]!r}? " if near else ""
                self.fail(f"no {name!r}; {hint}there are {', '.join(self.there)}.", param, ctx)
        if not names:
            self.fail(f"none given; there are {', '.join(self.there)}.", param, ctx)
        return tuple(tuple(group) if len(group) > 1 else group[0] for group in names)


def _functions() -> _Names:
    from moro_codegen import FUNCTIONS

    return _Names(FUNCTIONS, joined=True)


@click.command(
    epilog=_epilog(),
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": WIDTH + 2},
)
@click.argument("robot")
@click.option(
    "-f",
    "--functions",
    type=_functions(),
    default="tau",
    show_default=True,
    help="What to generate, as listed below, with commas in between; a+b are two in one call.",
)
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
    type=click.Choice(["c", "cython", "numpy"]),
    default="c",
    show_default=True,
    help="Compiled C, a Cython extension, or a Python module with NumPy, which needs no compiler.",
)
@click.option(
    "--scalar",
    type=click.Choice(["double", "float"]),
    default="double",
    show_default=True,
    help="What the kernel computes with; float is single precision, not with cython.",
)
@click.option(
    "--emit",
    "languages",
    type=_Names(LANGUAGES),
    default=(),
    help="Sources to write besides: c, cython (a package that pip installs without moro), python.",
)
@click.option("--no-benchmark", is_flag=True, help="Leave out the times per call.")
@click.version_option(package_name="moro", prog_name="moro-codegen")
def main(
    robot: str,
    functions: tuple[Any, ...],
    output: Path,
    backend: str,
    scalar: str,
    languages: tuple[str, ...],
    no_benchmark: bool,
) -> None:
    """Make a compiled kernel of an arm's dynamics, and prove it.

    ROBOT is a robot.yaml, or the name of a packaged arm. The equations of motion are derived
    symbolically; a kernel, by default tau(q, qd, qdd), is generated on an independent route,
    compiled, compared with the equations at random and awkward states, and timed. BUILD/NAME/ gets
    the C source, its header, the shared library and a manifest.
    """
    try:
        passed = _run(robot, functions, output, backend, scalar, languages, not no_benchmark)
    except _expected_errors() as error:
        click.echo(f"moro-codegen: error: {_message(error)}", err=True)
        sys.exit(2)
    sys.exit(0 if passed else 1)


def _run(
    source: str,
    functions: tuple[Any, ...],
    output: Path,
    backend: str,
    scalar: str,
    languages: tuple[str, ...],
    with_benchmark: bool,
) -> bool:
    """Do the whole job and print the table; tell whether the kernel verified."""
    times: dict[str, float] = {}
    with _step("reading", times):
        robot, source_record = _read(source)
    from moro_codegen.verify import SymbolicRoute, verify

    with _step("deriving the equations of motion", times, "derive"):
        route = SymbolicRoute(robot)
    with _step("generating and compiling", times):
        kernel = _build(robot, functions, output, backend, scalar, languages, source_record, times)
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
    robot: Robot,
    functions: tuple[Any, ...],
    output: Path,
    backend: Any,
    scalar: Any,
    languages: Any,
    source: dict[str, str],
    times: dict[str, float],
) -> Kernel:
    """Return the kernel in its folder."""
    from moro_codegen import build
    from moro_codegen.described import described
    from moro_codegen.generate import generate
    from moro_codegen.requested import requested

    start = time.perf_counter()
    program = generate(robot.model(), requested(functions, robot), robot.parameters)
    program = replace(described(program, robot), scalar=scalar)
    generated = time.perf_counter() - start
    kernel = build(program, output / robot.name, backend, languages=languages, source=source)
    times["generate"] = generated + kernel.timings["emit"]
    times["compile"] = kernel.timings["compile"]
    return kernel


def _benchmark(kernel: Kernel, robot: Robot, route: SymbolicRoute) -> list[Timing]:
    """Time tau, also as NumPy code and as the equations through lambdify; and the others."""
    from moro_codegen import compile
    from moro_codegen.benchmark import LAMBDIFY_TERMS, lambdify_tau, time_function, time_tau

    others = [
        timing
        for name in kernel.signatures
        if name != "tau"
        for timing in time_function(kernel, robot, name)
    ]
    if "tau" not in kernel.signatures:
        return others
    short = route.is_closed_form and route.terms <= LAMBDIFY_TERMS
    lambdified = lambdify_tau(robot) if short else None
    with TemporaryDirectory() as folder:
        dtype = kernel.signatures["tau"].dtype
        in_numpy = compile(robot, directory=folder, backend="numpy", dtype=dtype)
        return [*time_tau(kernel, in_numpy, robot, lambdified), *others]


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
    calls = [f"{s.name}({', '.join(a.name for a in s.given)})" for s in kernel.signatures.values()]
    console.print(f"\n[bold]{kernel.name}: {', '.join(calls)}[/]\n")
    console.print(table)
    names = sorted(path.name + "/" * path.is_dir() for path in kernel.directory.iterdir())
    files = ", ".join(names)
    console.print(f"\n{_shown(kernel.directory)}: {files}", soft_wrap=True)


def _facts(
    robot: Robot,
    kernel: Kernel,
    route: SymbolicRoute,
    verification: Verification,
    times: dict[str, float],
) -> Iterator[tuple[str, str, str]]:
    """Yield what the kernel is, how long it took, and whether it is right."""
    yield "joints", str(robot.dof), f"{_kinds(robot)}, {robot.convention} convention"
    if kernel.manifest["scalar"] == "float":
        yield "scalar type", "float", "single precision"
    if kernel.parameters:
        yield "parameters", str(len(kernel.parameters)), ", ".join(kernel.parameters)
    for name, ops in kernel.ops.items():
        arithmetic = {kind: ops[kind] for kind in ("add", "sub", "mul", "div") if ops[kind]}
        counts = " + ".join(f"{count} {kind}" for kind, count in arithmetic.items()) or "none"
        what = "operations" if len(kernel.ops) == 1 else f"operations of {name}"
        yield what, str(sum(arithmetic.values())), f"{counts}; {ops['sincos']} sin-cos pairs"
    length = f"{route.terms} terms" if route.is_closed_form else "too long to write out"
    yield "time to derive", _duration(times["derive"]), f"M, C, G: {length}"
    yield "time to generate", _duration(times["generate"]), "from model to source text"
    compiler = (kernel.manifest["compiler"] or {}).get("version", "no compiler needed")
    if kernel.reused:
        yield "time to compile", "-", "built before from the same input"
    else:
        yield "time to compile", _duration(times["compile"]), compiler
    if len(kernel.ops) > 1:
        for name, error in verification.max_errors.items():
            yield f"error of {name}", f"{error:.1e}", ""
    for name in verification.unchecked:
        yield f"error of {name}", "-", "not checked: the symbolic route has no such function"
    states = f"{len(verification.q)} states, against the {verification.route}"
    verdict = "verified" if verification.passed else "[bold red]NOT VERIFIED[/]"
    yield "largest error", f"{verification.max_error:.1e}", f"{verdict}: {states}"


def _comparison(timings: list[Timing], route: SymbolicRoute) -> Iterator[tuple[str, str, str]]:
    """Yield the times per call, and per sample of a batch, as multiples of the kernel's."""
    from moro_codegen.benchmark import BATCH

    others = [timing for timing in timings if timing.function != "tau"]
    timings = [timing for timing in timings if timing.function == "tau"]
    for batch, title in ((False, "one call from Python"), (True, f"per sample of {BATCH}")):
        same = [timing for timing in timings if timing.batch == batch]
        for timing in same:
            ratio = timing.seconds / same[0].seconds
            multiple = "" if timing is same[0] else f", {_ratio(ratio)} the kernel"
            yield timing.what, _duration(timing.seconds), f"{title}{multiple}"
        if same and not batch and not any(timing.what == "SymPy lambdify" for timing in same):
            yield "SymPy lambdify", "-", f"left out: {route.terms:,} terms take it too long"
    for one, many in zip(others[::2], others[1::2], strict=True):
        batch_time = f"{_duration(many.seconds)} per sample of {BATCH}"
        yield one.function, _duration(one.seconds), f"one call from Python; {batch_time}"


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
