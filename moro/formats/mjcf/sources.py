"""A file and those it includes, looked through before MuJoCo opens them."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path

from moro.formats.errors import Problem, RobotFileError
from moro.formats.files import contents
from moro.formats.xml import MAX_SIZE, DocumentError, Element, parse

#: suffixes of files that are read here
KINDS = (".xml", ".mjcf")
#: elements of a model, after what is to be repeated has been
_MOST = 100_000
#: values of a user, points along a generated shape
_MOST_OF_ONE = 10_000
#: elements that name files of XML: what MuJoCo reads in their place
_INCLUDE, _MODEL = "include", "model"
_AT_MOST = "a robot takes some hundred kB: shapes belong in files of their own"


def looked_through(path: Path) -> bool:
    """Return whether a file of a model includes others.

    Raises RobotFileError for what is no MJCF, and for what may not be read, in it or in files that
    it includes: document types, more than there is room for, what is no file.
    """
    top = _parsed(path)
    if top.tag != "mujoco":
        part = ", the root of files that models include" if top.tag == "mujocoinclude" else ""
        message = f"expected the root <mujoco> of an MJCF, found <{top.tag[:40]}>" + part
        raise RobotFileError(os.fspath(path), [Problem(top.line, "", message)])
    seen, waiting = {path.resolve()}, [(path, top)]
    while waiting:
        at, element = waiting.pop()
        if problems := [*_too_much(element)]:
            raise RobotFileError(os.fspath(at), problems)
        for other in _named(element, {path.parent, at.parent}):
            if other.resolve() not in seen:
                seen.add(other.resolve())
                waiting.append((other, _parsed(other)))
    return len(seen) > 1


def _parsed(path: Path) -> Element:
    shown = os.fspath(path)
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise RobotFileError(shown, [Problem(None, "", "is a device or a pipe; expected a file")])
    try:
        return parse(contents(path, shown, MAX_SIZE, _AT_MOST, KINDS))
    except DocumentError as error:
        raise RobotFileError(shown, [error.problem]) from None


def _named(top: Element, folders: set[Path]) -> Iterator[Path]:
    """Yield the files of XML that a file names; those that are not there are for MuJoCo to miss."""
    for element in top.walk():
        name = element.attributes.get("file", "")
        if element.tag == _INCLUDE or (element.tag == _MODEL and name.endswith(KINDS)):
            yield from (path for folder in folders if (path := folder / name).exists())


def _too_much(top: Element) -> Iterator[Problem]:
    """Find what would make more of a small file than there is room for."""
    if (size := _size(top)) > _MOST:
        message = f"repeats elements to {size:.3g}, more than {_MOST}"
        yield Problem(top.line, "", message)
    for element in top.walk():
        for key, text in element.attributes.items():
            counts = key.startswith("nuser_") or (key == "params" and element.tag == "mesh")
            if counts and any(x > _MOST_OF_ONE for x in _numbers(text)):
                yield Problem(element.line, f"<{element.tag} {key}>", f"{text[:40]} is too much")


def _size(element: Element) -> float:
    """Return how many elements one becomes, by its counts and those of what is in it."""
    counts = _numbers(element.attributes.get("count", "1"))
    return math.prod(counts) * (1 + sum(map(_size, element.children)))


def _numbers(text: str) -> list[float]:
    """Return the sizes of numbers; what is none is for MuJoCo to say."""
    try:
        return [abs(float(x)) for x in text.split()]
    except ValueError:
        return []
