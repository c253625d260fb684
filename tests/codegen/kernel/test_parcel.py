"""Kernels that go to other processes and machines: opened where they are, else built there once."""

import pickle
import platform
import shutil
import subprocess
import sys

import numpy as np
import pytest
from exports import two_link

import moro_codegen as mc
from moro_codegen import Kernel
from moro_codegen.backends.toolchain import ProcessorError
from moro_codegen.kernel import store
from moro_codegen.kernel.store import DamagedError

X = np.random.default_rng(0).normal(size=(3, 9, 2))


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return mc.compile(two_link(), directory=tmp_path_factory.mktemp("built"))


@pytest.fixture
def kernel(built, tmp_path):
    """A kernel whose folder may go."""
    shutil.copytree(built.directory, tmp_path / "two_link")
    return Kernel(tmp_path / "two_link")


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "cache"))
    return store.cache()


def received(sent):
    return pickle.loads(sent)  # noqa: S301


def test_it_is_opened_where_it_is(kernel, cache):
    again = received(pickle.dumps(kernel))
    assert again.directory == kernel.directory
    assert not cache.exists()
    shutil.rmtree(kernel.directory)
    assert np.array_equal(received(pickle.dumps(again.tau))(*X), kernel.tau(*X))  # sent on


def test_elsewhere_it_is_built_of_its_texts(kernel, cache):
    sent, function = pickle.dumps(kernel), pickle.dumps(kernel.tau)
    shutil.rmtree(kernel.directory)
    again = received(sent)
    assert again.directory.parent == cache
    assert np.array_equal(again.tau(*X), kernel.tau(*X))
    assert np.array_equal(received(function)(*X), kernel.tau(*X))
    assert again.manifest["input"] == kernel.manifest["input"]
    shutil.rmtree(again.directory)
    assert np.array_equal(received(function)(*X), kernel.tau(*X))  # is known in this process


def test_a_module_goes_the_same_way(tmp_path, cache):
    kernel = mc.compile(two_link(payload=0.5), directory=tmp_path / "module", backend="numpy")
    sent, expected = pickle.dumps(kernel.tau), kernel.tau(*X)
    shutil.rmtree(kernel.directory)
    assert np.array_equal(received(sent)(*X), expected)
    assert len(list(cache.glob("two_link-*"))) == 1


def test_processes_of_a_machine_build_it_once(kernel, tmp_path, monkeypatch):
    (tmp_path / "cc").write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/log\nexec cc "$@"\n')
    (tmp_path / "cc").chmod(0o755)
    monkeypatch.setenv("CC", str(tmp_path / "cc"))
    (tmp_path / "sent").write_bytes(pickle.dumps(kernel.tau))
    shutil.rmtree(kernel.directory)
    code = "import pickle; print(pickle.load(open('sent', 'rb'))([0, 0], [0, 0], [0, 0]).tolist())"
    both = [
        subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    printed = [process.communicate()[0].decode().strip() for process in both]
    assert printed == [str(kernel.tau([0, 0], [0, 0], [0, 0]).tolist())] * 2
    assert sum("two_link.c" in line for line in (tmp_path / "log").read_text().splitlines()) == 1


def test_another_kernel_in_its_place(kernel, cache):
    sent, expected = pickle.dumps(kernel.tau), kernel.tau(*X)
    program = mc.generate(two_link(payload=0.5))
    mc.build(program, kernel.directory, "numpy")
    assert np.array_equal(received(sent)(*X), expected)


def test_on_another_processor(kernel, cache):
    def opened(folder):
        if folder == kernel.directory:
            raise ProcessorError("made for another")
        return Kernel(folder)

    parcel = received(pickle.dumps(kernel._parcel))
    assert parcel.opened(opened).directory.parent == cache


@pytest.mark.skipif(platform.machine() != "x86_64", reason="x86-64 is no processor here")
def test_a_processor_that_was_named_stays(tmp_path):
    kernel = mc.build(mc.generate(two_link()), tmp_path / "old", arch="x86-64")
    sent = pickle.dumps(kernel)
    shutil.rmtree(kernel.directory)
    assert "-march=x86-64" in received(sent).manifest["compiler"]["flags"]


def test_where_it_cannot_be_built(kernel, monkeypatch):
    sent = pickle.dumps(kernel)
    shutil.rmtree(kernel.directory)
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(mc.ToolchainError, match=r"two_link is not in .*, and cannot be built here"):
        received(sent)
    monkeypatch.setattr(store, "FORMAT", store.FORMAT + 1)
    with pytest.raises(ValueError, match="two_link was sent by another version of moro"):
        received(sent)


def test_what_is_gone_cannot_be_sent(kernel):
    shutil.rmtree(kernel.directory)
    with pytest.raises(DamagedError, match=r"two_link.c is missing"):
        pickle.dumps(kernel.tau)
