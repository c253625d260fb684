"""Folders of kernels: what is wrong in one is noticed, and one is opened whole or not at all."""

import json
import multiprocessing
import os
import random
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock
from flips import flipped
from programs import affine, everything_program, files

import moro as mr
import moro_codegen as mc
from moro_codegen import waiting
from moro_codegen.kernel import store
from moro_codegen.pipeline import build


@pytest.fixture(scope="module", params=["c", "numpy"])
def arm(request, tmp_path_factory):
    """A kernel with parameters and defaults, of each backend."""
    folder = tmp_path_factory.mktemp("store") / "arm"
    build(everything_program(), folder, request.param)
    return folder


# -- what is believed --------------------------------------------------------------------------


def test_every_flipped_bit_of_a_manifest_is_noticed(arm):
    path = arm / "manifest.json"
    content = path.read_bytes()
    manifest = store.read_manifest(arm)
    sample = random.Random(0).sample(range(8 * len(content)), 300)
    try:
        for bit in sample:
            path.write_bytes(flipped(content, bit))
            with pytest.raises(ValueError, match="arm"):
                store.read_manifest(arm)
            assert not store.is_current(arm, manifest)
    finally:
        path.write_bytes(content)


def test_flipped_bits_of_what_is_run_are_noticed(arm):
    kernel = mc.Kernel(arm)
    path = kernel.library or kernel.source
    content = path.read_bytes()
    for bit in random.Random(0).sample(range(8 * len(content)), 3):
        path.with_suffix(".new").write_bytes(flipped(content, bit))
        path.with_suffix(".new").replace(path)
        with pytest.raises(ValueError, match=rf"{path.name} is not the file .* Build it again"):
            mc.Kernel(arm)
    path.with_suffix(".new").write_bytes(content)
    path.with_suffix(".new").replace(path)
    assert mc.Kernel(arm).parameters == kernel.parameters


@pytest.mark.parametrize("content", ["", "[]", "null", "3", "{}", '{"format": 2}', "[" * 10**5])
def test_a_manifest_that_is_none(tmp_path, content):
    build(affine(2), tmp_path / "arm", "numpy")
    (tmp_path / "arm" / "manifest.json").write_text(content)
    with pytest.raises(ValueError, match=r"manifest.json") as caught:
        mc.Kernel(tmp_path / "arm")
    assert str(tmp_path / "arm") in str(caught.value)
    assert not build(affine(2), tmp_path / "arm", "numpy").reused


def forged(folder, change):
    """Change a manifest and make its own hashes right again."""
    manifest = json.loads((folder / "manifest.json").read_text())
    change(manifest)
    manifest["key"] = store.key_of(manifest)
    store.write_manifest(folder, manifest)
    assert store.read_manifest(folder)["key"] == manifest["key"]


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize(
    "change",
    [
        lambda m: m["parameters"][0].update(default=4.5),
        lambda m: m["functions"][0]["parameters"][0].update(default=4.5),
        lambda m: m["functions"][0]["outputs"][0].update(shape=[1, 1]),
        lambda m: m["functions"].clear(),
    ],
)
def test_the_library_says_what_its_interface_is(tmp_path, backend, change):
    build(everything_program(), tmp_path / "arm", backend)
    forged(tmp_path / "arm", change)
    with pytest.raises(ValueError, match=r"is of another kernel than manifest\.json describes"):
        mc.Kernel(tmp_path / "arm")
    assert not build(everything_program(), tmp_path / "arm", backend).reused
    assert mc.Kernel(tmp_path / "arm").parameters == {"mass": 2.5, "offset": None}


def test_the_cython_library_says_so_too(tmp_path):
    build(affine(2), tmp_path / "arm", "cython")
    forged(tmp_path / "arm", lambda m: m["functions"][0]["outputs"][0].update(shape=[1]))
    with pytest.raises(ValueError, match="is of another kernel"):
        mc.Kernel(tmp_path / "arm")


# -- beside rebuilds ---------------------------------------------------------------------------


def rebuild(folder, programs, stop):
    k = 0
    while not stop.is_set():
        k += 1
        build(programs[k % len(programs)], folder, ("c", "numpy")[k // 8 % 2])


def test_opening_beside_rebuilds(tmp_path):
    """Whatever is opened is one kernel: what it computes and what it says belong together."""
    programs = [affine(factor) for factor in (2, 3)]
    folder = tmp_path / "arm"
    texts = {
        build(program, folder, backend).manifest["texts"]: factor
        for program, factor in zip(programs, (2, 3), strict=True)
        for backend in ("c", "numpy")
    }
    stop = multiprocessing.get_context("fork").Event()
    builder = multiprocessing.get_context("fork").Process(
        target=rebuild, args=(folder, programs, stop)
    )
    builder.start()
    try:
        for _ in range(600):
            kernel = mc.Kernel(folder)
            assert kernel.f(np.ones(3))[0] == texts[kernel.manifest["texts"]]
    finally:
        stop.set()
        builder.join()
    assert builder.exitcode == 0


# -- what is written ---------------------------------------------------------------------------


def everything_in(folder):
    return {p: (p.stat().st_mtime_ns, p.stat().st_ino) for p in [folder, *folder.rglob("*")]}


def test_a_current_kernel_is_opened_without_writing(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    build(affine(2), folder / "arm", source={"sha256": "a"})
    (folder / ".arm.lock").unlink(missing_ok=True)
    before = everything_in(folder)
    assert build(affine(2), folder / "arm", source={"sha256": "a"}).reused
    assert everything_in(folder) == before

    def read_only(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(store, "_acquire", lambda held, folder: read_only(folder))
    kernel = build(affine(2), folder / "arm", source={"sha256": "b"})
    assert kernel.reused
    assert kernel.manifest["input"] == {"sha256": "a"}
    with pytest.raises(PermissionError, match=r"Permission denied\. Name another .* directory="):
        build(affine(3), folder / "arm")


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_cache_that_cannot_be(tmp_path, monkeypatch, backend):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setenv("HOME", str(tmp_path / "file"))
    with pytest.raises(OSError, match=r"kernel cannot be kept in .*file.* directory="):
        mc.compile(mr.load("two_link"), backend=backend)


def test_no_home(monkeypatch):
    monkeypatch.setattr(store, "user_cache_path", lambda name: Path("~/.cache") / name)
    with pytest.raises(OSError, match=r"no home folder. Name another folder with directory="):
        mc.compile(mr.load("two_link"))


@contextmanager
def locked(folder):
    """Hold a folder's lock, as another process would."""
    held, done = threading.Event(), threading.Event()

    def hold():
        with FileLock(folder.with_name(f".{folder.name}.lock")):
            held.set()
            done.wait()

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait()
    try:
        yield done.set
    finally:
        done.set()
        thread.join()


def test_what_a_killed_builder_left_is_removed(tmp_path):
    for name in ("arm", "other"):
        (tmp_path / f".{name}.moro-new" / name).mkdir(parents=True)
        (tmp_path / f".{name}.lock").write_text("")
    (tmp_path / ".mine.moro-new").mkdir()  # was never a builder's: it has no lock
    with locked(tmp_path / "busy"):
        (tmp_path / ".busy.moro-new").mkdir()
        build(affine(2), tmp_path / "arm", "numpy")
        assert files(tmp_path) == [".busy.moro-new", ".mine.moro-new", "arm"]


def test_a_killed_builder(tmp_path):
    """Its compiler hangs; the next one finds its lock free, and nothing of it afterwards."""
    script = tmp_path / "hangs"
    script.write_text(
        "#!/bin/sh\n"
        f'case "$*" in *-dM*) exec cc "$@";; esac\n'
        f"echo $$ > {tmp_path}/pid; exec sleep 100\n"
    )
    script.chmod(0o755)
    code = (
        "import sys, moro as mr, moro_codegen as mc\n"
        "mc.compile(mr.load('two_link'), directory=sys.argv[1])\n"
    )
    folder = tmp_path / "cache"
    builder = subprocess.Popen(
        [sys.executable, "-c", code, str(folder)], env={**os.environ, "CC": str(script)},
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert "waiting for the compiler, hangs" in builder.stderr.readline()
    (left,) = folder.glob(".*.moro-new")
    builder.kill()
    builder.wait()
    builder.stderr.close()
    os.kill(int((tmp_path / "pid").read_text()), 15)
    assert left.is_dir()
    kernel = mc.compile(mr.load("two_link"), directory=folder)
    assert files(folder) == [kernel.directory.name]


# -- waiting -----------------------------------------------------------------------------------


def test_waiting_for_another_process(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(waiting, "PATIENCE", 0.05)
    monkeypatch.setenv("MORO_TIMEOUT", "0.2")
    with (
        locked(tmp_path / "arm"),
        pytest.raises(TimeoutError, match=r"another process .* for 0.2 s \(MORO_TIMEOUT\)"),
    ):
        build(affine(2), tmp_path / "arm", "numpy")
    assert "waiting for another process, which is building" in capsys.readouterr().err
    monkeypatch.delenv("MORO_TIMEOUT")
    with locked(tmp_path / "arm") as release:
        threading.Timer(0.3, release).start()
        assert build(affine(2), tmp_path / "arm", "numpy").f([1, 1, 1])[0] == 2
    assert "waiting for another process" in capsys.readouterr().err


@pytest.mark.parametrize("given", ["soon", "-1", "0", "nan"])
def test_a_limit_that_is_none(tmp_path, monkeypatch, given):
    monkeypatch.setenv("MORO_TIMEOUT", given)
    with pytest.raises(ValueError, match=f"MORO_TIMEOUT must be a positive .* '{given}'"):
        build(affine(2), tmp_path / "arm")
    assert files(tmp_path) == []


# -- clearing ----------------------------------------------------------------------------------


def test_clearing(tmp_path):
    kernels = [
        mc.compile(mr.load("two_link"), directory=tmp_path, backend=b) for b in ("c", "numpy")
    ]
    (tmp_path / "mine-0123").mkdir()
    with locked(kernels[1].directory):
        count, freed = store.clear(tmp_path)
    assert count == 1
    assert freed > 1000
    assert files(tmp_path) == ["mine-0123", kernels[1].directory.name]
    assert store.clear(tmp_path)[0] == 1
    assert store.clear(tmp_path / "nothing") == (0, 0)


def test_the_command_clears_the_cache(tmp_path, monkeypatch):
    from click.testing import CliRunner

    from moro_codegen.cli import main

    monkeypatch.setattr(store, "user_cache_path", lambda name: tmp_path / name)
    mc.compile(mr.load("two_link"), backend="numpy")
    done = CliRunner().invoke(main, ["--clear-cache"])
    assert done.exit_code == 0
    assert f"{tmp_path / 'moro' / 'kernels'}: 1 kernels removed" in done.output
    assert files(tmp_path / "moro" / "kernels") == []
