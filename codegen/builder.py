"""Builds kernels: from a robot or a program to a folder that ``Kernel`` opens.

``compile`` keeps such folders in the user's cache, ``build`` puts one where it is told to; both
reuse what is there if it is the same kernel.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

import moro
from moro.model import Model, as_model
from moro.robot import Robot
from moro_codegen import extension, store, toolchain
from moro_codegen.described import described
from moro_codegen.emit.c import emit as emit_c
from moro_codegen.emit.cython import emit as emit_cython
from moro_codegen.emit.cython import package
from moro_codegen.emit.numpy import emit as emit_numpy
from moro_codegen.emit.render import render
from moro_codegen.generate import Program, generate
from moro_codegen.kernel import Backend, Kernel, cython_folder, library
from moro_codegen.progress import shown, tell
from moro_codegen.requested import Request, requested
from moro_codegen.signature import Signature
from moro_codegen.store import FORMAT
from moro_codegen.toolchain import Compiler, ProcessorError, ToolchainError

#: a language to write sources in; of the backends, Python is that with NumPy
Language: TypeAlias = Literal["c", "cython", "python"]

LANGUAGES: dict[Backend, Language] = {"c": "c", "cython": "cython", "numpy": "python"}

#: what every C source defines besides its functions, after the robot's name
SYMBOLS = ("fault", "key")

#: characters of a name; files are called like it, and folders with more behind it
MAX_NAME = 100
#: a program of more operations is long: compiled quickly rather than with every optimisation
LONG = 6000


@shown()
def compile(
    robot: Robot | Model,
    functions: Sequence[Request] = ("tau",),
    directory: str | os.PathLike[str] | None = None,
    backend: Backend = "c",
    dtype: str = "float64",
    arch: str = "native",
) -> Kernel:
    """Return the kernel of a robot: its functions, compiled for the processor at hand.

    ``functions`` are names of ``moro_codegen.FUNCTIONS``, functions of one's own, and tuples of
    these for several in one call: ``("tau", mc.Function("height", robot.T[2, 3]), ("tau",
    "inertia_matrix"))`` makes ``kernel.tau``, ``kernel.height`` and ``kernel.tau_inertia_matrix``,
    which returns (tau, M) and computes once what they share. Kernels are kept in ``directory``, by
    default in the user's cache folder, and built only once for the same robot, functions, compiler
    and processor. ``backend="numpy"`` needs no compiler; ``backend="cython"`` needs Cython and
    setuptools besides, and makes a package that can be installed without moro. With
    ``dtype="float32"`` (or "float", as C and the command say; NumPy's "float" is double) the
    functions compute in single precision, twice as many samples at once.
    ``arch`` is the oldest processor that the kernel must run on, as the compiler's -march calls it
    (``x86-64-v3``), if it is not the one at hand. Raises ToolchainError for what is missing,
    ValueError for a function that does not exist or a robot whose name is no C identifier, and
    OSError for a folder in which nothing can be kept.
    """
    start = time.perf_counter()
    if not isinstance(robot, (Robot, Model)):
        load = f": moro.load({robot!r})" if isinstance(robot, (str, os.PathLike)) else ""
        raise TypeError(f"compile takes a Robot, found {type(robot).__name__}{load}")
    model = as_model(robot)
    reserved = {*dir(Kernel), *Kernel.__annotations__, *SYMBOLS}
    program = generate(model, requested(functions, model, reserved), model.defaults)
    program = replace(described(program, model), scalar=_scalar(dtype))
    generated = time.perf_counter() - start
    return build(
        program,
        Path(directory) if directory is not None else store.cache(),
        backend,
        arch=arch,
        named_by_key=True,
        source={"model_sha256": hashlib.sha256(repr(model).encode()).hexdigest()},
        timings={"generate": generated},
    )


def build(
    program: Program,
    directory: str | os.PathLike[str],
    backend: Backend = "c",
    *,
    arch: str = "native",
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
    Everything is built in a folder beside ``directory`` and moved there when it is complete; what
    is there already and whole is opened without writing anything. A kernel for an ``arch`` that
    the processor at hand is not is built, and then ProcessorError says that it cannot be opened.
    """
    seconds = dict(timings or {})
    start = time.perf_counter()
    texts = sources(program, backend, languages)
    seconds["emit"] = time.perf_counter() - start
    compiler = None if backend == "numpy" else _compiler_for(program, arch)
    if compiler is None and arch != "native":
        raise ValueError('backend="numpy" is for every processor: leave arch out')
    manifest = describe(program, backend, texts, compiler, source)
    folder = Path(directory).absolute()
    if named_by_key:
        folder /= f"{program.name}-{manifest['key'][:16]}"
    start = time.perf_counter()
    reused = _is_there(folder, texts, manifest, compiler)
    seconds["compile"] = time.perf_counter() - start
    return Kernel(folder, reused=reused, timings=seconds)


def _is_there(
    folder: Path, texts: Mapping[str, str], manifest: Mapping[str, Any], compiler: Compiler | None
) -> bool:
    """See to it that the folder holds the kernel; tell whether it did so already."""
    if store.is_current(folder, manifest) and store.has_input(folder, manifest):
        return True
    try:
        with store.lock(folder):
            if not store.is_current(folder, manifest):
                tell(f"{'compiling' if compiler else 'writing'} {manifest['name']}")
                _install(folder, texts, manifest, compiler)
                return False
            if not store.has_input(folder, manifest):
                store.record_input(folder, manifest)
    except OSError:
        if not store.is_current(folder, manifest):
            raise
    return True


def _scalar(dtype: Any) -> Literal["double", "float"]:
    """Return the type of C for a type of NumPy's, or for its name in C."""
    scalars: dict[str, Literal["double", "float"]] = {"float64": "double", "float32": "float"}
    if isinstance(dtype, str) and dtype in scalars.values():
        return "float" if dtype == "float" else "double"  # the words of C and of the command
    with suppress(TypeError, KeyError):
        return scalars[np.dtype(dtype).name]
    raise ValueError(f'dtype must be "float64" or "float32", not {dtype!r}')


def _compiler_for(program: Program, arch: str) -> Compiler:
    """Return the compiler, with flags for a program of this length."""
    compiler = toolchain.find_compiler(arch)
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
    if len(program.name) > MAX_NAME:
        raise ValueError(
            f"a robot's name of {len(program.name)} characters cannot name files and functions: "
            f"at most {MAX_NAME}"
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
            "features": list(compiler.features),
        }
        if backend == "cython":
            made_with |= extension.tools()
    manifest = {
        "format": FORMAT,
        "name": program.name,
        "dof": program.dof,
        "joint_kinds": list(program.joint_kinds),
        "convention": program.convention,
        "gravity": None if program.gravity is None else list(program.gravity),
        "scalar": program.scalar,
        "backend": backend,
        "texts": hashlib.sha256(json.dumps(dict(texts), sort_keys=True).encode()).hexdigest(),
        "input": dict(source or {}),
        "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "versions": {
            "moro": moro.__version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "sympy": metadata.version("sympy"),
        },
        "compiler": made_with,
        "parameters": [asdict(parameter) for parameter in program.parameters],
        "functions": [Signature.of(program, r).as_json() for r in program.routines],
    }
    return {**manifest, "key": store.key_of(manifest)}


def _signed(path: str, text: str, manifest: Mapping[str, Any]) -> str:
    """Return the text of a file; the library that is made of it, or is it, says whose it is."""
    name, key = manifest["name"], manifest["key"]
    if Path(path).name == f"{name}.c":
        return text + render("key.c.jinja", symbol=f"{name}_key", key=key)
    if Path(path).name == f"{name}.py":
        return text + render("key.py.jinja", key=key)
    return text


def _install(
    folder: Path, texts: Mapping[str, str], manifest: Mapping[str, Any], compiler: Compiler | None
) -> None:
    """Build a kernel beside the folder, try it, and move it there."""
    with store.workshop(folder) as beside:
        new = beside / folder.name
        new.mkdir()
        for name, text in texts.items():
            (new / name).parent.mkdir(parents=True, exist_ok=True)
            (new / name).write_text(_signed(name, text, manifest), encoding="utf-8")
        name = manifest["name"]
        if manifest["backend"] == "c" and compiler is not None:
            toolchain.build(compiler, new / f"{name}.c", new / library(name))
        elif manifest["backend"] == "cython" and compiler is not None:
            extension.build(compiler, new / cython_folder(name), package(name))
        files = {path: store.digest(new / path) for path in store.paths(new)}
        store.write_manifest(new, {**manifest, "files": files})
        _try(new)
        store.move(new, folder)


def _try(folder: Path) -> None:
    """Load a new kernel, as its users will."""
    try:
        Kernel(folder)
    except ProcessorError:
        pass  # for another processor, as the user wished
    except OSError as error:
        raise ToolchainError(
            f"the compiler's library cannot be loaded: {error}\n{toolchain.FALLBACK}"
        ) from None
