"""Cython extensions: built from a folder of sources in a process of its own, and loaded."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
import sysconfig
from functools import cache
from importlib import metadata
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from moro_codegen.backends.toolchain import FALLBACK, Compiler, ToolchainError, run, words

#: what the build needs, by the name of the package on PyPI
NEEDED = {"cython": "Cython", "setuptools": "setuptools"}

#: variables of the environment that setuptools and the compiler heed
VARIABLES = (
    "CFLAGS", "CPPFLAGS", "LDFLAGS", "LDSHARED", "ARCHFLAGS", "CPATH", "C_INCLUDE_PATH",
    "LIBRARY_PATH", "MACOSX_DEPLOYMENT_TARGET", "SDKROOT",
)  # fmt: skip


def tools() -> dict[str, str]:
    """Return the versions of what extensions are built with, and the variables that shape them.

    Raise ToolchainError that names what is not installed.
    """
    missing = [name for name, module in NEEDED.items() if find_spec(module) is None]
    if missing:
        raise ToolchainError(
            f"the Cython backend needs {' and '.join(missing)}: pip install {' '.join(missing)}. "
            'backend="c" needs only a C compiler.'
        )
    versions = {name: metadata.version(name) for name in NEEDED}
    variables = {name: os.environ[name] for name in VARIABLES if os.environ.get(name)}
    return {**versions, "suffix": str(sysconfig.get_config_var("EXT_SUFFIX")), **variables}


def build(compiler: Compiler, folder: Path, package: str) -> None:
    """Build ``package.functions`` in the folder that holds the package and its setup.py."""
    # -std would keep Python's headers from what they need; the rest setuptools sees to itself
    flags = [flag for flag in compiler.flags if flag not in ("-std=c99", "-fPIC", "-shared")]
    command = [sys.executable, "setup.py", "--quiet", "build_ext", "--inplace"]
    environment = {"CC": shlex.join(compiler.command), "MORO_CFLAGS": " ".join(flags)}
    done = run(command, folder, environment)
    inside = folder / package
    if done.returncode != 0 or not _libraries(inside):
        raise ToolchainError(
            f"{package}/functions.pyx does not compile (exit status {done.returncode}):\n"
            f"  {shlex.join(command[1:])}\n{words(done)}\n{FALLBACK}"
        )
    (inside / "functions.c").unlink(missing_ok=True)
    shutil.rmtree(folder / "build", ignore_errors=True)


def library(package: Path) -> Path:
    """Return the path of the extension in a package's folder."""
    found = _libraries(package)
    if not found:
        raise FileNotFoundError(f"{package} holds no extension for this Python")
    return found[0]


def load(path: Path) -> ModuleType:
    """Return the extension at a path, as a module that ``import`` does not know of."""
    status = path.stat()
    return _load(path, (status.st_dev, status.st_ino, status.st_mtime_ns, status.st_size))


@cache
def _load(path: Path, file: tuple[int, ...]) -> ModuleType:
    known = _LOADED.get(file)
    if known is None:
        name = f"{path.parent.name}.functions"
        spec = spec_from_file_location(name, path, loader=ExtensionFileLoader(name, str(path)))
        assert spec is not None  # noqa: S101
        assert spec.loader is not None  # noqa: S101
        try:
            known = module_from_spec(spec)
            spec.loader.exec_module(known)
        except ImportError as error:
            raise ToolchainError(f"the extension cannot be loaded: {error}\n{FALLBACK}") from None
        _LOADED[file] = known
    return known


#: an extension may be loaded once in a process, wherever its file has been moved
_LOADED: dict[tuple[int, ...], ModuleType] = {}


def _libraries(package: Path) -> list[Path]:
    names = (f"functions{suffix}" for suffix in EXTENSION_SUFFIXES)
    return [package / name for name in names if (package / name).is_file()]
