"""What is going on, shown on a terminal while it does, and how long it took."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def step(what: str, times: dict[str, float], key: str | None = None) -> Iterator[None]:
    """Show on a terminal what is going on, and keep the time it takes [s]."""
    from rich.console import Console

    start = time.perf_counter()
    with Console(stderr=True).status(what):
        yield
    times[key or what] = time.perf_counter() - start
