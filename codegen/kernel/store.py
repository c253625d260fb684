"""Where kernels are kept: a folder for each, with a manifest that says what is in it.

One process at a time changes a folder, and moves a kernel there when it is whole. A manifest is
data from outside: it carries a checksum of itself and of every file, and the hash of all that
shapes the kernel, which is compiled into the library, too.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

from filelock import FileLock, Timeout
from platformdirs import user_cache_path

from moro_codegen import waiting

MANIFEST = "manifest.json"
#: of the manifest and of what the runtime expects in a library
FORMAT = 3

#: fields that shape a kernel, or say what its functions are: the key is their hash
SHAPING = (
    "format", "name", "dof", "joint_kinds", "convention", "gravity", "scalar", "backend", "texts",
    "compiler", "parameters", "functions",
)  # fmt: skip
_TYPES: dict[str, type | tuple[type, ...]] = {
    "name": str, "dof": int, "backend": str, "scalar": str, "key": str, "input": dict,
    "files": dict, "parameters": list, "functions": list, "compiler": (dict, type(None)),
}  # fmt: skip

#: ends the names of folders in which kernels are built
_NEW = ".moro-new"

#: seconds between attempts to open a kernel that is being replaced
_PAUSES = (0.001, 0.002, 0.004, 0.008, 0.015, 0.03, 0.06, 0.12, 0.25)

_T = TypeVar("_T")


class DamagedError(ValueError):
    """A folder that does not hold one whole kernel; says what is wrong with it."""

    def __init__(self, folder: Path, what: str) -> None:
        super().__init__(
            f"{folder} does not hold a whole kernel: {what}. Build it again "
            "(mc.compile, mc.build or moro-codegen do so by themselves)"
        )


def cache() -> Path:
    """Return the folder in which the user's kernels are kept. Raise OSError if there is none."""
    folder = user_cache_path("moro") / "kernels"
    if not folder.is_absolute():  # no HOME, and no such user either
        raise OSError(_cannot_keep(folder, "the user has no home folder"))
    return folder


# -- manifests -----------------------------------------------------------------------------------


def key_of(manifest: Mapping[str, Any]) -> str:
    """Return the hash of everything that shapes a kernel."""
    return _sha256(json.dumps([manifest.get(field) for field in SHAPING], sort_keys=True))


def hash_of(texts: Mapping[str, str]) -> str:
    """Return the hash of the texts of a kernel, by path."""
    return _sha256(json.dumps(dict(texts), sort_keys=True))


def read_manifest(folder: Path) -> dict[str, Any]:
    """Return the manifest in a folder.

    Raise FileNotFoundError if there is none, DamagedError if it is not as it was written, and
    ValueError if that was another version of moro.
    """
    path = folder / MANIFEST
    try:
        text = path.read_bytes().decode()
        manifest = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DamagedError(folder, f"{MANIFEST} is no JSON ({error})") from None
    if not isinstance(manifest, dict):
        raise DamagedError(folder, f"{MANIFEST} holds no object")
    if manifest.get("format") != FORMAT:
        raise ValueError(f"{path} is of another version of moro: build the kernel again")
    wrong = [name for name, type_ in _TYPES.items() if not isinstance(manifest.get(name), type_)]
    if wrong:
        raise DamagedError(folder, f"{MANIFEST} lacks {', '.join(wrong)}")
    if text != _text(manifest) or manifest["key"] != key_of(manifest):
        raise DamagedError(folder, f"{MANIFEST} is not as it was written")
    return manifest


def write_manifest(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Write a manifest, with its checksum, beside its place; then rename it."""
    path = folder / MANIFEST
    beside = path.with_suffix(".new")
    beside.write_bytes(_text(manifest).encode())
    beside.replace(path)


def has_input(folder: Path, manifest: Mapping[str, Any]) -> bool:
    """Tell whether the kernel there was made from the same input."""
    return bool(read_manifest(folder)["input"] == manifest["input"])


def record_input(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Put down that the kernel there can be made from another input, too."""
    write_manifest(folder, {**read_manifest(folder), "input": manifest["input"]})


def _text(manifest: Mapping[str, Any]) -> str:
    content = {name: value for name, value in manifest.items() if name != "checksum"}
    checksum = _sha256(json.dumps(content, indent=2))
    return json.dumps({**content, "checksum": checksum}, indent=2) + "\n"


# -- files ---------------------------------------------------------------------------------------


def is_current(folder: Path, manifest: Mapping[str, Any]) -> bool:
    """Tell whether the folder holds, whole, the kernel that the manifest describes."""
    try:
        there = read_manifest(folder)
        return bool(there["key"] == manifest["key"]) and all(
            digest(folder / name) == known for name, known in there["files"].items()
        )
    except (OSError, ValueError):
        return False


def checked_file(folder: Path, manifest: Mapping[str, Any], name: str) -> bytes:
    """Return the bytes of one of a kernel's files. Raise DamagedError if they are others."""
    try:
        content = (folder / name).read_bytes()
    except FileNotFoundError:
        raise DamagedError(folder, f"{name} is missing") from None
    if manifest["files"].get(name) != hashlib.sha256(content).hexdigest():
        raise DamagedError(folder, f"{name} is not the file that {MANIFEST} describes")
    return content


def digest(path: Path) -> str:
    """Return the checksum of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def settled(opened: Callable[[], _T]) -> _T:
    """Return what is opened in a folder, tried again while a rebuild may be moving files there."""
    for pause in _PAUSES:
        try:
            return opened()
        except DamagedError:  # noqa: PERF203
            time.sleep(pause)
    return opened()


def move(new: Path, folder: Path) -> None:
    """Put a new kernel where it belongs: its manifest last, then what was there before goes."""
    if not folder.exists():
        new.rename(folder)
        return
    old = _files_of(folder)
    names = sorted(paths(new), key=lambda name: name == MANIFEST)
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (new / name).replace(folder / name)
    for name in old - set(names):
        (folder / name).unlink(missing_ok=True)
        for parent in Path(name).parents[:-1]:
            with suppress(OSError):  # not empty, or gone
                (folder / parent).rmdir()


def paths(folder: Path) -> list[str]:
    """Return the paths of all files in a folder, relative to it."""
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


def _files_of(folder: Path) -> set[str]:
    """Return the paths of the files of the kernel in a folder, if there is one."""
    try:
        paths = set(read_manifest(folder)["files"])
    except (OSError, ValueError):
        return set()
    return {path for path in paths if ".." not in Path(path).parts and not Path(path).is_absolute()}


# -- one at a time -------------------------------------------------------------------------------


@contextmanager
def lock(folder: Path) -> Iterator[None]:
    """Let one process at a time build in a kernel's folder.

    Says so if it has to wait, for at most MORO_TIMEOUT seconds: then TimeoutError. The lock's file
    stays: another process may be waiting for it, and a third would make a new one. Raises OSError
    where nothing can be written.
    """
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        held = FileLock(_lock_file(folder))
        _acquire(held, folder)
    except TimeoutError:
        raise
    except OSError as error:
        raise type(error)(_cannot_keep(folder, error.strerror or str(error))) from None
    try:
        yield
    finally:
        held.release()


def _acquire(held: FileLock, folder: Path) -> None:
    limit = waiting.limit()
    silent = waiting.until_said(limit)
    try:
        held.acquire(timeout=silent)
    except Timeout:
        if limit is None or limit > silent:
            waiting.say(f"waiting for another process, which is building {folder}")
        try:
            held.acquire(timeout=-1 if limit is None else limit - silent)
        except Timeout:
            raise TimeoutError(
                f"another process has been building {folder} for {limit:g} s "
                f"({waiting.VARIABLE}); {held.lock_file} is its lock"
            ) from None


@contextmanager
def workshop(folder: Path) -> Iterator[Path]:
    """Make a folder beside a kernel's, in which to build it; whoever does so holds the lock.

    Those that builders left when they were killed are removed.
    """
    beside = _workshop(folder)
    for left in folder.parent.glob(f".*{_NEW}"):
        if left != beside:
            _remove_if_left(left)
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir()
    try:
        yield beside
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _remove_if_left(left: Path) -> None:
    """Remove a workshop whose lock nobody holds."""
    folder = left.with_name(left.name[1 : -len(_NEW)])
    if _lock_file(folder).is_file():
        with suppress(OSError), FileLock(_lock_file(folder), timeout=0):
            shutil.rmtree(left, ignore_errors=True)


def clear(folder: Path) -> tuple[int, int]:
    """Remove the kernels in a folder but those being built; return how many, and their bytes."""
    count = freed = 0
    for path in sorted(folder.glob("*-*")) if folder.is_dir() else ():
        if not re.fullmatch(r"\w+-[0-9a-f]{16}", path.name) or not path.is_dir():
            continue
        with suppress(Timeout), FileLock(_lock_file(path), timeout=0):
            freed += sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
            shutil.rmtree(path)
            count += 1
    for left in folder.glob(f".*{_NEW}"):
        _remove_if_left(left)
    return count, freed


def _lock_file(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.lock")


def _workshop(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}{_NEW}")


def _cannot_keep(folder: Path, why: str) -> str:
    return (
        f"a kernel cannot be kept in {folder}: {why}. "
        "Name another folder with directory= (or --output)"
    )


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
