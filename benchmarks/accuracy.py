"""How accurate kernels are: the errors of tau against 50 digits, and those of the sines.

    python benchmarks/accuracy.py [STATES]

For every packaged arm, in double and in single precision, at random states: the largest error of
the torques relative to the largest torque of the state. Batches give the bits of single calls,
which is checked. Writes accuracy.json, accuracy.svg and accuracy.png into benchmarks/results.
"""

import argparse
import json
import platform
import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import moro
from moro.io import packaged
from moro_codegen import build, compile
from moro_codegen.accuracy import sine_errors, tau_errors
from moro_codegen.functions import Argument, Function, System
from moro_codegen.generate import Program, routine
from moro_codegen.graph import Graph

RESULTS = Path(__file__).parent / "results"
STATES = 500
ANGLES = 4000
#: for dtype, its unit roundoff, and the angle up to which sines do not leave it to libm
TYPES = {"float64": (2.0**-53, 1e5), "float32": (2.0**-24, 1e3)}
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
        "sines", (argument,), results, "",
        lambda system, q: [[system.graph.sin(q[0])], [system.graph.cos(q[0])]],
    )  # fmt: skip
    entry = routine(System(Graph(), moro.load("two_link").model()), pair)
    program = Program("circle", 1, ("revolute",), (), (entry,))
    program = replace(program, scalar="float" if dtype == "float32" else "double")
    rng = np.random.default_rng(1)
    limit = TYPES[dtype][1]
    x = np.concatenate([rng.uniform(-4, 4, ANGLES // 2), rng.uniform(-limit, limit, ANGLES // 2)])
    x = x.astype(dtype)
    with tempfile.TemporaryDirectory() as folder:
        sine, cosine = build(program, Path(folder) / "circle").sines(x[:, None])
    return np.concatenate([sine_errors(sine[:, 0], x, "sin"), sine_errors(cosine[:, 0], x, "cos")])


def summary(errors: np.ndarray) -> dict[str, float]:
    """Return percentiles of the errors."""
    return {f"{p} %": float(np.percentile(errors, p)) for p in PERCENTILES}


def draw(tau: dict[str, dict[str, np.ndarray]], sines: dict[str, np.ndarray]) -> None:
    """Draw how many of the states have errors up to a size."""
    plt.rcParams.update({"svg.hashsalt": "moro", "svg.fonttype": "none", "font.size": 9})
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained", sharey=True)
    for axis, (dtype, arms) in zip(axes[:2], tau.items(), strict=True):
        roundoff = TYPES[dtype][0]
        for name, errors in arms.items():
            _steps(axis, errors / roundoff, name)
        axis.set_xscale("log")
        axis.set_title(f"tau, {dtype}")
        axis.set_xlabel(f"error / largest torque, in units of $2^{{{np.log2(roundoff):.0f}}}$")
    for dtype, errors in sines.items():
        _steps(axes[2], errors, f"{dtype}, $|q| \\leq 10^{{{np.log10(TYPES[dtype][1]):.0f}}}$")
    axes[2].set_title("sines and cosines")
    axes[2].set_xlabel("error, in units in the last place")
    axes[0].set_ylabel("share of states with at most this error")
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.legend(loc="lower right", fontsize=7)
    for kind in ("svg", "png"):
        metadata = {"Date": None} if kind == "svg" else {}
        figure.savefig(RESULTS / f"accuracy.{kind}", dpi=100, metadata=metadata)


def _steps(axis: plt.Axes, errors: np.ndarray, label: str) -> None:
    share = np.linspace(0, 1, 101)
    axis.plot(np.maximum(np.quantile(errors, share), 1e-3), share, label=label, linewidth=1.2)


def main(states: int) -> None:
    """Measure, print, write and draw."""
    RESULTS.mkdir(exist_ok=True)
    tau = {
        dtype: {name: errors_of_tau(name, dtype, states) for name in packaged()} for dtype in TYPES
    }
    sines = {dtype: errors_of_sines(dtype) for dtype in TYPES}
    report = {
        "machine": platform.machine(),
        "states": states,
        "tau": {
            dtype: {name: summary(errors) for name, errors in arms.items()}
            for dtype, arms in tau.items()
        },
        "sines": {dtype: summary(errors) for dtype, errors in sines.items()},
    }
    (RESULTS / "accuracy.json").write_text(json.dumps(report, indent=2) + "\n")
    print(json.dumps(report, indent=2))
    draw(tau, sines)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("states", type=int, nargs="?", default=STATES, help="states of each arm")
    main(parser.parse_args().states)
