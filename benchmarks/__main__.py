"""Measure moro beside its peers: ``make bench``, or ``python -m benchmarks`` with the peers there.

Prints the tables, and writes benchmarks/results: peers.json, peers.md, and the charts.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from benchmarks import arms, machine, measures, native, peers, timing
from benchmarks.report import report

RESULTS = Path(__file__).parent / "results"
SECTIONS = ("operations", "passes", "calls", "batches", "python", "growth", "making")
#: the arms whose cost by batch size is shown
BATCHED = ("ur5", "panda", "seven_axis")


def main() -> None:
    """Run what is asked for; write results and charts where everything was."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=SECTIONS, metavar="SECTION")
    parser.add_argument("--arms", nargs="+", metavar="ARM", help="only these arms")
    parser.add_argument("--functions", nargs="+", metavar="NAME", help="only these functions")
    parser.add_argument("--output", type=Path, help="folder of the results, benchmarks/results")
    given = parser.parse_args()
    whole = tuple(given.only) == SECTIONS and not given.arms and not given.functions
    found = peers.find()
    if "moro" not in found.present:
        sys.exit(f"moro itself does not work here: {found.absent['moro']}")
    core = machine.keep_to_one_core()
    try:
        sections = measured(found, given)
    except measures.DisagreementError as error:
        sys.exit(f"No comparison: {error}")
    results = {
        **machine.provenance(found.versions, native.compilers()),
        "settings": {
            "core": core,
            "states": arms.STATES,
            "rounds": timing.ROUNDS,
            "block_seconds": timing.BLOCK,
            "agreement": measures.AGREEMENT,
            "flags": found.flags,
        },
        **sections,
        "absent": found.absent,
    }
    text = report(results)
    print(text)
    output = given.output or (RESULTS if whole else None)
    if output is None:
        print("A part of the measurements: nothing written.", file=sys.stderr)
        return
    output.mkdir(parents=True, exist_ok=True)
    (output / "peers.json").write_text(json.dumps(results, indent=1) + "\n")
    (output / "peers.md").write_text(text)
    from benchmarks.charts import draw

    for path in draw(results, output):
        print(f"written: {path}", file=sys.stderr)


def measured(found: peers.Peers, given: argparse.Namespace) -> dict[str, list[dict[str, Any]]]:
    """Return the records of every section; those not asked for are empty."""
    chosen = [arm for arm in arms.measured() if not given.arms or arm.label in given.arms]
    batched = [arm for arm in chosen if arm.label in BATCHED]
    modules = usable(found)
    run: dict[str, Callable[[], Iterable[dict[str, Any]]]] = {
        "operations": lambda: measures.operations(chosen, modules),
        "passes": measures.passes,
        "calls": lambda: measures.calls(chosen, modules, given.functions),
        "batches": lambda: measures.batches(batched, modules),
        "python": lambda: measures.python(chosen, modules),
        "growth": lambda: measures.growth(modules),
        "making": lambda: measures.making(modules),
    }
    return {name: told(name, run[name]()) if name in given.only else [] for name in SECTIONS}


def usable(found: peers.Peers) -> dict[str, Any]:
    """Return the peers that build here; those that do not join the absent ones."""
    modules = dict(found.present)
    for name, module in found.present.items():
        if not hasattr(module, "build"):
            continue
        print(
            f"{name}: compiling, unless it is there (once, Pinocchio takes minutes)",
            file=sys.stderr,
        )
        try:
            module.build()
        except Exception as error:  # whatever a peer's compilation or library raises
            found.absent[name] = f"{type(error).__name__}: {error}"
            del modules[name]
    return modules


def told(section: str, records: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the records; say as they come what has been done."""
    done, last = [], None
    for record in records:
        done.append(record)
        now = [
            str(record[key])
            for key in ("arm", "passes", "function", "batch", "dof")
            if key in record
        ]
        if now != last:
            print(f"{section}: {', '.join(now)}", file=sys.stderr, flush=True)
            last = now
    return done


if __name__ == "__main__":
    main()
