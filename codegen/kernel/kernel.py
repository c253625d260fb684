"""Kernels: what the user calls, opened from the folder in which it is kept.

A kernel is a folder: what its backend wrote and built there, C source, header and shared library or
a Python module, and a manifest that says what they are and what they were made of.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache, partial, update_wrapper
from pathlib import Path
from types import BuiltinFunctionType, FunctionType
from typing import TYPE_CHECKING, Any

from moro_codegen import backends
from moro_codegen.backends import Backend, Folder, Opened
from moro_codegen.kernel import native
from moro_codegen.kernel.parcel import Parcel
from moro_codegen.kernel.rollout import rollout
from moro_codegen.kernel.store import MANIFEST, DamagedError, checked_file, read_manifest, settled
from moro_codegen.signature import Signature

if TYPE_CHECKING:
    from moro_codegen.kernel.in_jax import InJAX
    from moro_codegen.kernel.in_torch import InTorch


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
    backend: str
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
        self._parcel = Parcel(self.directory, self.manifest["key"], self.manifest)
        self.ops = {name: dict(s.ops) for name, s in self.signatures.items()}
        try:
            opened = self._opened(backends.get(self.backend))
        except FileNotFoundError as error:  # by a rebuild, since we looked
            raise DamagedError(self.directory, str(error)) from None
        self.source, self.header, self.library = opened.source, opened.header, opened.library
        for name, call in opened.functions:
            kept = _Kept(call, self._parcel) if isinstance(call, FunctionType) else call
            bound: Any = call.__self__ if isinstance(call, BuiltinFunctionType) else None
            general: Any = bound.general if bound else call
            general.public = _Sent(self._parcel, name, kept)
            setattr(self, name, kept)

    def _opened(self, backend: Backend) -> Opened:
        """Return what the backend finds in the folder, if it is what the manifest describes."""
        path = backend.loaded(self.directory, self.name)
        inside = path.relative_to(self.directory).as_posix()
        content = checked_file(self.directory, self.manifest, inside)
        folder = Folder(
            self.directory,
            self.name,
            self.signatures,
            lambda name: (_function_of, (self._parcel, name)),
        )
        opened = backend.open(folder, content)
        if opened.key not in (None, self.manifest["key"]):
            what = f"{path.name} is of another kernel than {MANIFEST} describes"
            raise DamagedError(self.directory, what)
        return opened

    def rollout(
        self,
        q: Any,
        qd: Any,
        tau: Any,
        dt: Any,
        *,
        steps: int | None = None,
        step: str = "step_semi_implicit",
        parameters: Any = None,
        threads: int = 1,
    ) -> tuple[Any, Any]:
        """Return the trajectory (q, qd) from a state under torques, each (..., steps + 1, n).

            q, qd = kernel.rollout(q0, qd0, tau, 1e-3)          # tau is (..., steps, n)
            q, qd = kernel.rollout(q0, qd0, controller, 1e-3, steps=1000)

        Many trajectories go side by side: axes in front of those of one are broadcast. tau has a
        row for each step, or is a function of (number of the step, q, qd) that returns torques.
        ``step`` is the kernel's function that is used, "step_semi_implicit" or "step_rk4";
        ``parameters`` and ``threads`` are those of its calls.

        Raises ValueError for a kernel without that function, and for shapes that do not fit.
        """
        if step not in self.signatures:
            raise ValueError(
                f"this kernel has no {step!r}: compile(robot, functions=({step!r},)) makes it"
            )
        options = {} if parameters is None else {"parameters": parameters}
        options |= {} if threads == 1 else {"threads": threads}
        dtype = self.signatures[step].dtype
        return rollout(getattr(self, step), q, qd, tau, dt, steps, dtype, **options)

    @cached_property
    def jax(self) -> InJAX:
        """The same functions for JAX on the CPU, ``kernel.jax.tau(q, qd, qdd)``, with derivatives.

        They go through ``jax.jit``, ``jax.vmap`` and ``jax.grad``; derivatives are those of the
        kernel's own functions, of ``tau`` for one those of ``tau_derivatives``. Raises ValueError
        for a kernel that is not in C, ImportError without JAX.
        """
        from moro_codegen.kernel.in_jax import InJAX

        return InJAX(self)

    @cached_property
    def torch(self) -> InTorch:
        """The same functions for PyTorch on the CPU, ``kernel.torch.tau(q, qd, qdd)``.

        They go through ``torch.vmap``, ``torch.compile`` and ``backward``, with derivatives like
        those of ``jax``, but not through ``torch.func.grad`` and its like. Raises ImportError
        without PyTorch.
        """
        from moro_codegen.kernel.in_torch import InTorch

        return InTorch(self)

    @cached_property
    def ctypes(self) -> dict[str, Any]:
        """The C functions for one state, through ctypes: ``kernel.ctypes["tau"](q, ..., tau)``.

        They take a pointer for each input, then for each result, with the run-time parameters as
        the last input; the interpreter's lock is let go, and nothing is checked. Raises ValueError
        for a kernel without a library, or one whose library has been replaced.
        """
        if self.library is None:
            raise ValueError(f'a kernel with backend="{self.backend}" has no functions in C')
        return native.functions(self.library, self.name, self.manifest["key"], self.signatures)

    @property
    def address(self) -> dict[str, int]:
        """Where the same functions are in memory: ``kernel.address["tau"]``."""
        return {name: native.address(call) for name, call in self.ctypes.items()}

    @property
    def capsule(self) -> dict[str, Any]:
        """The same functions as PyCapsules, whose names are their types in C."""
        return {
            name: native.capsule(call, self.signatures[name]) for name, call in self.ctypes.items()
        }

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
        return _sent, (self._parcel,)


class _Kept(partial):  # type: ignore[type-arg]
    """A function of Python that is pickled as that of a kernel."""

    _origin: tuple[Parcel, str]

    def __new__(cls, function: Callable[..., Any], parcel: Parcel) -> _Kept:
        kept = super().__new__(cls, function)
        update_wrapper(kept, function)
        kept._origin = parcel, function.__name__
        return kept

    def __reduce__(self) -> tuple[Any, ...]:
        return _function_of, self._origin


class _Sent:
    """A function of a kernel in tasks: opened where they are run, not where they are planned."""

    def __init__(
        self, parcel: Parcel, name: str, function: Callable[..., Any] | None = None
    ) -> None:
        self._parcel, self.__name__, self._function = parcel, name, function

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        if self._function is None:
            self._function = getattr(_sent(self._parcel), self.__name__)
        return self._function(*args, **keywords)

    def __reduce__(self) -> tuple[Any, ...]:
        return _Sent, (self._parcel, self.__name__)


@lru_cache(maxsize=32)  # tasks come by the thousand, each with its function
def _sent(parcel: Parcel) -> Kernel:
    """Return the kernel that was sent to this process, and can be sent on."""
    kernel = parcel.opened(Kernel)
    kernel._parcel.content = parcel.content
    return kernel


def _function_of(parcel: Parcel, name: str) -> Any:
    """Return a function of a kernel that was sent; of one in C, the object it is bound to."""
    function = getattr(_sent(parcel), name)
    return function if isinstance(function, _Kept) else function.__self__
