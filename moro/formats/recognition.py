"""Robot files of other programs, told apart by how they begin."""

from __future__ import annotations

import re

#: by the name of the root element
_ROOTS = {
    "robot": "URDF, the format of ROS",
    "mujoco": "MJCF, the format of MuJoCo",
    "mujocoinclude": "MJCF, the format of MuJoCo",
    "sdf": "SDF, the format of Gazebo",
    "gazebo": "SDF, the format of Gazebo",
}
_ROOT = re.compile(r"<([A-Za-z][\w.-]*)([^>]*)")

EXPECTED = "expected a robot.yaml, which gives an arm as rows of DH parameters"


def foreign(text: str, suffix: str) -> str | None:
    """Say what a text is that is no YAML of ours: XML of some kind, or JSON; else None."""
    start = text.lstrip()
    if re.match(r"<[?!A-Za-z]", start):
        root = _ROOT.search(start)
        if root is None:
            return "XML"
        if suffix == ".xacro" or "xmlns:xacro" in root[2]:
            return "xacro, from which ROS makes URDF"
        return _ROOTS.get(root[1].lower(), f"XML (`<{root[1][:40]}>`)")
    if suffix == ".json" and start[:1] in ("{", "[") and '"links"' not in start:
        return "JSON"
    return None
