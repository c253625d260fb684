"""C: a shared library, and the source and header that it is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from moro_codegen._runtime import Function, Library, gufunc
from moro_codegen.backends import Backend, Folder, Opened, c_text, machines, toolchain
from moro_codegen.backends.toolchain import Compiler, ProcessorError, ToolchainError
from moro_codegen.emit.describe import docstring
from moro_codegen.emit.render import render
from moro_codegen.program import Program


class C(Backend):
    """Compiled C99, called without a detour through Python where arrays need no conversion."""

    name = "c"
    reserved = c_text.RESERVED

    def emit(self, program: Program) -> dict[str, str]:
        """Return the source and the header."""
        return c_text.emit(program)

    def signed(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts, with a function in the source that returns the key."""
        return signed(texts, f"{name}.c", name, key)

    def unsigned(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts without that function."""
        return unsigned(texts, f"{name}.c", name, key)

    def compiler(self, operations: int, arch: str) -> Compiler:
        """Return the C compiler, with flags for a program of this length."""
        return toolchain.compiler_for(operations, arch)

    def build(self, compiler: Compiler, folder: Path, name: str) -> None:
        """Compile the source."""
        toolchain.build(compiler, folder / f"{name}.c", self.loaded(folder, name))

    def loaded(self, folder: Path, name: str) -> Path:
        """Return the path of the shared library; ``import name`` finds the NumPy module."""
        return folder / f"lib{name}.so"

    def open(self, folder: Folder, content: bytes) -> Opened:
        """Open the shared library."""
        path = self.loaded(folder.path, folder.name)
        require_kind(content, path)
        library = Library(str(path))
        source = folder.path / f"{folder.name}.c"
        key = library.text(f"{folder.name}_key")
        functions = self._functions(library, path, folder)
        return Opened(source, functions, key, source.with_suffix(".h"), path)

    def _functions(
        self, library: Library, path: Path, folder: Folder
    ) -> Iterator[tuple[str, Callable[..., Any]]]:
        require_sound(library, path, folder.name)
        for name, s in folder.signatures.items():
            symbol, doc = f"{folder.name}_{name}", "\n".join(docstring(s))
            counts = len(s.inputs), len(s.outputs)
            batch = gufunc(library, f"{symbol}_loop", symbol, s.core, *counts, s.dtype)
            defaults = [p.default for p in s.parameters if p.default is not None]
            parameters = len(s.parameters), None if len(defaults) < len(s.parameters) else defaults
            function = Function(
                library,
                symbol,
                batch,
                name,
                f"{s.calls.text}\n--\n\n{doc}",
                [a.sizes for a in s.given],
                [a.sizes for a in s.outputs],
                parameters if s.parameters else None,
                s.calls.function(_through(batch), doc),
                folder.reduced(name),
                s.dtype,
            )
            yield name, function.call


def signed(texts: Mapping[str, str], path: str, name: str, key: str) -> dict[str, str]:
    """Return texts of which the C source at ``path`` has a function that returns the key."""
    return {**texts, path: texts[path] + _key(name, key)}


def unsigned(texts: Mapping[str, str], path: str, name: str, key: str) -> dict[str, str]:
    """Return the texts that ``signed`` was given."""
    return {**texts, path: texts[path].removesuffix(_key(name, key))}


def _key(name: str, key: str) -> str:
    return render("key.c.jinja", symbol=f"{name}_key", key=key)


def require_kind(content: bytes, path: Path) -> None:
    """Raise ProcessorError for a library of another kind of machine."""
    kind, own = machines.kind_of(content), machines.own_kind()
    if kind and own and kind != own:
        raise ProcessorError(
            f"{path} was compiled for another machine: for {kind}, and this is {own}. "
            "Build the kernel again here"
        )


def require_sound(library: Library, path: Path, name: str) -> None:
    """Raise ToolchainError unless a robot's library computes as it must on this processor."""
    fault = library.said(f"{name}_fault")
    if fault is None:
        return
    if fault.startswith("this processor"):
        raise ProcessorError(
            f"{path} was compiled for another processor: {fault}. Build the kernel again here, "
            "or with arch= (--arch) for the oldest processor that it must run on"
        )
    raise ToolchainError(f"{path.name} computes wrongly: it was {fault}. Compile without them")


def _through(batch: np.ufunc) -> Callable[[Sequence[Any], Sequence[Any]], None]:
    def run(arrays: Sequence[Any], results: Sequence[Any]) -> None:
        batch(*arrays, out=tuple(results))

    return run


BACKEND = C()
