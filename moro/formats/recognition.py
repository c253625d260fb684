"""Formats of robot files, told apart by how they begin."""

from __future__ import annotations

import re
from pathlib import Path

#: by the name of the root element
_ROOTS = {
    "sdf": "SDF, the format of Gazebo",
    "gazebo": "SDF, the format of Gazebo",
}
#: of XML that is read
_KINDS = {"robot": "urdf", "mujoco": "mjcf", "mujocoinclude": "mjcf"}
_START = re.compile(r"<[?!A-Za-z]")
_COMMENT = re.compile(r"<!--.*?(-->|\Z)", re.DOTALL)
_ROOT = re.compile(r"<([A-Za-z][\w.-]*)")

EXPECTED = "expected a robot.yaml, a URDF or an MJCF"
#: bytes in which a file says what it is
_HEAD = 65536


def kind(path: Path) -> str:
    """Return "urdf", "mjcf", or "" for anything else: by the name of a file, or by its root.

    Xacro, of which URDFs are made, is "urdf".
    """
    if path.suffix.lower() in (".urdf", ".xacro"):
        return "urdf"
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except (OSError, ValueError):
        return ""  # which its reader will say
    return _KINDS.get(_root(head.decode("utf-8-sig", "replace")), "")


def foreign(text: str, suffix: str) -> str | None:
    """Say what a text is that is no YAML of ours: XML of some kind, or JSON; else None."""
    start = text.lstrip()
    if _START.match(start):
        root = _root(start)
        return _ROOTS.get(root, f"XML (`<{root[:40]}>`)") if root else "XML"
    if suffix == ".json" and start[:1] in ("{", "[") and '"links"' not in start:
        return "JSON"
    return None


def _root(text: str) -> str:
    """Return the name of an XML text's root element, in small letters; "" if it has none."""
    if not _START.match(text.lstrip()):
        return ""
    root = _ROOT.search(_COMMENT.sub("", text))
    return root[1].lower() if root else ""
