"""Code, stack and instructions of tau of the packaged robots on Arm: python -m benchmarks.embedded.

    python -m benchmarks.embedded                 prints the tables
    python -m benchmarks.embedded --arms panda    of some robots
    python -m benchmarks.embedded --write         writes benchmarks/results/embedded.json too

What is measured is an export in C, built by its own Makefile for its TARGETs. Code is what the
linker keeps of tau and its constants; stack is the most that GCC counts along the calls. Both are
without the functions of libm, which are called for large angles only. Instructions are counted in
the emulator, for an ordinary state. Also with sines and cosines by libm; and for a sample of the
function for many states. Needs the cross compilers and QEMU that the export's README names.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import moro
import moro_codegen as mc
from benchmarks.machine import provenance
from moro_codegen.program import generate

RESULTS = Path(__file__).parent / "results" / "embedded.json"
ARMS = (
    "two_link", "stanford_arm", "puma560", "cobra600", "palletizer", "ur5", "ur5e", "panda",
    "xarm7", "solo12",
)  # fmt: skip
#: what processors are called, and the precisions that they compute in
TARGETS = {
    ("cortex-m4", "float32"): "Cortex-M4F, float",
    ("cortex-m7", "float32"): "Cortex-M7, float",
    ("cortex-m7", "float64"): "Cortex-M7, double",
    ("armhf", "float64"): "Armv7, double",
    ("aarch64", "float64"): "Armv8, double",
}
#: with products fused with sums, as GCC does it without -std=c99
CFLAGS = "CFLAGS=-O2 -ffp-contract=fast"
#: calls, and samples of a batch, by which two programs differ
CALLS = 64

PROGRAM = """
#include "{name}.h"

{real} x[{n} * {calls}], tau[{n} * {calls}];

int main(void)
{{
    for (int i = 0; i < {n} * {calls}; i++)
        x[i] = ({real})0.1 * ({real})(i % 31 - 15);
    {call}
    return 0;
}}
"""
ONE = "for (int k = 0; k < {calls}; k++)\n        {name}_tau(x, x, x, {p}tau);"
MANY = "{name}_tau_batch({calls}, x, {n}, 1, x, {n}, 1, x, {n}, 1, {p_strides}tau, {n}, 1);"
#: the same of no call
NONE = ""


@dataclass(frozen=True)
class Record:
    """What tau of a robot takes on a processor: bytes, and instructions a call or sample."""

    arm: str
    target: str
    joints: int
    operations: int
    code: int
    stack: int
    instructions: int
    instructions_with_libm: int
    batch_code: int
    batch_stack: int
    batch_instructions: int


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", nargs="+", choices=ARMS, default=ARMS, metavar="ARM")
    parser.add_argument("--write", action="store_true", help=f"write {RESULTS.name}")
    given = parser.parse_args()
    records: list[Record] = []
    tools: dict[str, str] = {}
    for arm, dtype in itertools.product(given.arms, dict.fromkeys(x for _, x in TARGETS)):
        with tempfile.TemporaryDirectory() as folder:
            export = Export(arm, dtype, Path(folder))
            for (target, precision), title in TARGETS.items():
                if precision == dtype:
                    print(f"{arm}: {title}", file=sys.stderr)
                    build = Build(export, target)
                    records.append(build.measured(title))
                    tools |= build.tools()
    records.sort(key=lambda record: list(TARGETS.values()).index(record.target))
    print(*tables(records), sep="\n")
    if given.write:
        results = {**provenance({}, tools), "records": [asdict(record) for record in records]}
        RESULTS.write_text(json.dumps(results, indent=1) + "\n")


HEAD = (
    f"{'':14}{'joints':>7}{'operations':>11}{'code':>8}{'stack':>7}{'instructions':>13}"
    f"{'with libm':>10} | batch:{'code':>7}{'stack':>7}{'instructions':>13}"
)


def line(r: Record) -> str:
    """Return a record as a line of the table."""
    return (
        f"{r.arm:14}{r.joints:7}{r.operations:11}{r.code:8}{r.stack:7}{r.instructions:13}"
        f"{r.instructions_with_libm:10} | {r.batch_code:13}{r.batch_stack:7}"
        f"{r.batch_instructions:13}"
    )


class Export:
    """An export of a robot."""

    def __init__(self, arm: str, dtype: str, folder: Path) -> None:
        self.arm = arm
        robot = moro.load(arm)
        (self.folder,) = mc.export(robot, folder, ("c",), dtype=dtype, batch=True)
        self.name = arm + "f" * (dtype == "float32")
        self.real = "float" if dtype == "float32" else "double"
        program = generate(robot)
        self.joints = program.dof
        self.parameters = f"{self.name}_default_parameters, " if program.parameters else ""
        ops = program.routines[0].ops
        self.operations = sum(ops[kind] for kind in ("add", "sub", "mul", "div"))


class Build:
    """An export, to be built for a TARGET of its Makefile."""

    def __init__(self, export: Export, target: str) -> None:
        self.export, self.options = export, (f"TARGET={target}", CFLAGS)
        self.name = export.name
        *_, last = self.said("make", "-n", "check", *self.options).splitlines()
        self.emulator = shlex.split(last)[:-1]
        *_, last = self.said("make", "-n", "-B", f"{self.name}.o", *self.options).splitlines()
        self.compiler = shlex.split(last)[:-4]  # without -c -o NAME.o NAME.c

    def measured(self, title: str) -> Record:
        """Return the measurements."""
        one, many = f"{self.name}_tau", f"{self.name}_tau_batch"
        stack = self.stacks()
        return Record(
            self.export.arm,
            title,
            self.export.joints,
            self.export.operations,
            self.code(one),
            stack[one],
            self.instructions(ONE),
            self.instructions(ONE, "CPPFLAGS=-DMORO_PLAIN_C"),
            self.code(many),
            stack[many],
            self.instructions(MANY),
        )

    def code(self, function: str) -> int:
        """Return the bytes of a function with all that it needs of the source."""
        linked = (
            "-ffunction-sections", "-fdata-sections", "-nostdlib", "-static",
            "-Wl,--gc-sections,--unresolved-symbols=ignore-all,--build-id=none",
            f"-Wl,-e,{function}", f"{self.name}.c", "-o", "linked",
        )  # fmt: skip
        self.said(*self.compiler, *linked)
        printed = self.said(self.compiler[0].replace("gcc", "size"), "-A", "linked")
        sections = re.findall(r"^\.(?:text|rodata)\S* +(\d+)", printed, re.MULTILINE)
        return sum(map(int, sections))

    def stacks(self) -> dict[str, int]:
        """Return the stack of all functions."""
        printed = self.said("make", "-s", "stack", *self.options)
        return {name: int(size) for name, size in re.findall(r"^(\w+)\t(\d+)", printed, re.M)}

    def instructions(self, call: str, *options: str) -> int:
        """Return the instructions of a call, or of a sample."""
        return round((self.counted(call, *options) - self.counted(NONE, *options)) / CALLS)

    def counted(self, call: str, *options: str) -> int:
        """Return the instructions of a program with so many calls."""
        n, real, p = self.export.joints, self.export.real, self.export.parameters
        holes = {"name": self.name, "n": n, "real": real, "calls": CALLS, "p": p}
        holes["p_strides"] = f"{p}0, 1, " if p else ""
        text = PROGRAM.format(call=call.format(**holes), **holes)
        (self.export.folder / "selftest.c").write_text(text)
        self.said("make", "selftest", *self.options, *options)
        self.said(self.emulator[0], *traced(self.emulator[0]), *self.emulator[1:], "./selftest")
        with (self.export.folder / "trace").open("rb") as trace:
            return sum(text.startswith(b"Trace") for text in trace)

    def tools(self) -> dict[str, str]:
        """Return the versions of compiler and emulator."""
        commands = (self.compiler[0], self.emulator[0])
        return {tool: self.said(tool, "--version").splitlines()[0] for tool in commands}

    def said(self, *command: str) -> str:
        """Return what a program prints; raise if it fails."""
        if shutil.which(command[0]) is None:
            raise FileNotFoundError(f"{command[0]} is not installed here")
        done = subprocess.run(
            command, cwd=self.export.folder, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError(f"{shlex.join(command)}\n{done.stdout}{done.stderr}")
        return done.stdout


def traced(emulator: str) -> Sequence[str]:
    """Return the options by which an emulator writes a line for each instruction."""
    said = subprocess.run([emulator, "--help"], capture_output=True, text=True, check=False).stdout
    if "one-insn-per-tb" not in said:
        single = ["-singlestep"]
    elif "system" in emulator:
        single = ["-accel", "tcg,one-insn-per-tb=on"]
    else:
        single = ["-one-insn-per-tb"]
    return [*single, "-d", "exec,nochain", "-D", "trace"]


def tables(records: Iterable[Record]) -> Iterator[str]:
    """Yield the lines of all tables."""
    title = ""
    for record in records:
        if record.target != title:
            title = record.target
            yield f"\n{title}\n{HEAD}"
        yield line(record)


if __name__ == "__main__":
    main()
