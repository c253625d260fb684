"""What may take for ever says so after a second, and ends after the time that MORO_TIMEOUT sets."""

from __future__ import annotations

import math
import os
import sys

from moro_codegen.progress import tell

#: seconds of silence
PATIENCE = 1.0

VARIABLE = "MORO_TIMEOUT"


def limit() -> float | None:
    """Return how many seconds a compiler, or a wait for another process, may take; None: any.

    Raise ValueError if MORO_TIMEOUT is no positive number.
    """
    given = os.environ.get(VARIABLE, "").strip()
    if not given:
        return None
    try:
        seconds = float(given)
    except ValueError:
        seconds = math.nan
    if not seconds > 0:
        raise ValueError(f"{VARIABLE} must be a positive number of seconds, not {given!r}")
    return seconds


def until_said(seconds: float | None) -> float:
    """Return how long to be silent under such a limit."""
    return PATIENCE if seconds is None else min(PATIENCE, seconds)


def say(what: str) -> None:
    """Tell the user what is being waited for: in the line of progress, else on standard error."""
    message = f"{what} ({VARIABLE}=SECONDS sets a limit)"
    if not tell(message):
        sys.stderr.write(f"moro: {message}\n")
        sys.stderr.flush()
