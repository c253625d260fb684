"""What a robot file gets when something is wrong with it: all problems, with line and field."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from moro.checks.meant import meant

#: how many problems ``str(error)`` lists; ``error.problems`` has all of them
_LISTED = 20


class Problem(NamedTuple):
    """One thing wrong with a robot file."""

    #: line in the file, from 1; None where no line is to blame (a missing file)
    line: int | None
    #: such as ``links[2].mass``, where links and components count from 1; empty for the whole file
    field: str
    #: what was found and what was expected
    message: str

    def at(self, path: str) -> str:
        """Return ``file:line: field: message``."""
        place = path if self.line is None else f"{path}:{self.line}"
        return ": ".join(part for part in (place, self.field, self.message) if part)


class RobotFileError(ValueError):
    """A robot file that cannot be read. ``problems`` lists all that is wrong, in file order."""

    def __init__(self, path: str, problems: Iterable[Problem]) -> None:
        self.path = path
        self.problems = sorted(dict.fromkeys(problems), key=lambda problem: problem.line or 0)
        super().__init__(path, self.problems)

    def __str__(self) -> str:
        lines = [problem.at(self.path) for problem in self.problems[:_LISTED]]
        if more := len(self.problems) - len(lines):
            lines.append(f"{self.path}: and {more} more")
        return "\n".join(lines)


class RobotFileWarning(UserWarning):
    """A robot file says something legal that was probably not meant."""


def nearest(word: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean `x`?"`` for the known word that is meant, else nothing."""
    name = meant(word, known)
    return f"; did you mean `{name}`?" if name else ""
