"""Any robot as a robot.yaml that is read as the same robot."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from moro.formats.assembled import Assembled
from moro.formats.source import Source
from moro.formats.taken_apart import taken_apart
from moro.formats.yaml.write import text

#: what a file gives of all links, or of none
_BODIES = ("masses", "cm_positions", "inertia_tensors")


def save(source: Source, path: str | os.PathLike[str]) -> None:
    """Write a robot to a file, in the place of one that is there.

    ValueError for what no file can hold, OSError where it cannot be written; the file at ``path``
    is as before then.
    """
    content = as_text(source)
    path = Path(path)
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beside.write_text(content, encoding="utf-8")
        beside.replace(path)
    finally:
        with suppress(OSError):
            beside.unlink()


def as_text(source: Source) -> str:
    """Return a robot as the text of a robot.yaml."""
    model = source.model()
    missing = [name for name in _BODIES if name in model.not_set]
    if 0 < len(missing) < len(_BODIES):
        raise ValueError(
            f"{source.name} cannot be saved: {' and '.join(missing)} not set; a robot.yaml gives"
            " masses, centres of mass and inertia of all links, or none of them"
        )
    links = source.assembly if isinstance(source, Assembled) else taken_apart(model)
    return text(links, model)
