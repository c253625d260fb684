"""From the path of a URDF to links that can be put together."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from moro.checks.callers import outside
from moro.formats import names
from moro.formats.errors import Problem, RobotFileError, RobotFileWarning, nearest
from moro.formats.files import contents
from moro.formats.xml import MAX_SIZE, DocumentError, Element, parse

if TYPE_CHECKING:
    from moro.formats.assembly import Assembly

#: suffixes of files that are read here
KINDS = (".urdf", ".xml", ".xacro")
#: remarks that are made one by one; more are counted
_REMARKED = 10
_MACRO = re.compile(r"\$\{|\$\(")


def read(path: str | os.PathLike[str], *, as_written: bool = False) -> Assembly:
    """Return the robot that the file at ``path`` describes; its name is made an identifier.

    Raises RobotFileError with all that is wrong. What is legal but probably not meant gives a
    RobotFileWarning.
    """
    shown = os.fspath(path)
    at_most = "a robot takes some hundred kB: shapes belong in files of their own"
    data = contents(Path(path), shown, MAX_SIZE, at_most, KINDS)
    try:
        robot = parse(data)
    except DocumentError as error:
        raise RobotFileError(shown, [error.problem]) from None
    if found := [*_foreign(robot, Path(path))]:
        raise RobotFileError(shown, found)
    # what the values say needs SymPy: a text that is no URDF is refused without
    from moro.formats.urdf import structure
    from moro.formats.urdf.build import build
    from moro.formats.urdf.elements import joints_of, links_of
    from moro.formats.urdf.reading import Reading

    reading = Reading(as_written)
    links, joints = links_of(robot, reading), joints_of(robot, reading)
    if len(links) + len(joints) == sum(x.tag in ("link", "joint") for x in robot.children):
        reading.problems += structure.problems(robot, links, joints)
    if reading.problems:
        raise RobotFileError(shown, reading.problems)
    for remark in _few(reading.remarks):
        warnings.warn(remark.at(shown), RobotFileWarning, stacklevel=outside())
    name = robot.attributes.get("name", "").strip() or Path(path).stem
    built = build(names.identifier(name), links, joints)
    return replace(built, notes=(*built.notes, *_notes(reading.meant)))


def _notes(meant: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    if meant:
        read = ", ".join(f"{text} as {exact}" for text, exact in meant.items())
        yield "decimals", f"{read}; as_written=True takes them as they are"


def _foreign(robot: Element, path: Path) -> list[Problem]:
    """Find what is XML and no URDF: macros of xacro, other roots."""
    if robot.tag != "robot":
        message = f"expected the root <robot> of a URDF, found <{robot.tag[:40]}>"
        return [Problem(robot.line, "", message + nearest(robot.tag, ["robot"]))]
    for element in robot.walk():
        macro = element.tag.startswith("xacro:") or any(
            _MACRO.search(text) for text in element.attributes.values()
        )
        if macro:
            message = (
                f"is xacro, of which ROS makes a URDF: `xacro {path.name} >"
                f" {path.name.split('.')[0]}.urdf`"
            )
            return [Problem(element.line, f"<{element.tag}>", message)]
    return []


def _few(remarks: list[Problem]) -> list[Problem]:
    """Return the first remarks, and how many there are beside."""
    if len(remarks) <= _REMARKED:
        return remarks
    rest = Problem(None, "", f"and {len(remarks) - _REMARKED} more remarks of these kinds")
    return [*remarks[:_REMARKED], rest]
