"""Times contenders side by side: A B C, A B C, ..., so that all see the same machine.

Times are those that a thread spends on the processor: what others do on the machine counts less.
"""

from __future__ import annotations

import gc
import resource
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

#: seconds that one block of calls is to take, and how many blocks each contender gets
BLOCK, ROUNDS = 0.004, 25

#: runs the code once and again, this many times over, and returns the seconds that took
Block = Callable[[int], float]
Key = TypeVar("Key")


@dataclass(frozen=True)
class Sample:
    """Seconds of one evaluation, one figure per round."""

    rounds: tuple[float, ...]

    @property
    def best(self) -> float:
        """The fastest round: what the code takes when nothing else disturbs it."""
        return min(self.rounds)

    @property
    def median(self) -> float:
        """The middle round: what it took on this machine, on this day."""
        return statistics.median(self.rounds)

    def ratio(self, other: Sample) -> float:
        """Return how many times longer the other takes: the ratio of the fastest rounds."""
        return other.best / self.best

    def paired_ratio(self, other: Sample) -> float:
        """Return the same as the median over the rounds, each with its neighbour in time."""
        return statistics.median(b / a for a, b in zip(self.rounds, other.rounds, strict=True))


def interleaved(
    blocks: Mapping[Key, Block],
    evaluations: int,
    *,
    rounds: int = ROUNDS,
    block: float = BLOCK,
) -> dict[Key, Sample]:
    """Time each block of ``evaluations`` evaluations, by turns; return seconds per evaluation.

    The more blocks, the longer the time over which the rounds of each are spread, and the less it
    matters what else the machine does for a moment.
    """
    passes = {name: passes_for(run, block) for name, run in blocks.items()}
    seconds: dict[Key, list[float]] = {name: [] for name in blocks}
    order = list(blocks)
    with collector_off():
        for turn in range(rounds):
            first = turn % max(1, len(order))
            for name in order[first:] + order[:first]:
                seconds[name].append(blocks[name](passes[name]) / (passes[name] * evaluations))
    return {name: Sample(tuple(of)) for name, of in seconds.items()}


def passes_for(run: Block, seconds: float) -> int:
    """Return how many passes fill that time; runs the block, so that it is warm afterwards."""
    passes = 1
    while (taken := run(passes)) < seconds / 4:
        passes *= 4
    return max(1, round(passes * seconds / taken))


def python_block(call: Callable[[], object]) -> Block:
    """Return a block of calls of a Python function."""

    def run(passes: int) -> float:
        start = time.thread_time()
        for _ in range(passes):
            call()
        return time.thread_time() - start

    return run


def seconds_of(work: Callable[[], object]) -> tuple[float, float]:
    """Return the processor seconds that this process spends on work, and those its children do."""
    own, children = time.process_time(), _children()
    work()
    return time.process_time() - own, _children() - children


def _children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@contextmanager
def collector_off() -> Iterator[None]:
    """Keep Python's garbage collector out of a measurement."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
