"""How long one call of tau takes: inside C, per sample of a batch in C, and from Python.

    python benchmarks/kernel_call.py [ARM ...]

Each figure is the fastest of many short blocks, in nanoseconds. "fresh" has the joint angles
written right before each call, as a controller does; "chained" makes each call wait for the last.
With valgrind installed, also the instructions of one call (compiled without AVX-512, which valgrind
does not know).
"""

import platform
import shutil
import subprocess
import sys
import tempfile
import timeit
from pathlib import Path

import numpy as np

import moro
from moro_codegen import Kernel, compile
from moro_codegen.backends.toolchain import find_compiler

ARMS = ("two_link", "puma560", "stanford_arm", "ur5", "panda")
BATCH = 4096

DRIVER = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "{name}.h"
enum {{ N = {dof}, BATCH = {batch}, CALLS = 256 }};
static double q[BATCH][N], qd[BATCH][N], qdd[BATCH][N], tau[BATCH][N];
static const double parameters[] = {{ {values} }};

static double now(void)
{{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}}

static double random_number(double size) {{ return size * (2.0 * rand() / RAND_MAX - 1.0); }}

int main(int argc, char **argv)
{{
    double best[5] = {{ 1e9, 1e9, 1e9, 1e9, 1e9 }};
    const int blocks = argc > 1 ? atoi(argv[1]) : 400;
    (void)parameters;
    for (int i = 0; i < BATCH; i++)
        for (int j = 0; j < N; j++)
            q[i][j] = random_number(3), qd[i][j] = random_number(2), qdd[i][j] = random_number(2);
    for (int block = 0; block < blocks; block++) {{
        double x[N], y[N] = {{ 0 }}, t[6];
        t[0] = now();
        for (int i = 0; i < CALLS; i++)
            {name}_tau(q[i], qd[i], qdd[i], {given}tau[i]);
        t[1] = now();
        for (int i = 0; i < CALLS; i++) {{
            for (int j = 0; j < N; j++)
                x[j] = q[i][j];
            {name}_tau(x, qd[i], qdd[i], {given}tau[i]);
        }}
        t[2] = now();
        for (int i = 0; i < CALLS; i++) {{
            for (int j = 0; j < N; j++)
                x[j] = q[i][j] + 1e-30 * y[j];
            {name}_tau(x, qd[i], qdd[i], {given}y);
        }}
        t[3] = now();
        {name}_tau_batch(BATCH, q[0], N, 1, qd[0], N, 1, qdd[0], N, 1, {given_batch}tau[0], N, 1);
        t[4] = now();
        {name}_tau_batch(BATCH, q[0], 1, BATCH, qd[0], 1, BATCH, qdd[0], 1, BATCH,
                         {given_batch}tau[0], 1, BATCH);
        t[5] = now();
        for (int k = 0; k < 5; k++) {{
            const double each = (t[k + 1] - t[k]) / (k < 3 ? CALLS : BATCH);
            if (each < best[k])
                best[k] = each;
        }}
    }}
    printf("%g %g %g %g %g", best[0], best[1], best[2], best[3], best[4]);
    return 0;
}}
"""


def build_driver(kernel: Kernel, folder: Path, *flags: str) -> Path:
    """Compile the driver and the kernel's source, as the kernel's library was, into a program."""
    given = [f"{0.5 if x is None else x!r}" for x in kernel.parameters.values()]
    (folder / "driver.c").write_text(
        DRIVER.format(
            name=kernel.name,
            dof=kernel.dof,
            batch=BATCH,
            values=", ".join(given) or "0",
            given="parameters, " if given else "",
            given_batch="parameters, 0, 1, " if given else "",
        )
    )
    compiler = find_compiler()
    usual = [flag for flag in compiler.flags if flag not in ("-shared", "-fPIC")]
    sources = ["driver.c", kernel.source, f"-I{kernel.directory}", "-lm"]
    command = [*compiler.command, *usual, *flags, *sources, "-o", "driver"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "driver"


def in_c(kernel: Kernel) -> list[float]:
    """Return ns per call (back to back, fresh, chained) and per sample (rows, columns)."""
    with tempfile.TemporaryDirectory() as folder:
        program = build_driver(kernel, Path(folder))
        done = subprocess.run([program], capture_output=True, text=True, check=True)
    return [float(x) for x in done.stdout.split()]


def instructions(kernel: Kernel) -> float | None:
    """Return the instructions of one call, or None without valgrind."""
    if shutil.which("valgrind") is None or platform.machine() != "x86_64":
        return None
    with tempfile.TemporaryDirectory() as folder:
        program = build_driver(kernel, Path(folder), "-march=haswell")
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--toggle-collect={kernel.name}_tau",
             "--callgrind-out-file=/dev/null", program, "1"],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    (collected,) = (line for line in done.stderr.splitlines() if "Collected" in line)
    return int(collected.split(":")[1]) / (3 * 256)


def from_python(kernel: Kernel) -> list[float]:
    """Return ns per call with out=, with a new result, of lists; and per sample of a batch."""
    rng = np.random.default_rng(0)
    q, qd, qdd = rng.uniform(-2, 2, (3, kernel.dof))
    names = {
        "tau": kernel.tau,
        "q": q,
        "qd": qd,
        "qdd": qdd,
        "lists": [x.tolist() for x in (q, qd, qdd)],
        "batch": list(rng.uniform(-2, 2, (3, BATCH, kernel.dof))),
        "out": np.empty(kernel.dof),
        "values": np.full(len(kernel.parameters), 0.5),
    }
    given = ", parameters=values" if kernel.parameters else ""
    calls = {
        f"tau(q, qd, qdd{given}, out=out)": 1,
        f"tau(q, qd, qdd{given})": 1,
        f"tau(*lists{given})": 1,
        f"tau(*batch{given})": BATCH,
    }
    return [fastest(timeit.Timer(call, globals=names)) / samples for call, samples in calls.items()]


def fastest(timer: timeit.Timer, repeats: int = 30, block: float = 0.005) -> float:
    """Return ns per execution, of the fastest of many blocks of so many seconds."""
    number = max(1, int(block / timer.timeit(1)))
    number = max(1, int(block / (timer.timeit(number) / number)))
    return 1e9 * min(timer.repeat(repeats, number)) / number


def main(arms: list[str]) -> None:
    """Print a table of the arms."""
    compiler = find_compiler()
    print(f"{compiler.version} {' '.join(compiler.flags)}; NumPy {np.__version__}; ns\n")
    columns = [
        "operations", "C call", "fresh", "chained", "batch rows", "columns",
        "py out=", "py new", "py lists", "py batch", "instructions",
    ]  # fmt: skip
    print("arm".ljust(14) + "".join(f"{column:>13}" for column in columns))
    for arm in arms:
        kernel = compile(moro.load(arm))
        operations = sum(kernel.ops["tau"].get(op, 0) for op in ("add", "sub", "mul"))
        counted = instructions(kernel)
        cells = [
            f"{operations}",
            *(f"{ns:.1f}" for ns in (*in_c(kernel), *from_python(kernel))),
            "-" if counted is None else f"{counted:.0f}",
        ]
        print(kernel.name.ljust(14) + "".join(f"{cell:>13}" for cell in cells))


if __name__ == "__main__":
    main(sys.argv[1:] or list(ARMS))
