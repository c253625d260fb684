"""What pages show that is neither text nor output of a sample: formulas, tables, runs of programs.

A page says where, with an expression that gives the text in between:

    <!-- write: formula(M.latex()) -->
    <!-- end -->

The expression knows the names below and those of the page's samples before it.
"""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.figures import faster_peers, figures
from moro import load
from moro_codegen import FUNCTIONS
from moro_codegen.backends.toolchain import find_compiler
from moro_codegen.functions.arguments import Argument
from moro_codegen.program import generate

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^(<!-- write: ([^\n]+) -->\n)(.*?)^(<!-- end -->)$", re.MULTILINE | re.DOTALL)
#: what a page needs from there on
NEEDS = re.compile(r"^<!-- needs: (.*) -->$", re.MULTILINE)
#: libraries that moro is measured beside, by the name of their package
PEERS = {
    "pin": "Pinocchio",
    "casadi": "CasADi",
    "mujoco": "MuJoCo",
    "roboticstoolbox-python": "Robotics Toolbox for Python",
}


def formula(latex: str) -> str:
    """Return LaTeX as a displayed formula."""
    return f"\n$$\n{latex}\n$$\n"


def console(*commands: str) -> str:
    """Return what commands print, in the folder of the page's files."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    shown = []
    for command in commands:
        done = subprocess.run(  # noqa: S602 - our own pages
            command,
            shell=True,
            check=True,
            capture_output=True,
            text=True,
            env={**os.environ, "PATH": path, "COLUMNS": "100"},
        )
        shown += [f"$ {command}", *(line.rstrip() for line in done.stdout.strip().splitlines())]
    return "\n".join(["```console", *shown, "```", ""])


def machine() -> str:
    """Return the kind of machine that a page was written on, as a sentence."""
    compiler, python = find_compiler().version, platform.python_version()
    return f"(Run on one core of an {_processor()}, with {compiler} and Python {python}.)\n"


def functions() -> str:
    """Return the table of what kernels compute."""
    return _table(
        ("function", "what it is", "algorithm"),
        (
            (
                f"`{f.name}({_names(f.inputs)})` → {_names(f.outputs, '`')}",
                f.summary.rstrip("."),
                f.algorithm,
            )
            for f in FUNCTIONS.values()
        ),
    )


def arguments() -> str:
    """Return the table of what functions take and return."""
    every = [a for f in FUNCTIONS.values() for a in (*f.inputs, *f.outputs)]
    return _table(
        ("name", "shape", "unit", "what it is"),
        ((f"`{a.name}`", _shape(a.shape), a.unit, a.description) for a in dict.fromkeys(every)),
    )


def drives(arm: str) -> str:
    """Return what friction and rotor inertia add to the operations of tau, as a sentence."""
    robot = load(arm)
    whole, rigid = (generate(robot, rigid=alone).routines[0].ops for alone in (False, True))
    count = [sum(ops[kind] for kind in ("add", "sub", "mul", "div")) for ops in (whole, rigid)]
    return (
        f"Of the {count[0]} operations, {count[0] - count[1]} are for friction and rotor inertia. "
        f"Other libraries leave them out, so the comparisons count the other {count[1]}.\n"
    )


def operations(kind: str) -> str:
    """Return the operations of tau as passes come ("+"), or with one left out ("all but")."""
    found = _results("operations")["operations"]
    arms = next(iter(found.values()))
    chosen = {row: counts for row, counts in found.items() if row.startswith(kind)}
    first = {row: counts for row, counts in found.items() if not row.startswith(("+", "all but"))}
    rows = {**first, **chosen} if kind == "+" else chosen
    return _table(
        ("", *arms),
        ((row, *(f"{n} + {k}" for n, k in counts.values())) for row, counts in rows.items()),
    )


def of_functions() -> str:
    """Return the operations of functions: sum by sum, what sums share once, closed forms."""
    found = _results("operations")["functions"]
    return _table(
        ("", *next(iter(found.values()))),
        (
            (f"`{name}`", *(" → ".join(f"{n} + {k}" for n, k in ways) for ways in arms.values()))
            for name, arms in found.items()
        ),
    )


def latencies() -> str:
    """Return the cycles to the last result of functions: as written, and in order of arrival."""
    found = _results("operations")["latencies"]
    arms = list(next(iter(found.values())))
    return _table(
        ("", *arms),
        (
            (f"`{name}`", *(" → ".join(map(str, of[arm])) if arm in of else "" for arm in arms))
            for name, of in found.items()
        ),
    )


def beside_symoro() -> str:
    """Return the operations of the KUKA LWR's functions, moro's and Symoro+'s."""
    found = _results("operations")["kuka_lwr"]
    return _table(
        ("", "moro", "Symoro+"), ((f"`{name}`", *map(str, pair)) for name, pair in found.items())
    )


def accuracy() -> str:
    """Return the errors of tau, relative to the largest torque of a state."""
    rows = [
        (dtype, arm, *(f"{x:.1e}" for x in errors.values()))
        for dtype, arms in _results("accuracy")["tau"].items()
        for arm, errors in arms.items()
    ]
    return _table(("precision", "arm", "half below", "90 % below", "99 % below", "largest"), rows)


def symbolic(kind: str) -> str:
    """Return how long closed forms take: of whole arms, or with the number of joints ("growth")."""
    found: dict[tuple[str, ...], dict[str, str]] = {}
    for result in _results("symbolic")["results"]:
        axes, _, joints = result["arm"].partition(", ")
        if bool(joints) == (kind == "growth"):
            times = found.setdefault((axes, *joints.split()[:1]), {})
            times[result["quantity"]] = f"{result['seconds']:.2g} s"
    quantities = list(dict.fromkeys(q for times in found.values() for q in times))
    head = ("axes", "joints") if kind == "growth" else ("arm",)
    arms = (
        sorted(found, key=lambda arm: (arm[0] == "alternating", int(arm[-1])))
        if len(head) > 1
        else found
    )
    return _table(
        (*head, *quantities), ([*a, *(found[a].get(q, "") for q in quantities)] for a in arms)
    )


def reached() -> str:
    """Return how moro compares with its peers, measure by measure."""
    return _table(
        ("measure", "aim", "measured", ""),
        (
            (
                f.measure,
                f"{'' if f.at_least else 'at most '}{f.reach:g}",
                "not measured" if f.now is None else f"{f.now:.3g}",
                "" if f.now is None or f.reached else "**missed**",
            )
            for f in figures(_results("peers"))
        ),
    )


def faster() -> str:
    """Return where a peer is faster than moro, as a list."""
    losses = list(faster_peers(_results("peers")))
    return "\n" + "".join(f"- {line}\n" for line in losses or ["Nowhere in this run."]) + "\n"


def measured_on() -> str:
    """Return where and with what moro and its peers were measured, as a sentence."""
    results = _results("peers")
    machine, versions = results["machine"], results["versions"]
    peers = ", ".join(
        f"{name} {versions[key]}" for key, name in PEERS.items() if versions.get(key) is not None
    )
    processor = _plain(machine["processor"])
    return f"Measured on one core of an {processor}, beside {peers}, on {results['when'][:10]}.\n"


def out_of_core() -> str:
    """Return how many samples go through kernels from file to file, and where that was measured."""
    results = _results("out_of_core")
    rates = results["rates"]
    table = _table(
        ("million samples a second", *next(iter(rates.values()))),
        ((way, *(f"{rate / 1e6:.1f}" for rate in found.values())) for way, found in rates.items()),
    )
    machine = results["machine"]
    processor = _plain(machine["processor"])
    return (
        f"{table}({machine['cores']} cores of an {processor}, {results['samples'] / 1e6:g} million "
        f"states of the PUMA 560, on {results['when'][:10]}; "
        f"{results['load']:.0f} others wanted the processor.)\n"
    )


def growth() -> str:
    """Return operations of tau, and the time to generate it, by number of joints."""
    return _table(
        ("joints", "operations", "for each joint", "ms to generate", "for each joint"),
        (
            (
                n,
                str(r["operations"]),
                f"{r['operations'] / int(n):.1f}",
                f"{1e3 * r['seconds']:.0f}",
                f"{1e3 * r['seconds'] / int(n):.1f}",
            )
            for n, r in _results("operations")["growth"].items()
        ),
    )


def embedded(target: str) -> str:
    """Return what tau takes of a processor: bytes and instructions, robot by robot."""
    found = _results("embedded")["records"]
    return _table(
        ("robot", "joints", "operations", "code", "stack", "instructions", "with libm's sines"),
        (
            (
                r["arm"], str(r["joints"]), str(r["operations"]), f"{r['code']} B",
                f"{r['stack']} B", str(r["instructions"]), str(r["instructions_with_libm"]),
            )
            for r in found
            if r["target"] == target
        ),
    )  # fmt: skip


def embedded_targets(arm: str) -> str:
    """Return what tau of a robot takes of processors, and what a sample of a batch takes."""
    found = [r for r in _results("embedded")["records"] if r["arm"] == arm]
    return _table(
        ("processor", "code", "stack", "instructions", "batch: code", "stack", "instructions"),
        (
            (
                r["target"], f"{r['code']} B", f"{r['stack']} B", str(r["instructions"]),
                f"{r['batch_code']} B", f"{r['batch_stack']} B", str(r["batch_instructions"]),
            )
            for r in found
        ),
    )  # fmt: skip


def embedded_tools() -> str:
    """Return what compiled and counted embedded code, as a sentence."""
    versions: dict[str, set[str]] = {"GCC": set(), "QEMU": set()}
    for tool, said in _results("embedded")["compilers"].items():
        found = re.search(r"\d+\.\d+\.\d+", said)
        versions["GCC" if tool.endswith("gcc") else "QEMU"].add(found[0] if found else said)
    gcc, qemu = (" and ".join(sorted(numbers)) for numbers in versions.values())
    return f"(Compiled by GCC {gcc}, counted in QEMU {qemu}.)\n"


def _names(arguments: Iterable[Argument], quote: str = "") -> str:
    return ", ".join(f"{quote}{a.name}{quote}" for a in arguments)


def _shape(shape: Sequence[str | int]) -> str:
    return f"({', '.join(map(str, shape))}{',' * (len(shape) == 1)})"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n" + "".join(f"| {' | '.join(line)} |\n" for line in lines) + "\n"


def _results(name: str) -> Any:
    """Return what a benchmark has written."""
    return json.loads((ROOT / f"benchmarks/results/{name}.json").read_text(encoding="utf-8"))


def _processor() -> str:
    """Return the name of the processor."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*: (.*)$", text, re.MULTILINE)
    return _plain(found[1] if found else platform.processor() or platform.machine())


def _plain(name: str) -> str:
    """Return the name of a processor without trade marks and what stands in brackets."""
    return re.sub(r" *\([^)]*\)", "", name).strip()


#: what expressions may use
NAMES = {
    f.__name__: f
    for f in (
        formula,
        console,
        machine,
        drives,
        functions,
        arguments,
        operations,
        of_functions,
        latencies,
        beside_symoro,
        accuracy,
        growth,
        reached,
        faster,
        measured_on,
        out_of_core,
        symbolic,
        embedded,
        embedded_targets,
        embedded_tools,
    )
}
#: expressions that begin like this tell of the machine at hand: no two runs are equal
TIMED = ('console("moro-codegen', "machine")
