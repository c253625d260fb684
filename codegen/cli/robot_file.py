"""The robot that the command was given, and what the manifest says of its file."""

from __future__ import annotations

import hashlib
import warnings

import click

import moro
from moro.formats.loading import description, locate


def read(source: str) -> tuple[moro.Robot, dict[str, str]]:
    """Return the robot, and the name and hash of its file; warnings go to standard error."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        arm = description(source)  # refuses without SymPy, which Robot asks for
        robot = moro.Robot.of(arm)
    for warning in caught:
        click.echo(f"moro-codegen: warning: {warning.message}", err=True)
    if robot.masses is None:
        raise ValueError(f"{source} gives no masses, so there is no tau: add mass, com and inertia")
    path = locate(source)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return robot, {"file": path.name, "sha256": digest}
