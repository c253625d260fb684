"""How long the symbolic route takes: fully symbolic arms, to SymPy matrices, on one core.

    python benchmarks/symbolic.py            prints the table
    python benchmarks/symbolic.py --write    writes benchmarks/results/symbolic.json too

Every length, mass, centre of mass and full inertia tensor is a symbol. Each figure is the time of a
fresh robot from construction to the SymPy result, best of three.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import sympy as sp

from moro import Robot
from moro.abc import joint_variable, symbol

REPEATS = 3
RESULTS = Path(__file__).parent / "results" / "symbolic.json"

QUANTITIES: dict[str, Callable[[Robot], Any]] = {
    "M": Robot.inertia_matrix,
    "G": Robot.gravity_vector,
    "C": Robot.coriolis_matrix,
    "Euler-Lagrange": Robot.dynamic_model,
}

#: seconds that it should take at most
LIMITS = {
    ("PUMA 560", "M"): 0.5,
    ("PUMA 560", "G"): 0.1,
    ("PUMA 560", "C"): 3.0,
    ("PUMA 560", "Euler-Lagrange"): 6.0,
    ("seven joints", "M"): 2.0,
    ("seven joints", "C"): 20.0,
    ("planar, 10 joints", "M"): 2.0,
}


def arm(twists: list[Any], *, a: bool = True, d: bool = True) -> Robot:
    """Return an arm with these twists whose every other constant is a symbol."""
    n = len(twists)
    rows = [
        (symbol("a", i) if a else 0, alpha, symbol("d", i) if d else 0, joint_variable(i))
        for i, alpha in enumerate(twists, 1)
    ]
    robot = Robot(*rows)
    robot.masses = None
    robot.cm_positions = [[sp.Symbol(f"{x}_{i}") for x in "xyz"] for i in range(1, n + 1)]
    robot.inertia_tensors = [
        sp.Matrix(3, 3, lambda j, k, i=i: sp.Symbol(f"I_{min(j, k)}{max(j, k)}_{i}"))
        for i in range(1, n + 1)
    ]
    robot.gravity = [0, -symbol("g"), 0] if not any(twists) else [0, 0, -symbol("g")]
    return robot


def puma560() -> Robot:
    """All six link lengths and offsets symbolic."""
    return arm([sp.pi / 2, 0, -sp.pi / 2, sp.pi / 2, -sp.pi / 2, 0])


def seven_joints() -> Robot:
    """Alternating axes that intersect, as in the KUKA LWR and iiwa."""
    return arm([sp.pi / 2, -sp.pi / 2] * 3 + [0], a=False)


def planar(n: int) -> Robot:
    """Parallel axes, in a vertical plane."""
    return arm([0] * n, d=False)


def elbows(n: int) -> Robot:
    """Alternating axes with all lengths: the growth over the number of joints."""
    return arm(([sp.pi / 2, -sp.pi / 2] * n)[:n], a=False)


def seconds(make: Callable[[], Robot], quantity: Callable[[Robot], Any]) -> float:
    """Return the time from rows to SymPy result [s], best of three fresh robots."""
    best = float("inf")
    for _ in range(REPEATS):
        start = time.perf_counter()
        quantity(make())
        best = min(best, time.perf_counter() - start)
        if best > 5:
            break
    return best


def measurements(longest: int) -> Iterator[tuple[str, str, float]]:
    """Yield (arm, quantity, seconds)."""
    arms = {"PUMA 560": puma560, "seven joints": seven_joints}
    for name, make in arms.items():
        for quantity, compute in QUANTITIES.items():
            yield name, quantity, seconds(make, compute)
    yield "planar, 10 joints", "M", seconds(lambda: planar(10), Robot.inertia_matrix)
    for kind, of in (("planar", planar), ("alternating", elbows)):
        for n in range(1, longest + 1):
            for quantity in ("M", "C"):
                if kind == "alternating" and n > (8 if quantity == "M" else 7):
                    continue  # closed forms of a minute and more
                taken = seconds(lambda of=of, n=n: of(n), QUANTITIES[quantity])
                yield f"{kind}, {n} joints", quantity, taken


def main() -> None:
    """Print the table; write the results where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--write", action="store_true", help="write benchmarks/results/symbolic.json"
    )
    parser.add_argument("--longest", type=int, default=10, help="number of joints to grow to")
    arguments = parser.parse_args()
    sp.Symbol("warm_up") + 1
    results = []
    print(f"{'arm':22} {'quantity':16} {'time [s]':>10} {'allowed':>10}")
    for name, quantity, taken in measurements(arguments.longest):
        limit = LIMITS.get((name, quantity))
        print(f"{name:22} {quantity:16} {taken:10.3f} {limit or '':>10}", flush=True)
        results.append({"arm": name, "quantity": quantity, "seconds": taken, "allowed": limit})
    if arguments.write:
        RESULTS.parent.mkdir(exist_ok=True)
        machine = {
            "python": platform.python_version(),
            "sympy": sp.__version__,
            "processor": platform.processor() or platform.machine(),
        }
        RESULTS.write_text(json.dumps({"machine": machine, "results": results}, indent=1) + "\n")
        print(f"written to {RESULTS}", file=sys.stderr)


if __name__ == "__main__":
    main()
