"""Libraries that would compute wrongly, or not at all: refused when built, and when opened."""

import os
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from arms import reference_model
from programs import affine, files

import moro_codegen as mc
from moro_codegen.backends import machines, processors
from moro_codegen.backends.toolchain import ProcessorError, ToolchainError, find_compiler
from moro_codegen.pipeline import build
from moro_codegen.program import generate

UNSAFE = [
    "-ffast-math",
    "-funsafe-math-optimizations",
    "-fassociative-math -fno-signed-zeros -fno-trapping-math",
    "-ffinite-math-only",
]
#: no macro tells of these options, as with older compilers
UNTOLD = "-U__FAST_MATH__ -U__ASSOCIATIVE_MATH__ -U__RECIPROCAL_MATH__ -U__FINITE_MATH_ONLY__"
#: the others leave the sines as they are in Clang
TOLD_BY_CLANG = ("-ffast-math", "-ffinite-math-only")
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]


def two_link(scalar):
    return replace(generate(reference_model("two_link")), scalar=scalar)


def right(kernel):
    """Whether sines are, also of angles that need all parts of pi/2."""
    q = np.random.default_rng(0).uniform(-9e2, 9e2, (100, 2))
    tau = kernel.tau(q, 0 * q, 0 * q)
    model = build(two_link("double"), kernel.directory.parent / "numpy", "numpy")
    size = 1e-13 if tau.dtype == np.float64 else 1e-3
    return np.abs(tau - model.tau(q.astype(tau.dtype), 0 * q, 0 * q)).max() < size * 50


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("options", UNSAFE)
@pytest.mark.parametrize("scalar", ["double", "float"])
def test_unsafe_arithmetic(tmp_path, monkeypatch, compiler, options, scalar):
    """Refused, unless the compiler leaves the sines right all the same."""
    monkeypatch.setenv("CC", f"{compiler} {options}")
    if compiler == "clang" and options not in TOLD_BY_CLANG:
        assert right(build(two_link(scalar), tmp_path / "arm"))
    else:
        with pytest.raises(ToolchainError, match="-ffast-math"):
            build(two_link(scalar), tmp_path / "arm")
        assert files(tmp_path) == []


@pytest.mark.skipif("gcc" not in COMPILERS, reason="needs GCC")
@pytest.mark.parametrize("scalar", ["double", "float"])
@pytest.mark.parametrize("options", UNSAFE[:3])
def test_unsafe_arithmetic_without_a_word(tmp_path, monkeypatch, options, scalar):
    monkeypatch.setenv("CC", f"gcc {options} {UNTOLD}")
    with pytest.raises(ToolchainError, match="computes wrongly: it was compiled with options that"):
        build(two_link(scalar), tmp_path / "arm")
    assert files(tmp_path) == []
    # what such a library does to arithmetic when it is loaded is undone
    assert np.spacing(np.float32(0)) > 0


@pytest.mark.parametrize("scalar", ["double", "float"])
def test_safe_arithmetic(tmp_path, monkeypatch, scalar):
    command = find_compiler().command[0]
    for options in ("", "-DMORO_PLAIN_C", "-march=x86-64", "-O0"):
        monkeypatch.setenv("CC", f"{command} {options}")
        kernel = build(two_link(scalar), tmp_path / "arm")
        assert right(kernel), options


def test_msvc_is_warned(tmp_path):
    kernel = build(affine(2), tmp_path / "arm")
    command = [*find_compiler().command, "-D_M_FP_FAST=1", "-E", kernel.source]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "fast-math" in done.stderr


def test_c_programs_ask_for_faults(tmp_path):
    kernel = build(affine(2), tmp_path / "arm")
    main = tmp_path / "main.c"
    main.write_text(
        '#include <stdio.h>\n#include "affine.h"\n'
        'int main(void) { const char *f = affine_fault(); puts(f ? f : "fine"); return 0; }\n'
    )
    command = [*find_compiler().command, "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    command += ["-I", kernel.directory, main, kernel.source, "-lm", "-o", tmp_path / "main"]
    subprocess.run(command, check=True)
    done = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True)
    assert done.stdout == "fine\n"


# -- processors --------------------------------------------------------------------------------


def x86():
    return os.uname().machine == "x86_64"


@pytest.mark.skipif(not x86(), reason="names of x86 processors")
def test_arch(tmp_path, monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    old = build(affine(2), tmp_path / "old", arch="x86-64")
    assert "-march=x86-64" in old.manifest["compiler"]["flags"]
    assert old.manifest["compiler"]["features"] == []
    assert np.array_equal(old.f([1, 2, 3]), [2, 4, 6])
    native = build(affine(2), tmp_path / "native")
    assert "-march=native" in native.manifest["compiler"]["flags"]
    assert native.manifest["key"] != old.manifest["key"]
    monkeypatch.setenv("CC", f"{find_compiler().command[0]} -march=x86-64-v2")
    own = build(affine(2), tmp_path / "own")
    assert not any(flag.startswith("-m") for flag in own.manifest["compiler"]["flags"])
    assert "sse4.2" in own.manifest["compiler"]["features"]
    assert "avx" not in own.manifest["compiler"]["features"]


@pytest.mark.parametrize("arch", ["pentium99", "x86-64 -O0", "", "-O2", None])
def test_an_arch_that_is_none(tmp_path, arch):
    with pytest.raises((ToolchainError, ValueError), match="arch"):
        build(affine(2), tmp_path / "arm", arch=arch)
    assert files(tmp_path) == []


def test_numpy_is_for_every_processor(tmp_path):
    with pytest.raises(ValueError, match="leave arch out"):
        build(affine(2), tmp_path / "arm", "numpy", arch="x86-64-v3")


@pytest.mark.skipif(not x86(), reason="asks for features of x86")
@pytest.mark.parametrize("backend", ["c", "cython"])
def test_a_kernel_for_another_processor(tmp_path, monkeypatch, backend):
    """It is built; what opens it hears what is missing, before a function can be called."""
    monkeypatch.setitem(processors.X86, "__SSE2__", "avx512er")  # of one processor, long gone
    for _ in range(2):
        with pytest.raises(ProcessorError, match="this processor lacks avx512er"):
            build(affine(2), tmp_path / "arm", backend)
    with pytest.raises(ProcessorError, match=r"Build the kernel again here, or with arch="):
        mc.Kernel(tmp_path / "arm")
    monkeypatch.setattr(machines, "own_kind", lambda: "AArch64 in ELF, 64 bits")
    here = "for x86-64 in ELF, 64 bits, and this is AArch64 in ELF, 64 bits"
    with pytest.raises(ProcessorError, match=f"another machine: {here}. Build the kernel again"):
        mc.Kernel(tmp_path / "arm")


def test_kinds_of_machines():
    """By their files' first bytes; what does not tell is left to the system's own loader."""
    elf = bytes([*b"\x7fELF", 2, 1, 1, *bytes(9), 3, 0, 183, 0])
    assert machines.kind_of(elf) == "AArch64 in ELF, 64 bits"
    big = bytes([*b"\x7fELF", 1, 2, 1, *bytes(9), 0, 3, 0, 20])
    assert machines.kind_of(big) == "machine 20 in ELF, 32 bits"
    mach_o = bytes.fromhex("cffaedfe 0c000001")
    assert machines.kind_of(mach_o) == "AArch64 under macOS"
    assert machines.kind_of(bytes.fromhex("cafebabe 00000002")) is None
    assert machines.kind_of(b"") is None
    own = machines.own_kind()
    assert own is None or os.uname().machine.replace("_", "-") in own.replace("AArch64", "aarch64")


# -- what shapes a build -----------------------------------------------------------------------


@pytest.mark.sweep
def test_cflags_shape_cython_kernels_and_their_key(tmp_path, monkeypatch):
    monkeypatch.delenv("CFLAGS", raising=False)
    plain = build(affine(2), tmp_path / "arm", "cython")
    monkeypatch.setenv("CFLAGS", "-DOTHER")
    other = build(affine(2), tmp_path / "arm", "cython")
    assert not other.reused
    assert other.manifest["key"] != plain.manifest["key"]
    assert other.manifest["compiler"]["CFLAGS"] == "-DOTHER"
    monkeypatch.setenv("CFLAGS", "-ffast-math")
    with pytest.raises(ToolchainError, match="-ffast-math"):
        build(affine(2), tmp_path / "arm", "cython")


# -- compilers that hang -----------------------------------------------------------------------


def test_a_compiler_that_hangs(tmp_path, monkeypatch, capsys):
    from moro_codegen import waiting

    script = tmp_path / "hangs"
    script.write_text('#!/bin/sh\ncase "$*" in *-dM*) exec cc "$@";; esac\nsleep 100 & wait\n')
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    monkeypatch.setenv("MORO_TIMEOUT", "2")
    monkeypatch.setattr(waiting, "PATIENCE", 0.1)
    with pytest.raises(ToolchainError, match=r"stopped after 2 s \(MORO_TIMEOUT\)"):
        build(affine(2), tmp_path / "build" / "arm")
    assert files(tmp_path / "build") == []
    assert "waiting for the compiler, hangs" in capsys.readouterr().err
