"""What is going on, for a person who waits: one line on a terminal, or under a notebook's cell.

Whatever takes long tells what it is at; nothing is shown before a second has passed, and nothing
where nobody would see it: in pipes, files and scripts of scripts.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

#: seconds that may pass in silence
PATIENCE = 1.0


class ProgressLine:
    """What is being done, and since when."""

    def __init__(self) -> None:
        self.what, self.since = "", time.monotonic()

    def tell(self, what: str) -> None:
        """Take note of what begins."""
        self.what, self.since = what, time.monotonic()

    def __str__(self) -> str:
        return f"{self.what} ({time.monotonic() - self.since:.0f} s)"


_line: ContextVar[ProgressLine | None] = ContextVar("line", default=None)


def tell(what: str) -> bool:
    """Say what begins now: "generating tau". Return whether that is shown."""
    if (line := _line.get()) is not None:
        line.tell(what)
    return line is not None


@contextmanager
def shown() -> Iterator[None]:
    """Show what is told in here, where there is somebody to see it. Inside another, that shows."""
    watch = None if _line.get() else _watcher()
    if watch is None:
        yield
        return
    line, over = ProgressLine(), threading.Event()
    token = _line.set(line)
    watching = threading.Thread(target=watch, args=(line, over), daemon=True)
    watching.start()
    try:
        yield
    finally:
        over.set()
        watching.join()
        _line.reset(token)


def _watcher() -> Any:
    """Return what shows a line until an event, or None."""
    if "ipykernel" in sys.modules:
        return _in_notebook
    return _on_terminal if sys.stderr is not None and sys.stderr.isatty() else None


def _on_terminal(line: ProgressLine, over: threading.Event) -> None:
    if over.wait(PATIENCE):
        return
    from rich.console import Console
    from rich.live import Live
    from rich.spinner import Spinner
    from rich.text import Text

    spinner = Spinner("dots")

    def picture() -> Spinner:
        spinner.text = Text(str(line))
        return spinner

    with Live(get_renderable=picture, console=Console(stderr=True), transient=True):
        over.wait()


def _in_notebook(line: ProgressLine, over: threading.Event) -> None:
    if over.wait(PATIENCE):
        return
    from IPython.display import DisplayHandle

    handle = DisplayHandle()
    handle.display({"text/plain": str(line)}, raw=True)
    while not over.wait(0.25):
        handle.update({"text/plain": str(line)}, raw=True)
    handle.update({"text/plain": ""}, raw=True)
