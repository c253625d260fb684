"""From a path to a validated description of an arm."""

from __future__ import annotations

import codecs
import os
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moro.checks.callers import outside
from moro.formats import names
from moro.formats import recognition as formats
from moro.formats.errors import Problem, RobotFileError, RobotFileWarning
from moro.formats.files import contents
from moro.formats.yaml.document import (
    MAX_ITEMS,
    MAX_SIZE,
    DocumentError,
    Scalar,
    Table,
    compose,
    place,
    tree_of,
)

if TYPE_CHECKING:
    from moro.formats.yaml.schema import RobotFile

#: suffixes of files of ours
_KINDS = (".yaml", ".yml")


def read(path: str | os.PathLike[str], *, warn: bool = True) -> RobotFile:
    """Return the arm that the file at ``path`` describes; its name defaults to that of the file.

    Raises RobotFileError with all that is wrong. With ``warn``, what is legal but probably not
    meant gives a RobotFileWarning each.
    """
    shown = os.fspath(path)
    text = _text(Path(path), shown)
    if kind := formats.foreign(text, Path(path).suffix.lower()):
        raise RobotFileError(shown, [Problem(None, "", f"is {kind}; {formats.EXPECTED}")])
    try:
        tree, doubled = compose(text)
    except DocumentError as error:
        raise RobotFileError(shown, [error.problem]) from None
    if not isinstance(tree, Table):
        message = "expected `links:` with one entry for each joint"
        raise RobotFileError(shown, [Problem(tree.line, "", message)])
    if "name" not in tree:
        tree["name"] = Scalar(names.identifier(Path(path).stem), "str", tree.line)
        tree.lines["name"] = tree.line
    file = validated(tree, shown, doubled)
    if warn:
        _warn(file, tree, shown)
    return file


def given(fields: Mapping[str, Any]) -> RobotFile:
    """Return the robot that a dictionary of Python's describes, with the fields of a file.

    Raises RobotFileError and warns, as ``read`` does, naming fields.
    """
    tree = tree_of({"name": "robot"} | dict(fields))
    assert isinstance(tree, Table)  # noqa: S101 - made of a mapping
    file = validated(tree, "")
    _warn(file, tree, "")
    return file


def _warn(file: RobotFile, tree: Table, shown: str) -> None:
    """Warn of what is legal but probably not meant."""
    from moro.formats.yaml.remarks import remarks

    for location, remark in remarks(file):
        message = Problem(*place(tree, location), remark).at(shown)
        warnings.warn(message, RobotFileWarning, stacklevel=outside())


def validated(tree: Table, shown: str, doubled: Iterable[Problem] = ()) -> RobotFile:
    """Return what a document says. Raises RobotFileError with all that is wrong.

    ``doubled`` are the keys that it gives twice.
    """
    # what the values say needs SymPy: a path or a text that is none is refused without
    from pydantic import ValidationError

    from moro.formats.yaml.coordinates import moved
    from moro.formats.yaml.fields import between
    from moro.formats.yaml.problems import problems
    from moro.formats.yaml.references import references
    from moro.formats.yaml.schema import RobotFile
    from moro.formats.yaml.values import Context

    found = [*doubled]
    try:
        file = RobotFile.model_validate(tree, context=Context.of(tree))
    except ValidationError as error:
        raise RobotFileError(shown, [*found, *problems(error, between(tree), tree)]) from None
    found += problems(None, between(tree), tree)
    if not found:
        found += problems(None, [*moved(file)[1], *references(file).wrong], tree)
    if found:
        raise RobotFileError(shown, found)
    return file


def _text(path: Path, shown: str) -> str:
    """Return what is in the file."""
    at_most = f"an arm has at most {MAX_ITEMS} links, which take a few kB"
    data = contents(path, shown, MAX_SIZE, at_most, _KINDS)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        found = f"byte 0x{data[error.start]:02X}"
        if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            found = "it is UTF-16"
        raise RobotFileError(shown, [Problem(line, "", f"is not UTF-8 text ({found})")]) from None
