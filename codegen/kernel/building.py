"""Builds a kernel of its texts, in a folder that does not hold it yet."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moro_codegen.backends import Backend
from moro_codegen.backends.toolchain import FALLBACK, Compiler, ProcessorError, ToolchainError
from moro_codegen.kernel import store
from moro_codegen.progress import tell


@dataclass(frozen=True)
class Work:
    """What there is to do for a kernel."""

    backend: Backend
    #: by path
    texts: Mapping[str, str]
    compiler: Compiler | None
    #: what is known before there are files; its "key" is the hash of all that shapes the kernel
    manifest: dict[str, Any]

    @classmethod
    def of(
        cls,
        backend: Backend,
        texts: Mapping[str, str],
        compiler: Compiler | None,
        described: Mapping[str, Any],
    ) -> Work:
        """Return the work for a manifest that lacks the compiler and the key."""
        made_with = None if compiler is None else backend.made_with(compiler)
        manifest = {**described, "compiler": made_with}
        return cls(backend, texts, compiler, {**manifest, "key": store.key_of(manifest)})

    @property
    def own_folder(self) -> str:
        """The name of a folder for this kernel and no other."""
        return f"{self.manifest['name']}-{self.manifest['key'][:16]}"


def is_there(folder: Path, work: Work, opened: Callable[[Path], object]) -> bool:
    """See to it that the folder holds the kernel; tell whether it did so already.

    ``opened`` loads a new kernel from its folder, as its users will.
    """
    manifest = work.manifest
    if store.is_current(folder, manifest) and store.has_input(folder, manifest):
        return True
    try:
        with store.lock(folder):
            if not store.is_current(folder, manifest):
                tell(f"{'compiling' if work.compiler else 'writing'} {manifest['name']}")
                _install(folder, work, opened)
                return False
            if not store.has_input(folder, manifest):
                store.record_input(folder, manifest)
    except OSError:
        if not store.is_current(folder, manifest):
            raise
    return True


def _install(folder: Path, work: Work, opened: Callable[[Path], object]) -> None:
    """Build a kernel beside the folder, try it, and move it there."""
    name, key = work.manifest["name"], work.manifest["key"]
    with store.workshop(folder) as beside:
        new = beside / folder.name
        new.mkdir()
        for path, text in work.backend.signed(work.texts, name, key).items():
            (new / path).parent.mkdir(parents=True, exist_ok=True)
            (new / path).write_text(text, encoding="utf-8")
        if work.compiler is not None:
            work.backend.build(work.compiler, new, name)
        files = {path: store.digest(new / path) for path in store.paths(new)}
        store.write_manifest(new, {**work.manifest, "files": files})
        _try(new, opened)
        store.move(new, folder)


def _try(folder: Path, opened: Callable[[Path], object]) -> None:
    try:
        opened(folder)
    except ProcessorError:
        pass  # for another processor, as the user wished
    except OSError as error:
        raise ToolchainError(
            f"the compiler's library cannot be loaded: {error}\n{FALLBACK}"
        ) from None
