"""What is measured: each section compares contenders that gave the same results before.

A section yields records, plain dictionaries that go to benchmarks/results as they are. Times are in
nanoseconds for one evaluation; "ratio" is how many times longer than moro's a contender takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any

import numpy as np

from benchmarks.arms import STATES, Arm, Array, chain
from benchmarks.native import Run
from benchmarks.operations import table as operations_table
from benchmarks.tasks import TASKS, Task
from benchmarks.timing import Block, Sample, collector_off, interleaved, python_block
from moro.algorithms.coordinates import displacements
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import posture

Record = dict[str, Any]
#: what is measured, and the contender
Key = tuple[Any, str]
Modules = Mapping[str, ModuleType]

#: what moro is called among the contenders: a call for each sample, and one for all of them
CALL, BATCH = "moro", "moro, batch"

#: results of a state differ by no more than this, relative to its largest
AGREEMENT = 1e-10
#: inertia matrices that are closer to singular than this have no forward dynamics worth comparing
CONDITION = 1e9
#: states that a call from Python cycles through
PYTHON_STATES = 64

BATCH_SIZES = (1, 2, 4, 8, 16, 64, 256, 1024, 4096)
#: numbers of joints
LENGTHS = (2, 5, 10, 20, 30, 40, 50)


class DisagreementError(RuntimeError):
    """A contender computes something else: to compare times would mean nothing."""


# -- one evaluation in C ---------------------------------------------------------------------------


def calls(
    arms: Iterable[Arm], modules: Modules, functions: Sequence[str] | None = None
) -> Iterator[Record]:
    """Yield the time of one call of every function, in C; the batch of all states beside it.

    The processor may begin with a call before the last one is done; tau is timed without that too.
    """
    for arm in arms:
        blocks: dict[Key, Block] = {}
        for task in TASKS.values():
            if (functions and task.name not in functions) or not modules["moro"].offers(task.name):
                continue
            if task.name.startswith("forward_dynamics") and condition(arm) > CONDITION:
                continue
            for name, run in agreeing(arm, task, modules).items():
                blocks[(task.name, False), name] = run.block()
                if task.name == "tau" and name != BATCH:
                    blocks[(task.name, True), name] = run.block(1, dependent=True)
        for (function, dependent), samples in _by_what(interleaved(blocks, STATES)):
            what = {"arm": arm.label, "dof": arm.dof, "function": function}
            yield from _records({**what, "dependent": dependent}, samples)


def batches(
    arms: Iterable[Arm], modules: Modules, sizes: Sequence[int] = BATCH_SIZES
) -> Iterator[Record]:
    """Yield the time for each sample of tau by the size of the batch, in C."""
    for arm in arms:
        runs = agreeing(arm, TASKS["tau"], modules)
        blocks = {(size, name): run.block(size) for size in sizes for name, run in runs.items()}
        for size, samples in _by_what(interleaved(blocks, STATES)):
            yield from _records({"arm": arm.label, "dof": arm.dof, "batch": size}, samples, BATCH)


def agreeing(arm: Arm, task: Task, modules: Modules) -> dict[str, Run]:
    """Return the contenders of a function in C. Raise DisagreementError if they do not agree."""
    runs = {
        loop.contender: Run(loop, arm)
        for module in modules.values()
        for loop in module.loops(arm, task)
    }
    check({name: run.computed() for name, run in runs.items()}, f"{task.name} of {arm.label}")
    return runs


def check(results: Mapping[str, Array], what: str) -> None:
    """Raise DisagreementError if results (one row for each state) differ from the first's."""
    (first, expected), *others = results.items()
    scale = np.abs(expected).max(axis=1, initial=0.0, keepdims=True)
    if not np.isfinite(expected).all():
        raise DisagreementError(f"{what}: {first} gives NaN or infinity")
    for name, found in others:
        error = np.max(np.abs(found - expected) / np.where(scale > 0, scale, 1.0))
        if not error <= AGREEMENT:
            raise DisagreementError(
                f"{what}: {name} and {first} differ by {error:.1e} of the largest result, "
                f"{AGREEMENT:.0e} is allowed; times are worth nothing before they agree"
            )


def condition(arm: Arm) -> float:
    """Return the largest condition number of the inertia matrix at some of the arm's states."""
    model = arm.robot.model().map(float)
    q = arm.states["q"][:PYTHON_STATES].T
    pairs = [(np.sin(angle), np.cos(angle)) for angle in displacements(model, q)]
    still = np.zeros_like(q)

    def torques(qdd: Array) -> Array:
        return np.array(joint_torques(posture(model, q, pairs), still, qdd))

    unit = np.eye(arm.dof)[:, :, None] * np.ones(q.shape[1])
    gravity = torques(still)
    M = np.array([torques(column) - gravity for column in unit])
    return float(np.linalg.cond(np.moveaxis(M, 2, 0)).max())


# -- one call from Python --------------------------------------------------------------------------


def python(arms: Iterable[Arm], modules: Modules) -> Iterator[Record]:
    """Yield the time of one call of tau from Python."""
    blocks: dict[Key, Block] = {}
    dofs = {arm.label: arm.dof for arm in arms}
    for arm in arms:
        states = [
            tuple(np.ascontiguousarray(arm.states[name][k]) for name in ("q", "qd", "qdd"))
            for k in range(PYTHON_STATES)
        ]
        results = {}
        for call in (call for module in modules.values() for call in module.python_calls(arm)):
            given = [call.prepare(*state) for state in states]
            results[call.contender] = np.array([_flat(call.function(*x)) for x in given])
            blocks[arm.label, call.contender] = python_block(_cycle(call.function, given))
        check(results, f"tau of {arm.label} from Python")
    for label, samples in _by_what(interleaved(blocks, PYTHON_STATES)):
        yield from _records({"arm": label, "dof": dofs[label]}, samples, next(iter(samples)))


def _flat(result: Any) -> Array:
    """Return a copy of what a contender returned, as a vector."""
    return np.array(result, dtype=float).ravel()


def _cycle(function: Callable[..., Any], states: list[Sequence[Any]]) -> Callable[[], None]:
    def cycle() -> None:
        for state in states:
            function(*state)

    return cycle


# -- growth with the number of joints --------------------------------------------------------------


def growth(modules: Modules, lengths: Sequence[int] = LENGTHS) -> Iterator[Record]:
    """Yield the time of tau, and of making it, by the number of joints."""
    blocks = {
        (n, name): run.block()
        for n in lengths
        for name, run in agreeing(chain(n), TASKS["tau"], modules).items()
    }
    for n, samples in _by_what(interleaved(blocks, STATES)):
        yield from _records({"arm": f"chain{n}", "dof": n}, samples)


def making(
    modules: Modules, lengths: Sequence[int] = LENGTHS, repeats: int = 3
) -> Iterator[Record]:
    """Yield the seconds that generating and compiling tau take, by the number of joints."""
    makers = [module for module in modules.values() if hasattr(module, "making")]
    arms = [chain(n) for n in lengths]
    with collector_off():
        tries = [[[m.making(arm) for m in makers] for arm in arms] for _ in range(repeats)]
    for of_arm, arm in zip(zip(*tries, strict=True), arms, strict=True):
        for times, maker in zip(zip(*of_arm, strict=True), makers, strict=True):
            generate, compile_ = (min(seconds) for seconds in zip(*times, strict=True))
            yield {
                "dof": arm.dof,
                "contender": maker.MADE,
                "generate": round(generate, 4),
                "compile": round(compile_, 4),
            }


# -- operations ------------------------------------------------------------------------------------


def operations(arms: Iterable[Arm], modules: Modules) -> Iterator[Record]:
    """Yield how many operations tau takes: additions and subtractions, multiplications, sines."""
    for arm in arms:
        ops = modules["moro"].kernel(arm, "tau").ops["tau"]
        record = {
            "arm": arm.label,
            "dof": arm.dof,
            "add": ops["add"] + ops["sub"],
            "mul": ops["mul"],
            "sincos": ops["sincos"],
        }
        if "casadi" in modules:
            peer = modules["casadi"]
            record["casadi"] = {name: peer.operations(arm, name) for name in peer.CONTENDERS}
        yield record


def passes() -> Iterator[Record]:
    """Yield the operations of tau as each pass of the generator joins in, and without each."""
    for row, counts in operations_table().items():
        for arm, (count, sines) in counts.items():
            yield {"passes": row, "arm": arm, "operations": count, "sincos": sines}


# -- records ---------------------------------------------------------------------------------------


def _by_what(samples: Mapping[Key, Sample]) -> Iterable[tuple[Any, dict[str, Sample]]]:
    """Return for each thing measured the samples of its contenders."""
    grouped: dict[Any, dict[str, Sample]] = {}
    for (what, name), sample in samples.items():
        grouped.setdefault(what, {})[name] = sample
    return grouped.items()


def _records(
    what: Record, samples: Mapping[str, Sample], reference: str = CALL
) -> Iterator[Record]:
    """Yield a record for each contender."""
    for name, sample in samples.items():
        yield {
            **what,
            "contender": name,
            "best": round(1e9 * sample.best, 3),
            "median": round(1e9 * sample.median, 3),
            "ratio": round(samples[reference].ratio(sample), 4),
            "paired_ratio": round(samples[reference].paired_ratio(sample), 4),
        }
