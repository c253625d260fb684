"""Large batches over several cores: each thread computes samples of its own."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np

#: what is worth a thread, in operations: fewer take less time than waking it
WORTHWHILE = 1_000_000


def in_threads(
    run: Callable[[Sequence[Any], Sequence[Any]], None],
    inputs: Sequence[Any],
    results: Sequence[Any],
    samples: tuple[int, ...],
    threads: int,
) -> None:
    """Call ``run(inputs, results)`` for parts of the samples, each in a thread.

    ``samples`` are the first axes of all arrays; the longest of them is divided. ``run`` should
    let go of the interpreter's lock while it computes.
    """
    axis = int(np.argmax(samples)) if samples else 0
    threads = min(threads, samples[axis] if samples else 1)
    if threads <= 1:
        run(inputs, results)
        return
    ends = [samples[axis] * k // threads for k in range(threads + 1)]
    parts = [(*(slice(None),) * axis, slice(start, end)) for start, end in itertools.pairwise(ends)]

    def compute(part: tuple[slice, ...]) -> None:
        run([x[part] for x in inputs], [y[part] for y in results])

    others = [_pool(threads - 1).submit(compute, part) for part in parts[1:]]
    try:
        compute(parts[0])
    finally:
        for other in others:
            other.result()


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    """Return threads that wait for work."""
    return ThreadPoolExecutor(threads, thread_name_prefix="moro")


if hasattr(os, "register_at_fork"):  # a child process has none of its parent's threads
    os.register_at_fork(after_in_child=_pool.cache_clear)
