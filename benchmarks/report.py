"""A run as text: Markdown tables, readable as they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from benchmarks.figures import Figure, faster_peers, figures
from benchmarks.tasks import TASKS

Record = dict[str, Any]


def report(results: Record) -> str:
    """Return the whole run, section by section."""
    return "\n\n".join(block for block in _blocks(results) if block) + "\n"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table whose columns line up; all but the first are right-aligned."""
    cells = [list(head), *map(list, rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    lines = [
        "| "
        + " | ".join(
            cell.rjust(width) if k else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        + " |"
        for row in cells
    ]
    rule = "|" + "|".join("-" * (w + 1) + (":" if k else "-") for k, w in enumerate(widths)) + "|"
    return "\n".join([lines[0], rule, *lines[1:]])


def _blocks(results: Record) -> Iterator[str]:
    yield "# moro beside its peers"
    yield _where(results)
    measured = [f for f in figures(results) if f.now is not None]
    if measured:
        yield "## The figures aimed at\n\nTimes faster than the peer; operations; growth."
        yield table(("measure", "reach", "now", ""), map(_row, measured))
    for name, task in TASKS.items():
        for dependent in (False, True):
            chosen = [
                r for r in results["calls"] if r["function"] == name and r["dependent"] == dependent
            ]
            if chosen:
                way = "one after the other" if dependent else "in a row"
                title = f"## {name}, calls in C {way} [ns]"
                peer = f"Pinocchio is asked by `{task.pinocchio}`. " if not dependent else ""
                yield f"{title}\n\n{peer}In brackets: how many times longer than moro."
                yield _by_arm(chosen)
    for arm in dict.fromkeys(r["arm"] for r in results["batches"]):
        chosen = [r for r in results["batches"] if r["arm"] == arm]
        yield f"## tau of {arm} by size of the batch, in C [ns for each sample]"
        yield _pivot(chosen, "batch", "best", _number)
    if results["python"]:
        yield "## tau, one call from Python [ns]"
        yield _by_arm(results["python"])
    if results["growth"]:
        yield "## tau by number of joints, calls in C [ns]\n\nSynthetic arms with full tensors."
        yield _pivot(results["growth"], "dof", "best", _number)
    if results["making"]:
        yield "## Making tau by number of joints [s]\n\nGenerating C text + the compiler."
        rows = [
            {**r, "both": f"{r['generate']:.2f} + {r['compile']:.2f}"} for r in results["making"]
        ]
        yield _pivot(rows, "dof", "both", str)
    if results["operations"]:
        yield (
            "## Operations of tau\n\nAdditions, subtractions, multiplications (and negations, in "
            "CasADi's code); sines and cosines apart."
        )
        names = list(dict.fromkeys(n for r in results["operations"] for n in r.get("casadi", {})))
        yield table(
            ("arm", "moro", "sine-cosine pairs", *names),
            (
                (
                    r["arm"],
                    str(r["add"] + r["mul"]),
                    str(r["sincos"]),
                    *(str(r["casadi"][n]) for n in names),
                )
                for r in results["operations"]
            ),
        )
    if results["passes"]:
        yield "## Operations of tau by pass of the generator\n\n+ k: pairs of sine and cosine."
        rows = [
            {**r, "contender": r["arm"], "count": f"{r['operations']} + {r['sincos']}"}
            for r in results["passes"]
        ]
        yield _pivot(rows, "passes", "count", str)
    if results["calls"] or results["batches"] or results["python"] or results["making"]:
        losses = "\n".join(f"- {line}" for line in faster_peers(results))
        yield f"## Where a peer is faster\n\n{losses or 'Nowhere in this run.'}"
    if results["absent"]:
        yield "## Not measured"
        yield "\n".join(f"- {name}: {why}" for name, why in results["absent"].items())


def _row(figure: Figure) -> tuple[str, ...]:
    bound = "" if figure.at_least else "at most "
    reached = "" if figure.reached else "**missed**"
    return figure.measure, f"{bound}{figure.reach:g}", _number(figure.now or 0), reached


def _where(results: Record) -> str:
    machine, versions = results["machine"], results["versions"]
    changes = ", with uncommitted changes" if results["uncommitted_changes"] else ""
    return "\n".join(
        [
            f"- {machine['processor']}, {machine['cores']} cores of which one is used, "
            f"{machine['system']}",
            f"- {'; '.join(results['compilers'].values())}",
            "- " + ", ".join(f"{name} {version}" for name, version in versions.items()),
            f"- commit {results['commit'][:12]}{changes}, {results['when'][:10]}",
            f"- {results['settings']['states']} random states, processor time, the fastest of "
            f"{results['settings']['rounds']} rounds that take turns; all contenders agree to "
            f"{results['settings']['agreement']:.0e} of the largest result of a state",
        ]
    )


def _by_arm(records: Sequence[Record]) -> str:
    marked = [
        {**r, "text": _number(r["best"]) + ("" if r["ratio"] == 1 else f" ({r['ratio']:.1f})")}
        for r in records
    ]
    return _pivot(marked, "arm", "text", str)


def _pivot(records: Sequence[Record], row: str, value: str, show: Any) -> str:
    """Return a table with a row for each value of ``row`` and a column for each contender."""
    names = list(dict.fromkeys(r["contender"] for r in records))
    cells = {(r[row], r["contender"]): show(r[value]) for r in records}
    keys = list(dict.fromkeys(r[row] for r in records))
    return table(
        (row, *names), ((str(key), *(cells.get((key, n), "-") for n in names)) for key in keys)
    )


def _number(x: float) -> str:
    return f"{x:.0f}" if x >= 100 or x == int(x) else f"{x:.1f}" if x >= 10 else f"{x:.2f}"
