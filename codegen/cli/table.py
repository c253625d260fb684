"""What the command prints of its job: one table."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from rich.console import Console
from rich.table import Table

from moro import Robot
from moro_codegen.benchmark import BATCH
from moro_codegen.cli.job import Outcome


def show(outcome: Outcome) -> None:
    """Print the table, and what lies in the kernel's folder."""
    kernel = outcome.kernel
    table = Table(box=None, show_header=False, padding=(0, 3, 0, 0))
    table.add_column()
    table.add_column(justify="right")
    table.add_column(style="dim")
    for row in _facts(outcome):
        table.add_row(*row)
    if outcome.timings:
        table.add_row()
    for row in _comparison(outcome):
        table.add_row(*row)
    console = Console(highlight=False)
    calls = [f"{s.name}({', '.join(a.name for a in s.given)})" for s in kernel.signatures.values()]
    console.print(f"\n[bold]{kernel.name}: {', '.join(calls)}[/]\n")
    console.print(table)
    names = sorted(path.name + "/" * path.is_dir() for path in kernel.directory.iterdir())
    files = ", ".join(names)
    console.print(f"\n{_shown(kernel.directory)}: {files}", soft_wrap=True)


def _facts(outcome: Outcome) -> Iterator[tuple[str, str, str]]:
    """Yield what the kernel is, how long it took, and whether it is right."""
    robot, kernel, times = outcome.robot, outcome.kernel, outcome.times
    route, verification = outcome.route, outcome.verification
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


def _comparison(outcome: Outcome) -> Iterator[tuple[str, str, str]]:
    """Yield the times per call, and per sample of a batch, as multiples of the kernel's."""
    others = [timing for timing in outcome.timings if timing.function != "tau"]
    timings = [timing for timing in outcome.timings if timing.function == "tau"]
    route = outcome.route
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
