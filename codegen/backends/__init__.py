"""Backends: what writes a program in some language, builds it, and opens what was built.

A backend is one object. To moro it is known by its line in ``moro_codegen.registry``, from outside
by ``register``; nothing else asks which one it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from moro_codegen import registry

if TYPE_CHECKING:
    from moro_codegen.backends.toolchain import Compiler
    from moro_codegen.program import Program
    from moro_codegen.signature import Signature


@dataclass(frozen=True)
class Folder:
    """The folder of a kernel, as backends open it."""

    path: Path
    #: the robot's name
    name: str
    signatures: Mapping[str, Signature]
    #: what ``__reduce__`` returns for a function of the kernel, by the function's name
    reduced: Callable[[str], tuple[Any, ...]]


@dataclass(frozen=True)
class Opened:
    """What a backend has opened."""

    source: Path
    #: (name, function) of every signature; taken only when the key has been compared
    functions: Iterable[tuple[str, Callable[..., Any]]]
    #: what ``signed`` has put there; None: nothing
    key: str | None = None
    header: Path | None = None
    #: of compiled backends
    library: Path | None = None


class Backend(ABC):
    """One way from a program to functions that can be called."""

    #: what ``backend=`` and ``--backend`` call it
    name: ClassVar[str]
    #: names that no function may have: generated code uses them itself
    reserved: frozenset[str] = frozenset()

    @abstractmethod
    def emit(self, program: Program) -> dict[str, str]:
        """Return the texts of all files, by path in the kernel's folder."""

    def signed(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts of a robot of this name so that what is opened says the kernel's key."""
        return dict(texts)

    def unsigned(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts that ``signed`` was given."""
        return dict(texts)

    def compiler(self, operations: int, arch: str) -> Compiler | None:
        """Return what builds a program of so many operations for a processor; None: nothing to do.

        Raise ToolchainError if something is missing, ValueError if ``arch`` makes no sense.
        """
        if arch != "native":
            raise ValueError(f'backend="{self.name}" is for every processor: leave arch out')
        return None

    def made_with(self, compiler: Compiler) -> dict[str, Any]:
        """Return what of the compiler, and beside it, shapes a kernel: for its manifest."""
        return compiler.as_json()

    def build(self, compiler: Compiler, folder: Path, name: str) -> None:  # noqa: B027 - or nothing
        """Build the emitted files in a folder. Raise ToolchainError if that fails."""

    @abstractmethod
    def loaded(self, folder: Path, name: str) -> Path:
        """Return the file that is opened. Raise FileNotFoundError if there is none."""

    @abstractmethod
    def open(self, folder: Folder, content: bytes) -> Opened:
        """Return the functions of a kernel; ``content`` is that of ``loaded``.

        Functions check their arguments as ``Signature.calls`` does.
        """


def register(backend: Backend) -> None:
    """Make a backend known: to ``compile`` and ``build``, to the command, and to Kernel.

    Raises ValueError if its name belongs to another.
    """
    registry.BACKENDS.add(backend)


def get(name: str) -> Backend:
    """Return the backend of a name. Raise ValueError if there is none."""
    found = registry.BACKENDS.find(name)
    if not isinstance(found, Backend):
        raise TypeError(f"{name} is no Backend: {found!r}")
    return found
