"""Finds a C compiler and builds shared libraries, in a process of its own.

The compiler is what the environment variable CC names; without CC the first of cc, gcc, clang that
is there.
"""

from __future__ import annotations

import hashlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from moro_codegen import waiting
from moro_codegen.backends.processors import FEATURES

CANDIDATES = ("cc", "gcc", "clang")

#: No -ffast-math: NaN, infinities and signed zeros keep their meaning. Packing scalars into vectors
#: after the fact makes calls slower: angles just written would be read before they have left the
#: store buffer.
FLAGS = ("-std=c99", "-O3", "-fno-math-errno", "-fno-tree-slp-vectorize", "-fPIC", "-shared")

#: A product and a sum become one operation, rounded once, in single calls and batches alike: Clang
#: sees to that within each expression of the source, GCC within each stretch without branches.
FUSED = {"clang": "-ffp-contract=on", "gcc": "-ffp-contract=fast"}

#: For long programs, after the other flags. Their functions have no loops and no two equal values,
#: so -O3 takes two and a half times as long for code that is as fast.
QUICK = {
    "clang": ("-O1",),
    "gcc": (
        "-O1", "-fexpensive-optimizations", "-fno-tree-fre", "-fno-tree-dominator-opts",
        "-fno-tree-dse", "-fno-dse",
    ),
}  # fmt: skip

#: a program of more operations is long
LONG = 6000

#: options that name a processor
TARGETS = ("-march=", "-mcpu=")

#: the exit status of a compiler that was stopped
STOPPED = 124

FALLBACK = 'Without a compiler, backend="numpy" gives the same functions, more slowly.'


class ToolchainError(RuntimeError):
    """No C compiler, or one that does not do what it must; says what was tried."""


class ProcessorError(ToolchainError):
    """A library for another processor than the one at hand."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler that works, with the flags that it gets."""

    command: tuple[str, ...]
    version: str
    flags: tuple[str, ...]
    #: hash of everything that it predefines: its version, the processor, the system
    target: str
    family: str
    #: what the code may ask of the processor, of those that differ: avx2, fma, ...
    features: tuple[str, ...]

    def quick(self) -> Compiler:
        """Return the same compiler with the flags for long programs."""
        return replace(self, flags=(*self.flags, *QUICK[self.family]))

    def as_json(self) -> dict[str, Any]:
        """Return what of it shapes a library."""
        return {
            "command": list(self.command),
            "version": self.version,
            "flags": list(self.flags),
            "target": self.target,
            "features": list(self.features),
        }


def compiler_for(operations: int, arch: str) -> Compiler:
    """Return the compiler, with flags for a program of so many operations."""
    compiler = find_compiler(arch)
    return compiler.quick() if operations > LONG else compiler


def find_compiler(arch: str = "native") -> Compiler:
    """Return the compiler to use. Raise ToolchainError if there is none that works.

    ``arch`` is the processor to compile for, as the compiler's -march calls it (``x86-64-v3``,
    ``znver3``, ``armv8.2-a``). "native" is the one at hand, unless CC names
    another by an option of its own.
    """
    if not re.fullmatch(r"[A-Za-z0-9][\w.+=-]*", str(arch)):
        raise ValueError(f"arch must be the name of a processor (x86-64-v3, native), not {arch!r}")
    if sys.platform == "win32":
        raise ToolchainError(f"kernels in C need Linux or macOS. {FALLBACK}")
    chosen = os.environ.get("CC", "").strip()
    tried = []
    try:
        candidates = [shlex.split(chosen)] if chosen else [[name] for name in CANDIDATES]
    except ValueError as error:
        raise ToolchainError(f"CC={chosen} is no command: {error}. {FALLBACK}") from None
    for command in candidates:
        if shutil.which(command[0]) is None:
            tried.append(f"{command[0]}: not found")
            continue
        if os.sep in command[0]:
            command[0] = str(Path(command[0]).absolute())
        compiler = _probe(command, arch)
        if isinstance(compiler, Compiler):
            return compiler
        tried.append(f"{shlex.join(command)}: {compiler}")
    of_whom = f"CC={chosen}, but it does not work" if chosen else "no C compiler works"
    if arch != "native":
        of_whom += f" for arch={arch!r}"
    raise ToolchainError(
        f"{of_whom}. Tried:\n  "
        + "\n  ".join(tried)
        + f"\nInstall one (gcc or clang), or name one in CC. {FALLBACK}"
    )


def build(compiler: Compiler, source: Path, library: Path) -> None:
    """Compile one C file into a shared library, with its folder as working directory."""
    command = [*compiler.command, *compiler.flags, "-o", library.name, source.name, "-lm"]
    done = run(command, source.parent)
    if done.returncode != 0 or not library.is_file():
        raise ToolchainError(
            f"{source.name} does not compile (exit status {done.returncode}):\n"
            f"  {shlex.join(command)}\n{words(done)}\n{FALLBACK}"
        )


def _probe(command: Sequence[str], arch: str) -> Compiler | str:
    """Ask a compiler for what it predefines; return what went wrong if it does not tell."""
    reason = ""
    targets = [f"-march={arch}"]
    if arch == "native":
        named = any(word.startswith(TARGETS) for word in command[1:])
        targets = [""] if named else [*(f"{option}native" for option in TARGETS), ""]
    for target in targets:
        flags = (*FLAGS, target) if target else FLAGS
        done = run([*command, *flags, "-dM", "-E", "-x", "c", os.devnull], None)
        version = re.search(r'^#define __VERSION__ "(.*)"$', done.stdout, re.MULTILINE)
        if done.returncode == 0 and version:
            is_clang = "#define __clang__ " in done.stdout
            family = "clang" if is_clang else "gcc"
            name = version[1] if is_clang else f"GCC {version[1]}"
            flags = (*flags, FUSED[family])
            predefined = hashlib.sha256(done.stdout.encode()).hexdigest()
            macros = set(re.findall(r"^#define (\w+)", done.stdout, re.MULTILINE))
            features = tuple(name for macro, name in FEATURES.items() if macro in macros)
            return Compiler(tuple(command), name, flags, predefined, family, features)
        reason = reason or f"exit status {done.returncode}\n{words(done)}"
        if done.returncode == STOPPED:
            break
    return reason


def run(
    command: Sequence[str], folder: Path | None, variables: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a compiler, with its folder as working directory and more environment variables.

    It is stopped, with whatever it started, after MORO_TIMEOUT seconds or when we are interrupted.
    """
    environment = {**os.environ, "LC_ALL": "C", **(variables or {})}
    limit = waiting.limit()
    try:
        process = subprocess.Popen(  # noqa: S603 - the user's own compiler
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True,
        )  # fmt: skip
    except OSError as error:
        return subprocess.CompletedProcess(command, 127, "", str(error))
    try:
        output, errors = _patiently(process, Path(command[0]).name, limit)
    except subprocess.TimeoutExpired:
        _stop(process)
        said = f"stopped after {limit:g} s ({waiting.VARIABLE})"
        return subprocess.CompletedProcess(command, STOPPED, "", said)
    except BaseException:
        _stop(process)
        raise
    return subprocess.CompletedProcess(command, process.returncode, output, errors)


def _patiently(process: subprocess.Popen[str], name: str, limit: float | None) -> tuple[str, str]:
    """Return what a process printed; say that it is being waited for if it takes long."""
    silent = waiting.until_said(limit)
    try:
        return process.communicate(timeout=silent)
    except subprocess.TimeoutExpired:
        left = None if limit is None else limit - silent
        if left == 0:
            raise
        waiting.say(f"waiting for the compiler, {name}")
        return process.communicate(timeout=left)


def _stop(process: subprocess.Popen[str]) -> None:
    """End a process and those that it started: first with the chance to clean up."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.communicate(timeout=1)


def words(done: subprocess.CompletedProcess[str]) -> str:
    """Return what a compiler said, indented."""
    said = (done.stderr.strip() or done.stdout.strip() or "(it said nothing)").splitlines()
    return "\n".join(f"  | {line}" for line in said[:40])
