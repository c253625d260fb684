"""Kernels: the compiled functions of a robot, built once and kept on disk.

A kernel is a folder: C source, header and shared library (or a Python module), and a manifest that
says what they are and what they were made of. ``compile`` keeps such folders in the user's cache,
``build`` puts one where it is told to; both reuse what is there if it is the same kernel.
"""

from __future__ import annotations

import builtins
import hashlib
import json
import math
import os
import platform
import re
import tempfile
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, TypeAlias

import numpy as np
from filelock import FileLock
from platformdirs import user_cache_path

from moro.robot import Robot
from moro_codegen import extension, toolchain
from moro_codegen._runtime import Function, Library, gufunc
from moro_codegen.described import described
from moro_codegen.emit.c import emit as emit_c
from moro_codegen.emit.cython import emit as emit_cython
from moro_codegen.emit.cython import package
from moro_codegen.emit.describe import shape, version
from moro_codegen.emit.numpy import emit as emit_numpy
from moro_codegen.generate import Program, generate
from moro_codegen.quick import quick
from moro_codegen.requested import Request, requested
from moro_codegen.signature import Array, Run, Signature
from moro_codegen.toolchain import Compiler, ToolchainError

Backend: TypeAlias = Literal["c", "cython", "numpy"]
#: a language to write sources in; of the backends, Python is that with NumPy
Language: TypeAlias = Literal["c", "cython", "python"]

LANGUAGES: dict[Backend, Language] = {"c": "c", "cython": "cython", "numpy": "python"}

MANIFEST = "manifest.json"
#: of the manifest and of what the runtime expects in a library
FORMAT = 1
#: a program of more operations is long: compiled quickly rather than with every optimisation
LONG = 6000
#: samples that a NumPy kernel works on at once, so that its intermediate results stay in the cache
CHUNK = 4096


def compile(
    robot: Robot,
    functions: Sequence[Request] = ("tau",),
    directory: str | os.PathLike[str] | None = None,
    backend: Backend = "c",
    dtype: str = "float64",
) -> Kernel:
    """Return the kernel of a robot: its functions, compiled for the processor at hand.

    ``functions`` are names of ``moro_codegen.FUNCTIONS``, functions of one's own, and tuples of
    these for several in one call: ``("tau", mc.Function("height", robot.T[2, 3]), ("tau",
    "inertia_matrix"))`` makes ``kernel.tau``, ``kernel.height`` and ``kernel.tau_inertia_matrix``,
    which returns (tau, M) and computes once what they share. Kernels are kept in ``directory``, by
    default in the user's cache folder, and built only once for the same robot, functions, compiler
    and processor. ``backend="numpy"`` needs no compiler; ``backend="cython"`` needs Cython and
    setuptools besides, and makes a package that can be installed without moro. With
    ``dtype="float32"`` the functions compute in single precision, twice as many samples at once.
    Raises ToolchainError for what is missing, and ValueError for a function that does not exist or
    a robot whose name is no C identifier.
    """
    start = time.perf_counter()
    model = robot.model()
    reserved = {*dir(Kernel), *Kernel.__annotations__}
    program = generate(model, requested(functions, robot, reserved), robot.parameters)
    program = replace(described(program, robot), scalar=_scalar(dtype))
    generated = time.perf_counter() - start
    return build(
        program,
        Path(directory) if directory is not None else user_cache_path("moro") / "kernels",
        backend,
        named_by_key=True,
        source={"model_sha256": hashlib.sha256(repr(model).encode()).hexdigest()},
        timings={"generate": generated},
    )


def build(
    program: Program,
    directory: str | os.PathLike[str],
    backend: Backend = "c",
    *,
    named_by_key: bool = False,
    languages: Collection[Language] = (),
    source: Mapping[str, str] | None = None,
    timings: Mapping[str, float] | None = None,
) -> Kernel:
    """Return the kernel of a program in ``directory``, built anew only if another one is there.

    The sources of further ``languages`` ("c", "cython", "python") are written beside its own. With
    ``named_by_key`` the kernel gets a folder of its own inside ``directory``. ``source`` says where
    the program came from (``{"file": ..., "sha256": ...}``) and is recorded in the manifest as
    "input". The kernel's ``timings`` are those given, and the seconds for "emit" and "compile".
    Everything is built in a folder beside ``directory`` and moved there when it is complete.
    """
    seconds = dict(timings or {})
    start = time.perf_counter()
    texts = sources(program, backend, languages)
    seconds["emit"] = time.perf_counter() - start
    compiler = None if backend == "numpy" else _compiler_for(program)
    manifest = describe(program, backend, texts, compiler, source)
    folder = Path(directory).absolute()
    if named_by_key:
        folder /= f"{program.name}-{manifest['key'][:16]}"
    with _lock(folder):
        reused = is_current(folder, manifest)
        start = time.perf_counter()
        if not reused:
            _install(folder, texts, manifest, compiler)
        elif (there := _read_manifest(folder))["input"] != manifest["input"]:
            _write_manifest(folder, {**there, "input": manifest["input"]})
        seconds["compile"] = time.perf_counter() - start
        return Kernel(folder, reused=reused, timings=seconds)


class Kernel:
    """The functions of one robot, as fast as the machine allows.

    Each function is an attribute: ``kernel.tau(q, qd, qdd)``; its docstring says what it takes and
    returns. ``Kernel(directory)`` opens the kernel that ``build`` left there.
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
        self.manifest = _read_manifest(self.directory)
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

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.signatures]

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
        self.library = self.directory / f"{self.name}.so"
        library = Library(str(self.library))
        for name, s in self.signatures.items():
            symbol = f"{self.name}_{name}"
            counts = len(s.inputs), len(s.outputs)
            batch = gufunc(library, f"{symbol}_loop", symbol, s.core, *counts, s.dtype)
            defaults = [p.default for p in s.parameters if p.default is not None]
            parameters = len(s.parameters), None if len(defaults) < len(s.parameters) else defaults
            function = Function(
                library,
                symbol,
                batch,
                name,
                f"{s.call}\n--\n\n{s.doc}",
                [shape(a) for a in s.given],
                [shape(a) for a in s.outputs],
                parameters if s.parameters else None,
                s.checked(_through(batch)),
                (_function_of, (self.directory, name)),
                s.dtype,
            )
            yield name, function.call

    def _cython_functions(self) -> Iterator[tuple[str, Callable[..., Any]]]:
        """Yield the functions of the extension."""
        folder = self.directory / cython_folder(self.name) / package(self.name)
        self.source = folder / "functions.pyx"
        self.header = folder / f"{self.name}.h"
        self.library = extension.library(folder)
        module = extension.load(self.library)
        for name, s in self.signatures.items():
            direct = getattr(module, name)
            yield name, quick(direct, s.checked(_into(direct)), s)

    def _numpy_functions(self) -> Iterator[tuple[str, Callable[..., Any]]]:
        """Yield the functions of the Python module."""
        self.source = self.directory / f"{self.name}.py"
        module = ModuleType(self.name)
        code = builtins.compile(self.source.read_text(encoding="utf-8"), str(self.source), "exec")
        exec(code, module.__dict__)  # noqa: S102 - as much ours as the shared library is
        for name, s in self.signatures.items():
            yield name, s.checked(in_chunks(getattr(module, name), s))


def _function_of(directory: Path, name: str) -> Function:
    """Return a function of the kernel in a folder, for pickle."""
    function: Function = getattr(Kernel(directory), name).__self__
    return function


def _through(batch: np.ufunc) -> Run:
    def run(inputs: Sequence[Array], results: Sequence[Array]) -> None:
        batch(*inputs, out=tuple(results))

    return run


def _into(direct: Callable[..., Any]) -> Run:
    def run(inputs: Sequence[Array], results: Sequence[Array]) -> None:
        direct(*inputs, out=tuple(results) if len(results) > 1 else results[0])

    return run


def in_chunks(function: Callable[..., Any], signature: Signature) -> Run:
    """Return a run of a NumPy function that goes through many samples CHUNK by CHUNK."""
    several = len(signature.outputs) > 1

    def fill(inputs: Sequence[Array], results: Sequence[Array]) -> None:
        values = function(*inputs)
        for result, value in zip(results, values if several else (values,), strict=True):
            result[...] = value

    def run(inputs: Sequence[Array], results: Sequence[Array]) -> None:
        samples = results[0].shape[: results[0].ndim - len(signature.outputs[0].shape)]
        count = math.prod(samples)
        with np.errstate(all="ignore"):
            if count <= CHUNK:
                fill(inputs, results)
                return
            rows = [
                np.broadcast_to(x, samples + shape(a)).reshape(count, *shape(a))
                for a, x in zip(signature.inputs, inputs, strict=True)
            ]
            flat = [np.empty((count, *shape(a)), signature.dtype) for a in signature.outputs]
            for start in range(0, count, CHUNK):
                part = slice(start, start + CHUNK)
                fill([x[part] for x in rows], [y[part] for y in flat])
        for result, value in zip(results, flat, strict=True):
            result[...] = value.reshape(result.shape)

    return run


# -- on disk -----------------------------------------------------------------------------------


def _scalar(dtype: Any) -> Literal["double", "float"]:
    """Return the type of C for a type of NumPy's."""
    scalars: dict[str, Literal["double", "float"]] = {"float64": "double", "float32": "float"}
    with suppress(TypeError, KeyError):
        return scalars[np.dtype(dtype).name]
    raise ValueError(f'dtype must be "float64" or "float32", not {dtype!r}')


def _compiler_for(program: Program) -> Compiler:
    """Return the compiler, with flags for a program of this length."""
    compiler = toolchain.find_compiler()
    operations = sum(sum(routine.ops.values()) for routine in program.routines)
    return compiler.quick() if operations > LONG else compiler


def sources(
    program: Program, backend: Backend, languages: Collection[Language] = ()
) -> dict[str, str]:
    """Return the texts of a program's files, by path. Raise ValueError for an unusable name."""
    if backend not in LANGUAGES:
        raise ValueError(f"backend must be {_either(LANGUAGES)}, not {backend!r}")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", program.name):
        raise ValueError(
            f"a robot named {program.name!r} cannot name functions: letters, digits and "
            "underscores only, a letter first"
        )
    texts: dict[str, str] = {}
    for language in dict.fromkeys((LANGUAGES[backend], *languages)):
        if language == "c":
            texts |= emit_c(program)
        elif language == "python":
            texts |= emit_numpy(program)
        elif language == "cython":
            folder = cython_folder(program.name)
            texts |= {f"{folder}/{p}": text for p, text in emit_cython(program).items()}
        else:
            raise ValueError(f"languages are {_either(LANGUAGES.values())}, not {language!r}")
    return texts


def cython_folder(name: str) -> str:
    """Return the name of the folder of a robot's Cython extension, inside that of the kernel."""
    return f"{name}_cython"


def _either(names: Iterable[str]) -> str:
    *most, last = [f'"{name}"' for name in names]
    return f"{', '.join(most)} or {last}"


def describe(
    program: Program,
    backend: Backend,
    texts: Mapping[str, str],
    compiler: Compiler | None,
    source: Mapping[str, str] | None,
) -> dict[str, Any]:
    """Return a kernel's manifest; its "key" is the hash of everything that shapes the kernel."""
    made_with = None
    if compiler is not None:
        made_with = {
            "command": list(compiler.command),
            "version": compiler.version,
            "flags": list(compiler.flags),
            "target": compiler.target,
        }
        if backend == "cython":
            made_with |= extension.tools()
    shaping = json.dumps([FORMAT, backend, dict(texts), made_with], sort_keys=True)
    return {
        "format": FORMAT,
        "name": program.name,
        "dof": program.dof,
        "joint_kinds": list(program.joint_kinds),
        "convention": program.convention,
        "gravity": None if program.gravity is None else list(program.gravity),
        "scalar": program.scalar,
        "backend": backend,
        "key": hashlib.sha256(shaping.encode()).hexdigest(),
        "input": dict(source or {}),
        "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "versions": {
            "moro": version(),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "sympy": metadata.version("sympy"),
        },
        "compiler": made_with,
        "parameters": [asdict(parameter) for parameter in program.parameters],
        "functions": [Signature.of(program, r).as_json() for r in program.routines],
    }


def is_current(folder: Path, manifest: Mapping[str, Any]) -> bool:
    """Tell whether the folder holds, whole, the kernel that the manifest describes."""
    try:
        there = _read_manifest(folder)
        return bool(there["key"] == manifest["key"]) and all(
            _hash(folder / name) == digest for name, digest in there["files"].items()
        )
    except (OSError, ValueError, KeyError):
        return False


def _install(
    folder: Path, texts: Mapping[str, str], manifest: dict[str, Any], compiler: Compiler | None
) -> None:
    """Build a kernel beside the folder, try it, and move it there."""
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as beside:
        new = Path(beside) / folder.name
        new.mkdir()
        for name, text in texts.items():
            (new / name).parent.mkdir(parents=True, exist_ok=True)
            (new / name).write_text(text, encoding="utf-8")
        name = manifest["name"]
        if manifest["backend"] == "c" and compiler is not None:
            toolchain.build(compiler, new / f"{name}.c", new / f"{name}.so")
        elif manifest["backend"] == "cython" and compiler is not None:
            extension.build(compiler, new / cython_folder(name), package(name))
        files = {path: _hash(new / path) for path in _paths(new)}
        _write_manifest(new, {**manifest, "files": files})
        _try(new)
        _move(new, folder)


def _try(folder: Path) -> None:
    """Load a new kernel, as its users will."""
    try:
        Kernel(folder)
    except OSError as error:
        raise ToolchainError(
            f"the compiler's library cannot be loaded: {error}\n{toolchain.FALLBACK}"
        ) from None


def _move(new: Path, folder: Path) -> None:
    """Put a new kernel where it belongs; while it replaces another there is no manifest."""
    if not folder.exists():
        new.rename(folder)
        return
    old = _files_of(folder)
    (folder / MANIFEST).unlink(missing_ok=True)
    names = sorted(_paths(new), key=lambda name: name == MANIFEST)
    for name in old - set(names):
        (folder / name).unlink(missing_ok=True)
        for parent in Path(name).parents[:-1]:
            with suppress(OSError):  # not empty, or gone
                (folder / parent).rmdir()
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (new / name).replace(folder / name)


def _paths(folder: Path) -> list[str]:
    """Return the paths of all files in a folder, relative to it."""
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


def _files_of(folder: Path) -> set[str]:
    """Return the paths of the files of the kernel in a folder, if there is one."""
    try:
        paths = set(_read_manifest(folder)["files"])
    except (OSError, ValueError, KeyError):
        return set()
    return {path for path in paths if ".." not in Path(path).parts and not Path(path).is_absolute()}


@contextmanager
def _lock(folder: Path) -> Iterator[None]:
    """Let one process at a time look at a kernel's folder and build in it.

    The lock's file stays: another process may be waiting for it, and a third would make a new one.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(folder.parent / f".{folder.name}.lock"):
        yield


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _read_manifest(folder: Path) -> dict[str, Any]:
    path = folder / MANIFEST
    manifest: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if manifest.get("format") != FORMAT:
        raise ValueError(f"{path} is of another version of moro: build the kernel again")
    return manifest


def _write_manifest(folder: Path, manifest: Mapping[str, Any]) -> None:
    """Write a manifest beside its place, then rename it."""
    path = folder / MANIFEST
    beside = path.with_suffix(".new")
    beside.write_text(json.dumps(manifest, indent=2) + "\n", encoding="utf-8")
    beside.replace(path)
