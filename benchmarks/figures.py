"""From records to the figures that the project aims at, and to where a peer is faster."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

Record = dict[str, Any]

#: operations of tau, rigid bodies
OPERATIONS = {"puma560": 265, "stanford_arm": 220, "panda": 500, "ur5": 195, "two_link": 22}
#: {function: (what Pinocchio calls it, times faster)}
AGAINST_PINOCCHIO = {
    "inertia_matrix": ("crba", 5),
    "forward_dynamics": ("aba", 5),
    "tau_derivatives": ("computeRNEADerivatives", 10),
}
#: generating and compiling may take this much longer than growth with the number of joints
GROWTH = 1.5
SHORT, LONG = 5, 50


@dataclass(frozen=True)
class Figure:
    """Something measured, and what it is to reach."""

    measure: str
    reach: float
    #: None: not measured in this run
    now: float | None
    #: at least (times faster), or at most (operations, growth)
    at_least: bool = True

    @property
    def reached(self) -> bool:
        """Tell whether it is what it should be."""
        if self.now is None:
            return False
        return self.now >= self.reach if self.at_least else self.now <= self.reach


def figures(results: Record) -> list[Figure]:
    """Return all figures of a run."""
    single = [r for r in results["calls"] if not r["dependent"]]
    waiting = [r for r in results["calls"] if r["dependent"]]
    tau = [r for r in single if r["function"] == "tau"]
    derivatives = [r for r in single if r["function"] == "tau_derivatives"]
    large = max((r["batch"] for r in results["batches"]), default=0)
    batch = [r for r in results["batches"] if r["batch"] == large and r["arm"] == "ur5"]
    found = [
        Figure(
            "tau, calls in a row, against CasADi, the least of all arms", 3, slowdown(tau, "CasADi")
        ),
        Figure("the same where calls wait for each other", 2.5, slowdown(waiting, "CasADi")),
        Figure(
            "tau_derivatives against CasADi, the least of all arms",
            2.5,
            slowdown(derivatives, "CasADi"),
        ),
        Figure(
            "tau, one C call, UR5, against Pinocchio's rnea",
            20,
            slowdown(tau, "Pinocchio", arm="ur5"),
        ),
        Figure(f"batch of {large}, UR5, against CasADi in a loop", 10, slowdown(batch, "CasADi")),
        Figure("the same against Pinocchio's rnea in a loop", 75, slowdown(batch, "Pinocchio")),
        Figure(
            "one call from Python, UR5, against pin.rnea",
            5,
            slowdown(results["python"], "Pinocchio", arm="ur5"),
        ),
    ]
    for function, (peer, reach) in AGAINST_PINOCCHIO.items():
        of_arms = [r for r in single if r["function"] == function and r["dof"] > 2]
        measure = f"{function} against {peer}, the least of all arms"
        found.append(Figure(measure, reach, slowdown(of_arms, "Pinocchio")))
    counts = {r["arm"]: r["add"] + r["mul"] for r in results["operations"]}
    for arm, reach in OPERATIONS.items():
        found.append(
            Figure(f"operations of tau, {arm}, rigid", reach, counts.get(arm), at_least=False)
        )
    found.append(
        Figure(
            f"generating and compiling tau, {SHORT} to {LONG} joints, against linear growth",
            GROWTH,
            _growth(results["making"]),
            at_least=False,
        )
    )
    return found


def slowdown(records: Iterable[Record], peer: str, **where: Any) -> float | None:
    """Return how many times longer than moro the peer takes at least: of all arms and its ways."""
    ratios = [
        r["ratio"]
        for r in records
        if r["contender"].startswith(peer) and all(r[key] == x for key, x in where.items())
    ]
    return min(ratios, default=None)


def faster_peers(results: Record) -> Iterator[str]:
    """Yield every comparison that moro loses."""
    for r in results["calls"]:
        if _loses(r):
            way = "one after the other" if r["dependent"] else "in a row"
            yield f"{r['function']}, {r['arm']}, calls in C {way}: {_by(r)}"
    for r in results["batches"]:
        if _loses(r):
            yield f"tau, {r['arm']}, batches of {r['batch']}: {_by(r)}"
    for r in results["python"]:
        if _loses(r):
            yield f"tau, {r['arm']}, from Python: {_by(r)}"
    for r in results["growth"]:
        if _loses(r):
            yield f"tau, {r['dof']} joints, calls in C: {_by(r)}"
    seconds = {(r["dof"], r["contender"]): r["generate"] + r["compile"] for r in results["making"]}
    for (dof, contender), taken in seconds.items():
        if taken < seconds[dof, "moro"]:
            times = seconds[dof, "moro"] / taken
            yield f"making tau, {dof} joints: {contender} is {times:.1f} times faster"


def _loses(record: Record) -> bool:
    return record["ratio"] < 1 and not record["contender"].startswith("moro")


def _by(record: Record) -> str:
    return f"{record['contender']} is {1 / record['ratio']:.2f} times faster"


def _growth(making: Iterable[Record]) -> float | None:
    """Return how much more than the number of joints the time to make tau has grown."""
    seconds = {r["dof"]: r["generate"] + r["compile"] for r in making if r["contender"] == "moro"}
    if SHORT not in seconds or LONG not in seconds:
        return None
    return float(seconds[LONG] / seconds[SHORT] * SHORT / LONG)
