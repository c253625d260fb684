"""Finding a compiler, and what is said when there is none or it fails."""

import os
import shutil
import stat
import sys
from pathlib import Path

import pytest

from moro_codegen.backends.toolchain import CANDIDATES, ToolchainError, build, find_compiler

GOOD = "double twice(double x);\ndouble twice(double x) { return 2 * x; }\n"


def script(path, text):
    """An executable shell script."""
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "twice.c"
    path.write_text(GOOD)
    return path


def test_the_first_of_the_usual_names(monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    compiler = find_compiler()
    assert compiler.command[0] == next(name for name in CANDIDATES if shutil.which(name))
    assert "GCC" in compiler.version or "lang" in compiler.version
    assert {"-march=native", "-mcpu=native"} & set(compiler.flags)
    assert "-ffast-math" not in compiler.flags


def test_cc_may_have_arguments(monkeypatch, source):
    name = find_compiler().command[0]
    monkeypatch.setenv("CC", f"{name} -DTHIRD=3")
    compiler = find_compiler()
    assert compiler.command == (name, "-DTHIRD=3")
    source.write_text(GOOD.replace("2", "THIRD"))
    build(compiler, source, source.with_suffix(".so"))
    assert source.with_suffix(".so").is_file()


def test_cc_may_be_a_path_relative_to_here(monkeypatch, tmp_path, source):
    real = shutil.which(find_compiler().command[0])
    script(tmp_path / "mine", f'exec {real} "$@"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CC", "./mine")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    build(find_compiler(), Path(shutil.copy(source, elsewhere)), elsewhere / "twice.so")


def test_cc_that_is_not_there(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(ToolchainError) as caught:
        find_compiler()
    said = str(caught.value)
    assert "CC=no-such-compiler -O2" in said
    assert "no-such-compiler: not found" in said
    assert 'backend="numpy"' in said


def test_cc_that_fails_is_not_passed_over(monkeypatch, tmp_path):
    broken = script(tmp_path / "broken", "echo 'licence expired' >&2\nexit 7")
    monkeypatch.setenv("CC", str(broken))
    with pytest.raises(ToolchainError) as caught:
        find_compiler()
    for words in (str(broken), "exit status 7", "| licence expired", 'backend="numpy"'):
        assert words in str(caught.value)


@pytest.mark.parametrize("text", ["exit 0", "echo hello"])
def test_cc_that_is_no_compiler(monkeypatch, tmp_path, text):
    monkeypatch.setenv("CC", str(script(tmp_path / "other", text)))
    with pytest.raises(ToolchainError, match="does not work"):
        find_compiler()


def test_cc_that_cannot_be_run(monkeypatch, tmp_path):
    path = tmp_path / "garbage"
    path.write_bytes(b"\x7fELF garbage")
    path.chmod(0o755)
    monkeypatch.setenv("CC", str(path))
    with pytest.raises(ToolchainError, match="does not work"):
        find_compiler()


@pytest.mark.parametrize("quoted", ['"unfinished', "   "])
def test_cc_that_makes_no_sense(monkeypatch, quoted):
    monkeypatch.setenv("CC", quoted)
    if quoted.strip():
        with pytest.raises(ToolchainError, match="CC="):
            find_compiler()
    else:
        assert find_compiler().command[0] in CANDIDATES


def test_no_compiler_at_all(monkeypatch, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ToolchainError) as caught:
        find_compiler()
    for words in ("cc: not found", "gcc: not found", "clang: not found", 'backend="numpy"'):
        assert words in str(caught.value)


def test_the_next_name_if_one_does_not_work(monkeypatch, tmp_path):
    real = find_compiler().command[0]
    monkeypatch.delenv("CC", raising=False)
    script(tmp_path / "cc", "exit 1")
    script(tmp_path / "gcc", f'exec {shutil.which(real)} "$@"')
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    assert find_compiler().command == ("gcc",)


def test_a_compiler_that_does_not_know_the_processor(monkeypatch, tmp_path, source):
    real = shutil.which(find_compiler().command[0])
    picky = (
        f'for a in "$@"; do case $a in -m*) echo "$a?" >&2; exit 1;; esac; done; exec {real} "$@"'
    )
    monkeypatch.setenv("CC", str(script(tmp_path / "picky", picky)))
    compiler = find_compiler()
    assert not any(flag.startswith("-m") for flag in compiler.flags)
    build(compiler, source, source.with_suffix(".so"))


def test_the_compilers_own_words(source):
    source.write_text("double twice(double x) { return 2 * y; }\n")
    with pytest.raises(ToolchainError) as caught:
        build(find_compiler(), source, source.with_suffix(".so"))
    said = str(caught.value)
    for words in ("twice.c does not compile", "-O3", "undeclared", 'backend="numpy"'):
        assert words in said
    assert not source.with_suffix(".so").exists()


def test_a_compiler_that_writes_nothing(monkeypatch, tmp_path, source):
    real = shutil.which(find_compiler().command[0])
    lazy = f'case "$*" in *-dM*) exec {real} "$@";; esac'
    monkeypatch.setenv("CC", str(script(tmp_path / "lazy", lazy)))
    with pytest.raises(ToolchainError, match=r"does not compile \(exit status 0\)"):
        build(find_compiler(), source, source.with_suffix(".so"))


def test_the_working_directory_stays(monkeypatch, tmp_path, source):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "inner"
    folder.mkdir()
    build(find_compiler(), Path(shutil.copy(source, folder)), folder / "twice.so")
    assert Path.cwd() == tmp_path
    assert sorted(path.name for path in tmp_path.iterdir()) == ["inner", "twice.c"]


def test_other_systems(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(ToolchainError, match=r'need Linux or macOS.*backend="numpy"'):
        find_compiler()
