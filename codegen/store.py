"""Where kernels are kept: a folder for each, with a manifest that says what is in it.

One process at a time changes a folder; a kernel is moved there when it is whole.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from filelock import FileLock

MANIFEST = "manifest.json"
#: of the manifest and of what the runtime expects in a library
FORMAT = 2


def is_current(folder: Path, manifest: Mapping[str, Any]) -> bool:
    """Tell whether the folder holds, whole, the kernel that the manifest describes."""
    try:
        there = read_manifest(folder)
        return bool(there["key"] == manifest["key"]) and all(
            digest(folder / name) == known for name, known in there["files"].items()
        )
    except (OSError, ValueError, KeyError):
        return False


def move(new: Path, folder: Path) -> None:
    """Put a new kernel where it belongs; while it replaces another there is no manifest."""
    if not folder.exists():
        new.rename(folder)
        return
    old = _files_of(folder)
    (folder / MANIFEST).unlink(missing_ok=True)
    names = sorted(paths(new), key=lambda name: name == MANIFEST)
    for name in old - set(names):
        (folder / name).unlink(missing_ok=True)
        for parent in Path(name).parents[:-1]:
            with suppress(OSError):  # not empty, or gone
                (folder / parent).rmdir()
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (new / name).replace(folder / name)


def paths(folder: Path) -> list[str]:
    """Return the paths of all files in a folder, relative to it."""
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


def _files_of(folder: Path) -> set[str]:
    """Return the paths of the files of the kernel in a folder, if there is one."""
    try:
        paths = set(read_manifest(folder)["files"])
    except (OSError, ValueError, KeyError):
        return set()
    return {path for path in paths if ".." not in Path(path).parts and not Path(path).is_absolute()}


@contextmanager
def lock(folder: Path) -> Iterator[None]:
    """Let one process at a time look at a kernel's folder and build in it.

    The lock's file stays: another process may be waiting for it, and a third would make a new one.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(folder.parent / f".{folder.name}.lock"):
        yield


def digest(path: Path) -> str:
    """Return the checksum of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest in a folder. Raise ValueError for one of another version."""
    path = folder / MANIFEST
    manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if manifest.get("format") != FORMAT:
        raise ValueError(f"{path} is of another version of moro: build the kernel again")
    return manifest


def write_manifest(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Write a manifest beside its place, then rename it."""
    path = folder / MANIFEST
    beside = path.with_suffix(".new")
    beside.write_text(json.dumps(manifest, indent=2) + "\n", encoding="utf-8")
    beside.replace(path)
