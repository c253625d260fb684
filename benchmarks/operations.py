"""What each pass saves: operations with and without it, cycles to wait, and the time to generate.

    python benchmarks/operations.py            prints the tables
    python benchmarks/operations.py --write    writes benchmarks/results/operations.json too

Operations are additions, subtractions and multiplications of the rigid bodies, without friction and
rotor inertia; + k: pairs of sine and cosine. Times are of one core, best of five, from
the exact model to the program (no text, no compiler).
"""

from __future__ import annotations

import argparse
import itertools
import json
import platform
import time
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

import sympy as sp

import moro as mr
from moro.abc import joint_variable
from moro.model import Model
from moro_codegen.passes import PASSES, Pass
from moro_codegen.passes.arrival import last
from moro_codegen.program import generate

ARMS = ("puma560", "stanford_arm", "panda", "ur5", "two_link")
#: what has a closed form, beside tau
FUNCTIONS = (
    "bias",
    "gravity_vector",
    "inertia_matrix",
    "coriolis_matrix",
    "kinetic_energy",
    "potential_energy",
    "forward_kinematics",
    "jacobian",
)
#: how long is waited for which results is shown
WAITED_FOR = ("tau", "bias", "inertia_matrix", "coriolis_matrix", "forward_dynamics")
JOINTS = (5, 10, 20, 50)
#: what the code takes that Symoro+ 1.6 generated for the KUKA LWR, public in the folder LWR of
#: github.com/ISIR-SYROCO/kukaKDL, for the same task. The files print counts with friction, a wrench
#: at the tip and gravity in any direction (LWR.ccgo, the bias: 359 additions, 363 multiplications);
#: these are without, gravity along z, constants folded, equal expressions once, unused ones never
SYMORO = {"tau": 572, "bias": 547, "inertia_matrix": 355, "gravity_vector": 86}
RESULTS = Path(__file__).parent / "results" / "operations.json"

Count = tuple[int, int]


def operations(model: Model, passes: Collection[Pass], function: str = "tau") -> Count:
    """Return the operations of a function, and its sine-cosine pairs, with some of the passes."""
    ops = generate(model, (function,), rigid=True, passes=passes).routines[0].ops
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


def functions() -> dict[str, dict[str, tuple[Count, Count, Count]]]:
    """Return the operations of functions of every arm: three ways.

    From recursions, sum by sum; with what several sums have in common computed once; with closed
    forms where they are shorter.
    """
    models = {name: mr.load(name).model() for name in ARMS}
    ways = [
        [x for x in PASSES if x not in left]
        for left in ((Pass.COMMON_DIVISORS, Pass.CLOSED_FORMS), (Pass.CLOSED_FORMS,), ())
    ]
    found: dict[str, dict[str, tuple[Count, Count, Count]]] = {}
    for name in FUNCTIONS:
        for arm, model in models.items():
            first, second, third = (operations(model, passes, name) for passes in ways)
            found.setdefault(name, {})[arm] = first, second, third
    return found


def latencies() -> dict[str, dict[str, tuple[int, int]]]:
    """Return the cycles to the last result of every arm: as written, and in order of arrival."""
    found: dict[str, dict[str, tuple[int, int]]] = {}
    written = [x for x in PASSES if x is not Pass.ORDER_OF_ARRIVAL]
    for name in WAITED_FOR:
        for arm in ARMS:
            if (name, arm) == ("forward_dynamics", "ur5"):
                continue  # nothing resists its last joint
            model = mr.load(arm).model()
            before, after = (
                generate(model, (name,), rigid=True, passes=passes).routines[0].results
                for passes in (written, PASSES)
            )
            found.setdefault(name, {})[arm] = last(before), last(after)
    return found


def peer() -> dict[str, tuple[int, int]]:
    """Return the operations of the KUKA LWR's functions: moro's, and Symoro+'s."""
    model = kuka_lwr()
    return {name: (operations(model, PASSES, name)[0], count) for name, count in SYMORO.items()}


def kuka_lwr() -> Model:
    """Return an arm with the geometry of the KUKA LWR, full tensors and gravity along z."""
    half = sp.pi / 2
    twists = (0, half, -half, -half, half, half, -half)
    shifts = {3: sp.Rational("0.4"), 5: sp.Rational("0.39")}
    return _full(
        [(0, twist, shifts.get(i, 0), joint_variable(i)) for i, twist in enumerate(twists, 1)],
        _numbers(),
    )


def long_arm(n: int) -> Model:
    """Return an arm of n joints, axes alternating, with full tensors and every distance."""
    numbers = _numbers()
    rows = [
        (next(numbers), (-1) ** i * sp.pi / 2, next(numbers), joint_variable(i))
        for i in range(1, n + 1)
    ]
    return _full(rows, numbers)


def _numbers() -> Iterator[sp.Rational]:
    for k in itertools.count(1):
        yield sp.Rational(k * 619 % 997, 1000)


def _full(rows: Sequence[tuple[Any, ...]], numbers: Iterator[sp.Rational]) -> Model:
    """Return the arm of modified DH rows in which every inertial parameter is there."""
    robot = mr.Robot(*rows, convention="mdh")
    robot.masses = [next(numbers) for _ in rows]
    robot.cm_positions = [[next(numbers) for _ in "xyz"] for _ in rows]
    tensors = []
    for _ in rows:
        points = sp.Matrix(3, 3, lambda *_: next(numbers))
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
    of_functions, beside = functions(), peer()
    print("\nsum by sum, shared, closed forms")
    for name, counts in of_functions.items():
        cells = ("/".join(f"{n}" for n, _ in three) for three in counts.values())
        print(f"{name:{width}}", *(f"{cell:>13}" for cell in cells))
    waits = latencies()
    print("\ncycles to the last result: as written/in order of arrival")
    for name, cycles in waits.items():
        cells = ("/".join(map(str, cycles[arm])) if arm in cycles else "-" for arm in ARMS)
        print(f"{name:{width}}", *(f"{cell:>13}" for cell in cells))
    print("\nKUKA LWR, full tensors: moro, Symoro+")
    for name, (own, other) in beside.items():
        print(f"{name:{width}} {own:9} {other:9}")
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
        results = {
            "operations": found,
            "functions": of_functions,
            "latencies": waits,
            "kuka_lwr": beside,
            "seconds": times,
            "growth": growth,
            "machine": machine,
        }
        RESULTS.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
