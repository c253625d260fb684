"""Reports of two arms beside the pages, as ``robot.report`` writes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import moro
from moro.abc import g, l1, l2, lc1, lc2, q1, q2


def setup(app: Any) -> dict[str, Any]:
    """Write reports/ when the pages are done."""
    app.connect("build-finished", _write)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _write(app: Any, error: Exception | None) -> None:
    if error is None and app.builder.format == "html":
        folder = Path(app.outdir) / "reports"
        folder.mkdir(exist_ok=True)
        for robot in (_planar(), moro.load("puma560")):
            robot.report("html", folder / f"{robot.name}.html")


def _planar() -> moro.Robot:
    """Return the arm of printing.md."""
    arm = moro.Robot((l1, 0, 0, q1), (l2, 0, 0, q2), name="planar")
    arm.masses = arm.inertia_tensors = None
    arm.cm_positions = [(lc1 - l1, 0, 0), (lc2 - l2, 0, 0)]
    arm.gravity = (0, -g, 0)
    return arm
