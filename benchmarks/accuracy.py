"""How accurate kernels are: the errors of tau against 50 digits, and those of the sines.

    python -m benchmarks.accuracy [STATES]

For every packaged arm, in double and in single precision, at random states: the largest error of
the torques relative to the largest torque of the state. Batches give the bits of single calls,
which is checked. Writes accuracy.json, accuracy.svg and accuracy.png into benchmarks/results.
"""

import argparse
import json
import platform
import tempfile
from pathlib import Path

import numpy as np

import moro
from benchmarks.charts import ARMS, draw_accuracy
from moro.formats.loading import packaged
from moro_codegen import build, compile
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Graph
from moro_codegen.program import Program, routine
from moro_codegen.proof.accuracy import sine_errors, tau_errors
from moro_codegen.signature import real

RESULTS = Path(__file__).parent / "results"
STATES = 500
ANGLES = 4000
#: for dtype, the angle up to which sines do not leave it to libm
TYPES = {"float64": 1e5, "float32": 1e3}
PERCENTILES = (50, 90, 99, 100)


def errors_of_tau(name: str, dtype: str, states: int) -> np.ndarray:
    """Return the relative errors of an arm's kernel at random states."""
    robot = moro.load(name)
    with tempfile.TemporaryDirectory() as folder:
        kernel = compile(robot, directory=folder, dtype=dtype)
        rng = np.random.default_rng(0)
        given = rng.uniform(-3, 3, (3, states, robot.dof)).astype(dtype)
        single = [kernel.tau(*rows) for rows in zip(*given, strict=True)]
        if not np.array_equal(kernel.tau(*given), single):
            raise AssertionError(f"{name}, {dtype}: the batch is not the single calls")
        return tau_errors(kernel, robot.model(), *given)


def errors_of_sines(dtype: str) -> np.ndarray:
    """Return the errors of sines and cosines in units in the last place."""
    argument = Argument("q", (1,), "rad", "angle")
    results = (Argument("sine", (1,), "1", ""), Argument("cosine", (1,), "1", ""))
    pair = Function(
        "sine_cosine", (argument,), results, "",
        lambda system, q: [[system.graph.sin(q[0])], [system.graph.cos(q[0])]],
    )  # fmt: skip
    entry = routine(System(Graph(), moro.load("two_link").model()), pair)
    program = Program("circle", 1, ("revolute",), (), (entry,), real(dtype))
    rng = np.random.default_rng(1)
    limit = TYPES[dtype]
    x = np.concatenate([rng.uniform(-4, 4, ANGLES // 2), rng.uniform(-limit, limit, ANGLES // 2)])
    x = x.astype(dtype)
    with tempfile.TemporaryDirectory() as folder:
        sine, cosine = build(program, Path(folder) / "circle").sine_cosine(x[:, None])
    return np.concatenate([sine_errors(sine[:, 0], x, "sin"), sine_errors(cosine[:, 0], x, "cos")])


def summary(errors: np.ndarray) -> dict[str, float]:
    """Return percentiles of the errors."""
    return {f"{p} %": float(np.percentile(errors, p)) for p in PERCENTILES}


def main(states: int) -> None:
    """Measure, print, write and draw."""
    RESULTS.mkdir(exist_ok=True)
    arms = [name for name in packaged() if name in ARMS]
    tau = {dtype: {name: errors_of_tau(name, dtype, states) for name in arms} for dtype in TYPES}
    sines = {dtype: errors_of_sines(dtype) for dtype in TYPES}
    report = {
        "machine": platform.machine(),
        "states": states,
        "tau": {
            dtype: {name: summary(errors) for name, errors in found.items()}
            for dtype, found in tau.items()
        },
        "sines": {dtype: summary(errors) for dtype, errors in sines.items()},
    }
    (RESULTS / "accuracy.json").write_text(json.dumps(report, indent=2) + "\n")
    print(json.dumps(report, indent=2))
    for path in draw_accuracy(report, RESULTS):
        print(path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("states", type=int, nargs="?", default=STATES, help="states of each arm")
    main(parser.parse_args().states)
