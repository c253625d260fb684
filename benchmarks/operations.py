"""What each pass saves: operations of tau with and without it, and the time to generate.

    python benchmarks/operations.py            prints the tables
    python benchmarks/operations.py --write    writes benchmarks/results/operations.json too

Operations are additions, subtractions and multiplications of the rigid bodies' torques, without
friction and rotor inertia; + k: pairs of sine and cosine. Times are of one core, best of five, from
the exact model to the program (no text, no compiler).
"""

from __future__ import annotations

import argparse
import itertools
import json
import platform
import time
from collections.abc import Collection
from pathlib import Path

import sympy as sp

import moro as mr
from moro.abc import joint_variable
from moro.model import Model
from moro_codegen.passes import PASSES, Pass
from moro_codegen.program import generate

ARMS = ("puma560", "stanford_arm", "panda", "ur5", "two_link")
JOINTS = (5, 10, 20, 50)
RESULTS = Path(__file__).parent / "results" / "operations.json"

Count = tuple[int, int]


def operations(model: Model, passes: Collection[Pass]) -> Count:
    """Return the operations of tau, and its sine-cosine pairs, with some of the passes."""
    ops = generate(model, rigid=True, passes=passes).routines[0].ops
    return ops["add"] + ops["sub"] + ops["mul"], ops["sincos"]


def table() -> dict[str, dict[str, Count]]:
    """Return the operations of every arm: as passes come one after the other, and without each."""
    models = {name: mr.load(name).model() for name in ARMS}
    rows: dict[str, Collection[Pass]] = {"Newton-Euler, constants folded": ()}
    for i, added in enumerate(PASSES):
        rows[f"+ {added.value}"] = PASSES[: i + 1]
    for missing in PASSES:
        rows[f"all but {missing.value}"] = [other for other in PASSES if other is not missing]
    return {
        row: {arm: operations(model, passes) for arm, model in models.items()}
        for row, passes in rows.items()
    }


def seconds(model: Model) -> float:
    """Return the time to generate tau, friction included."""
    times = []
    for _ in range(5):
        start = time.process_time()
        generate(model)
        times.append(time.process_time() - start)
    return min(times)


def long_arm(n: int) -> Model:
    """Return an arm of n joints, axes alternating, with full tensors and every distance."""
    figures = itertools.count(1)

    def number() -> sp.Rational:
        return sp.Rational(next(figures) * 619 % 997, 1000)

    rows = [(number(), (-1) ** i * sp.pi / 2, number(), joint_variable(i)) for i in range(1, n + 1)]
    robot = mr.Robot(*rows, convention="mdh")
    robot.masses = [number() for _ in rows]
    robot.cm_positions = [[number() for _ in "xyz"] for _ in rows]
    tensors = []
    for _ in rows:
        points = sp.Matrix(3, 3, lambda *_: number())
        second = points * points.T
        tensors.append(second.trace() * sp.eye(3) - second)
    robot.inertia_tensors = tensors
    robot.gravity = [0, 0, sp.Rational("-9.81")]
    return robot.model()


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"write {RESULTS.name}")
    arguments = parser.parse_args()
    found = table()
    width = max(map(len, found))
    print(" " * width, *(f"{arm:>13}" for arm in ARMS))
    for row, counts in found.items():
        print(f"{row:{width}}", *(f"{n:>9} + {k}" for n, k in counts.values()))
    times = {arm: seconds(mr.load(arm).model()) for arm in ARMS}
    print(f"{'time to generate [ms]':{width}}", *(f"{1e3 * t:>13.1f}" for t in times.values()))
    growth = {}
    print("\njoints  operations  operations/joint  time [ms]  time/joint [ms]")
    for n in JOINTS:
        model = long_arm(n)
        ops, spent = operations(model, PASSES)[0], seconds(model)
        growth[n] = {"operations": ops, "seconds": spent}
        print(f"{n:6}  {ops:10}  {ops / n:16.1f}  {1e3 * spent:9.1f}  {1e3 * spent / n:15.2f}")
    if arguments.write:
        RESULTS.parent.mkdir(exist_ok=True)
        machine = {"python": platform.python_version(), "processor": platform.machine()}
        results = {"operations": found, "seconds": times, "growth": growth, "machine": machine}
        RESULTS.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
