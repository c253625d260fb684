"""From a path to a validated description of an arm."""

from __future__ import annotations

import codecs
import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

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
    # what the values say needs SymPy: a path or a text that is none is refused without
    from pydantic import ValidationError

    from moro.formats.yaml.remarks import remarks
    from moro.formats.yaml.schema import Context, RobotFile, problems

    if "name" not in tree:
        tree["name"] = Scalar(names.identifier(Path(path).stem), "str", tree.line)
        tree.lines["name"] = tree.line
    try:
        file = RobotFile.model_validate(tree, context=Context.of(tree))
    except ValidationError as error:
        raise RobotFileError(shown, [*doubled, *problems(error, tree)]) from None
    if doubled:
        raise RobotFileError(shown, doubled)
    if warn:
        for location, remark in remarks(file):
            message = Problem(*place(tree, location), remark).at(shown)
            warnings.warn(message, RobotFileWarning, stacklevel=outside())
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
