"""What is in a file that a person names: its bytes, or why there are none."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from moro.checks import meant
from moro.formats.errors import Problem, RobotFileError


def contents(path: Path, shown: str, most: int, at_most: str, kinds: Collection[str]) -> bytes:
    """Return what is in the file, ``shown`` in messages, of not more than ``most`` bytes.

    ``at_most`` says why more cannot be right, ``kinds`` are the suffixes of files that may have
    been meant. Raises RobotFileError.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(most + 1)
    except FileNotFoundError:
        raise _refusal(shown, f"no such file{_neighbour(path, kinds)}") from None
    except IsADirectoryError:
        raise _refusal(shown, "is a folder; expected a robot file") from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the path
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise _refusal(shown, f"cannot be read: {reason}") from None
    if len(data) > most:
        raise _refusal(shown, f"is larger than {most // 1_000_000} MB; {at_most}")
    return data


def _refusal(shown: str, message: str) -> RobotFileError:
    return RobotFileError(shown, [Problem(None, "", message)])


def _neighbour(path: Path, kinds: Collection[str]) -> str:
    """Name a robot file in the same folder with a similar name."""
    try:
        found = {x.stem: x for x in path.parent.iterdir() if x.suffix in kinds}
    except OSError:
        return ""
    name = path.stem if path.stem in found else meant.nearest(path.stem, found)
    return f"; did you mean `{found[name]}`?" if name else ""
