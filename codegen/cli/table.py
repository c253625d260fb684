"""What the command prints of its job: one table."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from rich.console import Console
from rich.text import Text

from moro import Robot
from moro_codegen.benchmark import BATCH
from moro_codegen.cli.job import Outcome, files

#: spaces between columns
GAP = " " * 3
#: a note is wrapped to no fewer characters
NARROW = 24


class TableRow(NamedTuple):
    """What, how much, and a note."""

    what: str
    value: str
    note: str
    style: str = "dim"


def show(outcome: Outcome) -> None:
    """Print the table, and what lies in the kernel's folder.

    Notes are wrapped to the width of a terminal. Elsewhere a row is a line, for grep.
    """
    kernel = outcome.kernel
    console = Console(highlight=False, markup=False, emoji=False)
    calls = [f"{s.name}({', '.join(a.name for a in s.given)})" for s in kernel.signatures.values()]
    title = f"{kernel.name}: {', '.join(calls)}"
    console.print()
    console.print(Text(title, style="bold"), soft_wrap=not console.is_terminal)
    blocks = [list(_facts(outcome)), list(_comparison(outcome))]
    what, value = (max(len(row[k]) for block in blocks for row in block) for k in (0, 1))
    left = console.width - what - value - 2 * len(GAP)
    room = max(left, NARROW) if console.is_terminal else None
    for block in filter(None, blocks):
        console.print()
        for row in block:
            console.print(_laid_out(row, what, value, room), soft_wrap=True)
    if len(kernel.signatures) > 1:
        console.print()
        for line in _columns(list(_by_function(outcome))):
            console.print(line, soft_wrap=True)
        if outcome.timings:
            console.print(f"(one call from Python; in a batch of {BATCH}, per sample)", style="dim")
    console.print()
    for folder in (kernel.directory, *outcome.exported):
        console.print(f"{_shown(folder)}: {', '.join(files(folder))}", soft_wrap=True)


def _laid_out(row: TableRow, what: int, value: int, room: int | None) -> Text:
    """Return a row for columns of these widths, its note wrapped into what room there is."""
    left = f"{row.what:<{what}}{GAP}{row.value:>{value}}{GAP}"
    lines = textwrap.wrap(row.note, room) if room else [row.note]
    return Text.assemble(left, (f"\n{'':{len(left)}}".join(lines), row.style))


def _facts(outcome: Outcome) -> Iterator[TableRow]:
    """Yield what the kernel is, how long it took, and whether it is right."""
    robot, kernel, times = outcome.robot, outcome.kernel, outcome.times
    route, verification = outcome.route, outcome.verification
    convention = f", {robot.convention} convention" if robot.convention else ""
    yield TableRow("joints", str(robot.dof), f"{_kinds(robot)}{convention}")
    for what, text in kernel.manifest["input"].get("read", {}).items():
        yield TableRow(what, "", text)
    if kernel.manifest["scalar"] == "float":
        yield TableRow("scalar type", "float", "single precision")
    if kernel.parameters:
        yield TableRow("parameters", str(len(kernel.parameters)), ", ".join(kernel.parameters))
    if len(kernel.ops) == 1:
        (ops,) = kernel.ops.values()
        counts = " + ".join(f"{count} {kind}" for kind, count in _arithmetic(ops).items())
        note = f"{counts or 'none'}; {ops['sincos']} sin-cos pairs"
        yield TableRow("operations", str(_operations(ops)), note)
        if outcome.rigid and (drives := _operations(ops) - _operations(outcome.rigid)):
            yield TableRow("", str(drives), "of these for friction and rotor inertia")
    length = "too long to write out" if route.terms is None else f"{route.terms} terms"
    yield TableRow("time to derive", _duration(times["derive"]), f"M, C, G: {length}")
    yield TableRow("time to generate", _duration(times["generate"]), "from model to source text")
    compiler = (kernel.manifest["compiler"] or {}).get("version", "no compiler needed")
    if kernel.reused:
        yield TableRow("time to compile", "-", "built before from the same input")
    else:
        yield TableRow("time to compile", _duration(times["compile"]), compiler)
    states = f"{verification.states}, against the {verification.route}"
    verdict, style = ("verified", "dim") if verification.passed else ("NOT VERIFIED", "bold red")
    yield TableRow("largest error", f"{verification.max_error:.1e}", f"{verdict}: {states}", style)
    if len(verification.singular):
        text = f"where M is singular: {verification.singular_postures}"
        yield TableRow("not compared", "-", f"forward dynamics {text}")
    for name in verification.unchecked:
        yield TableRow("not checked", "-", f"{name}: the symbolic route has no such function")


def _comparison(outcome: Outcome) -> Iterator[TableRow]:
    """Yield the times of tau, or else of the one function, as multiples of the kernel's."""
    names = list(outcome.kernel.signatures)
    name = names[0] if len(names) == 1 else "tau"
    timings = [timing for timing in outcome.timings if timing.function == name]
    for batch, title in (
        (False, f"one call of {name} from Python"),
        (True, f"{name} per sample of {BATCH}"),
    ):
        same = [timing for timing in timings if timing.batch == batch]
        for timing in same:
            ratio = timing.seconds / same[0].seconds
            multiple = "" if timing is same[0] else f", {_ratio(ratio)} the kernel"
            yield TableRow(timing.what, _duration(timing.seconds), f"{title}{multiple}")
        if name == "tau" and same and not batch and "SymPy lambdify" not in [t.what for t in same]:
            terms = outcome.route.terms
            what = "the equations" if terms is None else f"{terms:,} terms"
            yield TableRow("SymPy lambdify", "-", f"left out: {what} take it too long")


def _by_function(outcome: Outcome) -> Iterator[tuple[str, ...]]:
    """Yield operations, error and times of each function, under a header."""
    errors, routes = outcome.verification.max_errors, outcome.verification.routes
    times = ["one call", "in a batch"] if outcome.timings else []
    yield "", "operations", "sin-cos", "error", "against", *times
    for name, ops in outcome.kernel.ops.items():
        error = f"{errors[name]:.1e}" if name in errors else "-"
        # of tau the kernel's own come first
        own = [[t for t in outcome.timings if (t.function, t.batch) == (name, b)] for b in (0, 1)]
        times = [_duration(timings[0].seconds) for timings in own if timings]
        against = routes.get(name, "-").replace("formulas evaluated at the states", "formulas")
        yield name, str(_operations(ops)), str(ops["sincos"]), error, against, *times


def _columns(rows: Sequence[Sequence[str]]) -> Iterator[Text]:
    """Yield lines of aligned columns, numbers to the right, under a dim header."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for i, (name, *cells) in enumerate(rows):
        numbers = [f"{cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True)]
        yield Text("  ".join([f"{name:<{widths[0]}}", *numbers]), style="" if i else "dim")


def _arithmetic(ops: Mapping[str, int]) -> dict[str, int]:
    return {kind: ops[kind] for kind in ("add", "sub", "mul", "div") if ops[kind]}


def _operations(ops: Mapping[str, int]) -> int:
    return sum(_arithmetic(ops).values())


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
