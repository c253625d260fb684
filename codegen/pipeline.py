"""The one way from a robot to a kernel: what was asked for, its program, texts, a folder, a Kernel.

``compile`` keeps such folders in the user's cache, ``build`` puts one where it is told to; both
reuse what is there if it is the same kernel.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import moro
from moro.model import Model, as_model
from moro.robot import Robot
from moro_codegen import backends
from moro_codegen.backends import Backend
from moro_codegen.functions.requested import Request
from moro_codegen.kernel import store
from moro_codegen.kernel.building import Work, is_there
from moro_codegen.kernel.kernel import Kernel
from moro_codegen.program import Program, generate
from moro_codegen.progress import shown

#: what every C source defines besides its functions, after the robot's name
SYMBOLS = ("fault", "key")

#: characters of a name; files are called like it, and folders with more behind it
MAX_NAME = 100


@shown()
def compile(
    robot: Robot | Model,
    functions: Sequence[Request] = ("tau",),
    directory: str | os.PathLike[str] | None = None,
    backend: str = "c",
    dtype: str = "float64",
    arch: str = "native",
) -> Kernel:
    """Return the kernel of a robot: its functions, compiled for the processor at hand.

    ``functions`` are names of ``moro_codegen.FUNCTIONS``, functions of one's own, and tuples of
    these for several in one call: ``("tau", mc.Function("height", robot.T[2, 3]), ("tau",
    "inertia_matrix"))`` makes ``kernel.tau``, ``kernel.height`` and ``kernel.tau_inertia_matrix``,
    which returns (tau, M) and computes once what they share. What is of the last frame is of any
    other by its name: ``"jacobian@camera"`` makes ``kernel.jacobian_camera``. Kernels are kept in
    ``directory``, by default in the user's cache folder, and built only once for the same robot,
    functions, compiler and processor. ``backend="numpy"`` needs no compiler; ``backend="cython"``
    needs Cython and setuptools besides, and makes a package that can be installed without moro.
    With ``dtype="float32"`` (or "float", as C and the command say; NumPy's "float" is double) the
    functions compute in single precision, twice as many samples at once. ``arch`` is the oldest
    processor that the kernel must run on, as the compiler's -march calls it (``x86-64-v3``), if it
    is not the one at hand. Raises ToolchainError for what is missing, ValueError for a function
    that does not exist or a robot whose name is no C identifier, and OSError for a folder in which
    nothing can be kept.
    """
    if not isinstance(robot, (Robot, Model)):
        load = f": moro.load({robot!r})" if isinstance(robot, (str, os.PathLike)) else ""
        raise TypeError(f"compile takes a Robot, found {type(robot).__name__}{load}")
    return built(
        robot,
        functions,
        Path(directory) if directory is not None else store.cache(),
        backend,
        dtype=dtype,
        arch=arch,
        named_by_key=True,
        source={"model_sha256": digest(as_model(robot))},
    )


def digest(model: Model) -> str:
    """Return the SHA-256 of a model, the same in every process."""
    said = repr((replace(model, not_set=frozenset()), sorted(model.not_set)))
    return hashlib.sha256(said.encode()).hexdigest()


def built(
    robot: Robot | Model,
    functions: Sequence[Request],
    directory: Path,
    backend: str,
    *,
    dtype: Any,
    **options: Any,
) -> Kernel:
    """Return the kernel of a robot; ``options`` are those of ``build``. "generate" is timed too."""
    start = time.perf_counter()
    program = generate(robot, functions, dtype=dtype)
    timings = {"generate": time.perf_counter() - start}
    return build(program, directory, backend, timings=timings, **options)


def build(
    program: Program,
    directory: str | os.PathLike[str],
    backend: str = "c",
    *,
    arch: str = "native",
    named_by_key: bool = False,
    source: Mapping[str, Any] | None = None,
    timings: Mapping[str, float] | None = None,
) -> Kernel:
    """Return the kernel of a program in ``directory``, built anew only if another one is there.

    With ``named_by_key`` the kernel gets a folder of its own inside ``directory``. ``source`` says
    where the program came from (``{"file": ..., "sha256": ...}``) and is recorded in the manifest
    as "input". The kernel's ``timings`` are those given, and the seconds for "emit" and "compile".
    Everything is built in a folder beside ``directory`` and moved there when it is complete; what
    is there already and whole is opened without writing anything. A kernel for an ``arch`` that
    the processor at hand is not is built, and then ProcessorError says that it cannot be opened.
    """
    seconds = dict(timings or {})
    maker = backends.get(backend)  # whose import is not the program's time
    start = time.perf_counter()
    texts = sources(program, maker)
    seconds["emit"] = time.perf_counter() - start
    operations = sum(sum(routine.ops.values()) for routine in program.routines)
    compiler = maker.compiler(operations, arch)
    work = Work.of(maker, texts, compiler, _described(program, maker, texts, source))
    folder = Path(directory).absolute()
    if named_by_key:
        folder /= work.own_folder
    start = time.perf_counter()
    reused = is_there(folder, work, Kernel)
    seconds["compile"] = time.perf_counter() - start
    return Kernel(folder, reused=reused, timings=seconds)


def sources(program: Program, writer: Backend) -> dict[str, str]:
    """Return the texts of a kernel's files, by path. Raise ValueError for a name it cannot have."""
    check_names(program, {*dir(Kernel), *Kernel.__annotations__, *SYMBOLS}, writer.reserved)
    return writer.emit(program)


def check_names(program: Program, taken: Collection[str], reserved: Collection[str]) -> None:
    """Raise ValueError where the robot or a function has a name that generated code cannot have.

    ``taken`` are what every kernel or export has, ``reserved`` words of the code.
    """
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
    for name in (routine.function.name for routine in program.routines):
        if name in taken:
            raise ValueError(f"a function cannot be named {name!r}: every kernel has a {name}")
        if name in reserved:
            raise ValueError(f"a function cannot be named {name!r}: generated code uses that name")


def _described(
    program: Program,
    backend: Backend,
    texts: Mapping[str, str],
    source: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Return what a kernel's manifest says before it is known what the kernel is built with."""
    return {
        "format": store.FORMAT,
        "name": program.name,
        "dof": program.dof,
        "joint_kinds": list(program.joint_kinds),
        "joint_names": list(program.joint_names),
        "convention": program.convention,
        "gravity": None if program.gravity is None else list(program.gravity),
        "scalar": program.scalar,
        "backend": backend.name,
        "texts": store.hash_of(texts),
        "input": dict(source or {}),
        "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "versions": {
            "moro": moro.__version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "sympy": metadata.version("sympy"),
        },
        "parameters": [asdict(parameter) for parameter in program.parameters],
        "functions": [signature.as_json() for signature in program.signatures],
    }
