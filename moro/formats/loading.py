"""A robot file in, what it describes out. Nothing heavy is imported before it is called."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moro.formats.errors import Problem, RobotFileError, RobotFileWarning, nearest
from moro.formats.recognition import kind

if TYPE_CHECKING:
    from moro.formats.assembly import Assembly
    from moro.formats.source import Source
    from moro.formats.yaml.schema import RobotFile

__all__ = [
    "Problem",
    "RobotFileError",
    "RobotFileWarning",
    "description",
    "locate",
    "packaged",
    "read",
]

_ROBOTS = Path(__file__).parent.parent / "robots"


def description(
    source: str | os.PathLike[str],
    *,
    root: str | None = None,
    tip: str | Sequence[str] | None = None,
    fix: Mapping[str, Any] | None = None,
    as_written: bool = False,
) -> Source:
    """Return what a file describes: what ``moro.load`` makes a Robot of, with its arguments."""
    path, part = locate(source), {"root": root, "tip": tip, "fix": fix}
    if format := kind(path):
        return _of_links(path, format, as_written, **part)
    if as_written:
        raise ValueError(f"as_written is for a URDF or an MJCF: {source} is none")
    file = read(source)
    from moro.formats.yaml.build import build  # after what may refuse the file without SymPy

    with _named(path):
        return _part(build(file), **part) if any(part.values()) else build(file)


def _of_links(path: Path, format: str, as_written: bool, **part: Any) -> Source:
    """Return what is described by links, or the part of it that is meant."""
    if format == "urdf":
        from moro.formats.urdf.reader import read
    else:
        from moro.formats.mjcf.reader import read
    assembly = read(path, as_written=as_written)
    from moro.formats.assembled import Assembled  # after what may refuse the file without SymPy
    from moro.formats.assembly import notes

    with _named(path):
        meant = _meant(assembly, **part)
        if problems := meant.problems():
            raise RobotFileError(os.fspath(path), problems)
        return Assembled(replace(meant, notes=(*notes(meant), *meant.notes)), decimal=True)


def _part(described: Source, **part: Any) -> Source:
    """Return the part that is meant of what a robot.yaml describes."""
    from moro.formats.assembled import Assembled

    if not isinstance(described, Assembled):
        asked = " and ".join(name for name, value in part.items() if value)
        raise ValueError(
            f"{asked} of {described.name}: its links are rows of DH parameters alone, without names"
        )
    return Assembled(_meant(described.assembly, **part), described.decimal)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Name the file in what is wrong with the robot as a whole, or with the part that is meant."""
    try:
        yield
    except RobotFileError:
        raise
    except ValueError as error:
        raise RobotFileError(str(path), [Problem(None, "", str(error))]) from None


def _meant(
    assembly: Assembly,
    root: str | None,
    tip: str | Sequence[str] | None,
    fix: Mapping[str, Any] | None,
) -> Assembly:
    """Return the links between root and tip, with joints that stand still."""
    from moro.checks.values import angle

    values = {name: angle(x, f"fix of {name}") for name, x in (fix or {}).items()}
    return assembly.fixed(values).part(root, tip)


def given(fields: Mapping[str, Any]) -> Source:
    """Return the robot that a dictionary describes, with the fields of a robot.yaml."""
    from moro.checks.values import has_float
    from moro.formats.yaml import reader
    from moro.formats.yaml.build import build

    return build(reader.given(fields), has_float(fields))


def read(source: str | os.PathLike[str]) -> RobotFile:
    """Return what the file that ``moro.load`` takes says, validated, in exact SymPy values."""
    from moro.formats.yaml import reader

    is_packaged = isinstance(source, str) and source in packaged()
    return reader.read(locate(source), warn=not is_packaged)  # ours are known data, oddities too


def locate(source: str | os.PathLike[str]) -> Path:
    """Return the path of the file that ``moro.load`` would read."""
    if isinstance(source, str) and source in packaged():
        return _ROBOTS / f"{source}.yaml"
    if isinstance(source, str) and _is_name(source):
        arms = packaged()
        message = (
            f"neither a file nor a packaged arm{nearest(source, arms)}"
            f" (packaged are {', '.join(arms)})"
        )
        raise RobotFileError(source, [Problem(None, "", message)])
    try:
        return Path(source)
    except TypeError:
        raise TypeError(
            "load takes the path of a robot file or the name of a packaged arm, not"
            f" {type(source).__name__}"
        ) from None


def packaged() -> tuple[str, ...]:
    """Return the names of the arms that come with moro."""
    return tuple(sorted(path.stem for path in _ROBOTS.glob("*.yaml")))


def _is_name(source: str) -> bool:
    """Whether ``source`` looks like the name of an arm, and is not that of a file."""
    bare = re.fullmatch(r"[\w -]{0,100}", source) is not None
    return bare and not Path(source).is_file()
