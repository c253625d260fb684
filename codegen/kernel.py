"""Kernels: what the user calls, opened from the folder in which it is kept.

A kernel is a folder: C source, header and shared library (or a Python module), and a manifest that
says what they are and what they were made of.
"""

from __future__ import annotations

import builtins
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial, update_wrapper
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, TypeAlias

import numpy as np

from moro_codegen import extension
from moro_codegen._runtime import Function, Library, gufunc
from moro_codegen.emit.cython import package
from moro_codegen.emit.describe import docstring, shape
from moro_codegen.signature import Signature
from moro_codegen.store import MANIFEST, DamagedError, checked_file, read_manifest, settled
from moro_codegen.toolchain import ProcessorError, ToolchainError

Backend: TypeAlias = Literal["c", "cython", "numpy"]


class Kernel:
    """The functions of one robot, as fast as the machine allows.

    Each function is an attribute: ``kernel.tau(q, qd, qdd)``; its docstring says what it takes and
    returns. ``Kernel(directory)`` opens the kernel that ``build`` left there.

    Raises FileNotFoundError if there is none, ValueError if its files do not belong together or are
    of another version of moro, ToolchainError if it was compiled for another processor or with
    options that change what it computes.
    """

    #: the robot's name, its number of joints, the folder of the kernel's files
    name: str
    dof: int
    directory: Path
    backend: Backend
    #: paths of the shared library, source in C or Cython and header, or of the Python module
    library: Path | None
    source: Path
    header: Path | None
    #: what each function costs: {"tau": {"add": .., "sub": .., "mul": .., "sincos": ..}}
    ops: dict[str, dict[str, int]]
    #: run-time parameters and their defaults (None: has to be given), in order
    parameters: dict[str, float | None]
    signatures: dict[str, Signature]
    manifest: dict[str, Any]
    #: was there already; else, how many seconds each step of the build took
    reused: bool
    timings: dict[str, float]

    def __init__(
        self,
        directory: str | os.PathLike[str],
        *,
        reused: bool = True,
        timings: Mapping[str, float] | None = None,
    ) -> None:
        self.directory = Path(directory).absolute()
        self.reused, self.timings = reused, dict(timings or {})
        settled(self._open)

    def _open(self) -> None:
        """Read the manifest, then open what it describes, if that says the same of itself."""
        self.manifest = read_manifest(self.directory)
        self.name, self.dof = self.manifest["name"], self.manifest["dof"]
        self.backend = self.manifest["backend"]
        self.parameters = {p["name"]: p["default"] for p in self.manifest["parameters"]}
        self.signatures = {
            item["name"]: Signature.from_json(item) for item in self.manifest["functions"]
        }
        self.ops = {name: dict(s.ops) for name, s in self.signatures.items()}
        self.library = self.header = None
        functions = {
            "c": self._c_functions,
            "cython": self._cython_functions,
            "numpy": self._numpy_functions,
        }
        for name, call in functions[self.backend]():
            setattr(self, name, call)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        functions = ", ".join(self.__dict__.get("signatures", ()))
        raise AttributeError(
            f"this kernel has no {name!r}; its functions are: {functions} "
            f"(compile(robot, functions=(...)) makes others)"
        )

    def __repr__(self) -> str:
        functions = ", ".join(
            f"{name} ({sum(ops.get(op, 0) for op in ('add', 'sub', 'mul', 'div'))} operations)"
            for name, ops in self.ops.items()
        )
        given = f", parameters {', '.join(self.parameters)}" if self.parameters else ""
        return (
            f"<Kernel {self.name}: {self.dof} joints, {functions}{given}, "
            f"{self.library or self.source}>"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return Kernel, (self.directory,)

    def _c_functions(self) -> Iterator[tuple[str, Callable[..., Any]]]:
        """Yield the functions of the shared library."""
        self.source = self.directory / f"{self.name}.c"
        self.header = self.directory / f"{self.name}.h"
        self.library = self.directory / library(self.name)
        opened = self._checked_library(self.library)
        for name, s in self.signatures.items():
            symbol, doc = f"{self.name}_{name}", _doc(s)
            counts = len(s.inputs), len(s.outputs)
            batch = gufunc(opened, f"{symbol}_loop", symbol, s.core, *counts, s.dtype)
            defaults = [p.default for p in s.parameters if p.default is not None]
            parameters = len(s.parameters), None if len(defaults) < len(s.parameters) else defaults
            function = Function(
                opened,
                symbol,
                batch,
                name,
                f"{s.calls.text}\n--\n\n{doc}",
                [shape(a) for a in s.given],
                [shape(a) for a in s.outputs],
                parameters if s.parameters else None,
                s.calls.function(_through(batch), doc),
                (_function_of, (self.directory, name)),
                s.dtype,
            )
            yield name, function.call

    def _checked_library(self, path: Path) -> Library:
        """Return a library that is the manifest's, and computes as it must on this processor."""
        checked_file(self.directory, self.manifest, path.relative_to(self.directory).as_posix())
        try:
            library = Library(str(path))
        except FileNotFoundError as error:  # by a rebuild, since we looked
            raise DamagedError(self.directory, str(error)) from None
        if library.text(f"{self.name}_key") != self.manifest["key"]:
            raise _of_another(self.directory, path)
        fault = library.said(f"{self.name}_fault")
        if fault is None:
            return library
        if fault.startswith("this processor"):
            raise ProcessorError(
                f"{path} was compiled for another processor: {fault}. Build the kernel again here, "
                "or with arch= (--arch) for the oldest processor that it must run on"
            )
        raise ToolchainError(f"{path.name} computes wrongly: it was {fault}. Compile without them")

    def _cython_functions(self) -> Iterator[tuple[str, Callable[..., Any]]]:
        """Yield the functions of the extension."""
        folder = self.directory / cython_folder(self.name) / package(self.name)
        self.source = folder / "functions.pyx"
        self.header = folder / f"{self.name}.h"
        try:
            self.library = extension.library(folder)
        except FileNotFoundError as error:
            raise DamagedError(self.directory, str(error)) from None
        self._checked_library(self.library)
        module = extension.load(self.library)
        for name, s in self.signatures.items():
            run, direct = getattr(module, f"_{name}_of_arrays"), getattr(module, name)
            yield name, _Kept(s.calls.function(run, _doc(s), direct), self.directory)

    def _numpy_functions(self) -> Iterator[tuple[str, Callable[..., Any]]]:
        """Yield the functions of the Python module."""
        self.source = self.directory / f"{self.name}.py"
        module = ModuleType(self.name)
        text = checked_file(self.directory, self.manifest, self.source.name)
        code = builtins.compile(text, str(self.source), "exec")
        exec(code, module.__dict__)  # noqa: S102 - as much ours as the shared library is
        if self.manifest["key"] != module.KEY:
            raise _of_another(self.directory, self.source)
        for name, s in self.signatures.items():
            run = s.calls.in_chunks(getattr(module, f"_{name}_of_arrays"))
            yield name, _Kept(s.calls.function(run, _doc(s)), self.directory)


def _of_another(folder: Path, path: Path) -> DamagedError:
    return DamagedError(folder, f"{path.name} is of another kernel than {MANIFEST} describes")


class _Kept(partial):  # type: ignore[type-arg]
    """A function of Python that is pickled as that of the kernel in a folder."""

    _origin: tuple[Path, str]

    def __new__(cls, function: Callable[..., Any], directory: Path) -> _Kept:
        kept = super().__new__(cls, function)
        update_wrapper(kept, function)
        kept._origin = directory, function.__name__
        return kept

    def __reduce__(self) -> tuple[Any, ...]:
        return _function_of, self._origin


def _function_of(directory: Path, name: str) -> Any:
    """Return a function of the kernel in a folder; of one in C, the object it is bound to."""
    function = getattr(Kernel(directory), name)
    return function if isinstance(function, _Kept) else function.__self__


def _through(batch: np.ufunc) -> Callable[[Sequence[Any], Sequence[Any]], None]:
    def run(arrays: Sequence[Any], results: Sequence[Any]) -> None:
        batch(*arrays, out=tuple(results))

    return run


def _doc(signature: Signature) -> str:
    return "\n".join(docstring(signature))


def library(name: str) -> str:
    """Return the name of a robot's shared library; ``import name`` finds the NumPy module."""
    return f"lib{name}.so"


def cython_folder(name: str) -> str:
    """Return the name of the folder of a robot's Cython extension, inside that of the kernel."""
    return f"{name}_cython"
