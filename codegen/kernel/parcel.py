"""Kernels on their way to other processes, and to other machines, which build them of their texts.

What is pickled is the folder, and the texts in it. Where the folder is at hand and the processor
can run what it holds, that is opened. Elsewhere the user's cache gets a kernel of the same texts,
which is built once for all processes of the machine.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Mapping
from datetime import datetime, timezone
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from moro_codegen import backends
from moro_codegen.backends.toolchain import ToolchainError
from moro_codegen.kernel import store
from moro_codegen.kernel.building import Work, is_there

_Opened = TypeVar("_Opened")


class Parcel:
    """A kernel, as it is sent: its folder, its key, and its texts."""

    def __init__(self, directory: Path, key: str, manifest: Mapping[str, Any]) -> None:
        self.directory, self.key, self._manifest = directory, key, manifest

    @cached_property
    def content(self) -> bytes:
        """Manifest and texts, compressed.

        Raise DamagedError if the folder does not hold them any more.
        """
        texts = _texts(self.directory, self._manifest)
        local = ("files", "checksum", "key")
        described = {name: x for name, x in self._manifest.items() if name not in local}
        return zlib.compress(json.dumps([described, texts]).encode())

    def __reduce__(self) -> tuple[Any, ...]:
        return _received, (self.directory, self.key, self.content)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Parcel) and self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @property
    def _identity(self) -> tuple[Path, str]:
        return self.directory, self.key

    def opened(self, by: Callable[[Path], _Opened]) -> _Opened:
        """Return what ``by`` opens: the kernel where it was, or one built here of the same texts.

        Raise ToolchainError where that cannot be done.
        """
        try:
            if store.read_manifest(self.directory)["key"] == self.key:
                return by(self.directory)
        except (OSError, ValueError, ToolchainError):
            pass  # it is not here, or not whole, or for another processor
        described, texts = json.loads(zlib.decompress(self.content))
        if described["format"] != store.FORMAT:
            raise ValueError(f"{described['name']} was sent by another version of moro")
        try:
            work = _work(described, texts)
            folder = store.cache() / work.own_folder
            is_there(folder, work, by)
        except ToolchainError as error:
            raise ToolchainError(
                f"{described['name']} is not in {self.directory} on this machine, "
                f"and cannot be built here: {error}"
            ) from None
        return by(folder)


def _received(directory: Path, key: str, content: bytes) -> Parcel:
    parcel = Parcel(directory, key, {})
    parcel.content = content
    return parcel


def _texts(directory: Path, manifest: Mapping[str, Any]) -> dict[str, str]:
    """Return the texts of a kernel's files by path, as they were emitted."""
    name, backend = manifest["name"], backends.get(manifest["backend"])
    paths = set(manifest["files"])
    if manifest["compiler"] is not None:
        paths.discard(backend.loaded(directory, name).relative_to(directory).as_posix())
    signed = {
        path: store.checked_file(directory, manifest, path).decode() for path in sorted(paths)
    }
    texts = backend.unsigned(signed, name, manifest["key"])
    if store.hash_of(texts) != manifest["texts"]:
        raise store.DamagedError(directory, "its texts are not those that it was built of")
    return texts


def _work(described: Mapping[str, Any], texts: Mapping[str, str]) -> Work:
    """Return what there is to do here for a kernel from elsewhere."""
    backend = backends.get(described["backend"])
    operations = sum(sum(function["ops"].values()) for function in described["functions"])
    arch = "native"
    if described["compiler"] is not None:
        march = (x for x in described["compiler"]["flags"] if x.startswith("-march="))
        arch = next(march, "-march=native").removeprefix("-march=")
    compiler = backend.compiler(operations, arch)
    built = datetime.now(timezone.utc).isoformat(timespec="seconds")
    return Work.of(backend, texts, compiler, {**described, "created": built})
