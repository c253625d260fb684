"""The robot that the command was given, and what the manifest says of its file."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

import moro
from moro.formats.loading import description, locate


def read(source: str, part: Mapping[str, Any]) -> tuple[moro.Robot, dict[str, Any]]:
    """Return the robot, and what the manifest says of its file; warnings go to standard error.

    ``part`` are the arguments of ``moro.load`` beside the file.
    """
    asked = {name: value for name, value in part.items() if value}
    robot = _loaded(source, asked)
    if robot.masses is None:
        raise ValueError(f"{source} gives no masses, so there is no tau: add mass, com and inertia")
    path = locate(source)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    said = {what: text for what, state, text in robot.model_summary() if state == "read"}
    given = {name: _plain(value) for name, value in asked.items()}
    return robot, {"file": path.name, "sha256": digest, **given, **({"read": said} if said else {})}


def save(source: str, part: Mapping[str, Any], path: Path) -> None:
    """Write the robot to a robot.yaml; the other arguments are those of ``read``."""
    _loaded(source, {name: value for name, value in part.items() if value}).save(path)


def _loaded(source: str, asked: Mapping[str, Any]) -> moro.Robot:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        arm = description(source, **asked)  # refuses without SymPy, which Robot asks for
        robot = moro.Robot.of(arm)
    for warning in caught:
        click.echo(f"moro-codegen: warning: {warning.message}", err=True)
    return robot


def _plain(value: Any) -> Any:
    """Return an argument as JSON has it: numbers as they are written."""
    if isinstance(value, Mapping):
        return {name: str(x) for name, x in value.items()}
    return list(value) if isinstance(value, tuple) else value
