"""The code that called moro: what a warning is about stands there."""

import sys


def outside() -> int:
    """Return the stack level, for a warning of the caller's, of the code that called moro."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and frame.f_globals["__name__"].partition(".")[0] == "moro":
        level, frame = level + 1, frame.f_back
    return level
