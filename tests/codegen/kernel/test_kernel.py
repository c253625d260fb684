"""Kernels on disk: built once, whole or not at all, known by everything that shapes them."""

import json
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from arms import reference_model, reference_states
from programs import affine, everything_program, files

import moro as mr
import moro_codegen as mc
from moro_codegen.backends.toolchain import ToolchainError, find_compiler
from moro_codegen.kernel.store import FORMAT
from moro_codegen.pipeline import build
from moro_codegen.program import generate


def count_compilations(monkeypatch):
    """Return a list that grows with every compilation."""
    from moro_codegen.backends import toolchain

    done = []
    real = toolchain.build
    monkeypatch.setattr(toolchain, "build", lambda *a: (done.append(a), real(*a)))
    return done


# -- compile -----------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_compile(tmp_path, backend):
    robot = mr.load("two_link")
    kernel = mc.compile(robot, directory=tmp_path, backend=backend)
    assert (kernel.name, kernel.dof, kernel.backend) == ("two_link", 2, backend)
    for s in reference_states("two_link"):
        tau = kernel.tau(s["q"], s["qd"], s["qdd"])
        assert np.abs(tau - s["tau"]).max() < 1e-12 * np.abs(s["tau"]).max()
    assert kernel.ops["tau"]["sincos"] == 2
    assert kernel.parameters == {}
    assert kernel.directory.parent == tmp_path
    assert set(kernel.timings) == {"generate", "emit", "compile"}
    assert not kernel.reused
    again = mc.compile(robot, directory=tmp_path, backend=backend)
    assert again.reused
    assert again.directory == kernel.directory


def test_compile_uses_the_users_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    kernel = mc.compile(mr.load("two_link"))
    assert kernel.directory.is_relative_to(tmp_path)
    assert mc.compile(mr.load("two_link")).reused


def test_parameters_of_a_robot(tmp_path):
    """Free symbols are run-time parameters, with the defaults that the robot gives them."""
    import sympy as sp

    from moro.abc import q1

    m, l = sp.symbols("m l", real=True)
    robot = mr.Robot((l, 0, 0, q1), name="pendulum")
    robot.masses = [m]
    robot.cm_positions = [[0, 0, 0]]
    robot.inertia_tensors = [sp.zeros(3)]
    robot.gravity = [0, -sp.Rational("9.81"), 0]
    robot.parameters = {m: sp.Rational("0.5"), l: None}
    kernel = mc.compile(robot, directory=tmp_path)
    assert kernel.parameters == {"m": 0.5, "l": None}
    q, qd, qdd = np.array([0.3]), np.array([0.7]), np.array([-1.1])
    tau = kernel.tau(q, qd, qdd, parameters={"l": 2.0})
    assert tau[0] == pytest.approx(0.5 * 4 * -1.1 + 0.5 * 9.81 * 2 * np.cos(0.3), rel=1e-14)
    with pytest.raises(TypeError, match="no default for l"):
        kernel.tau(q, qd, qdd)


def test_what_cannot_be_compiled(tmp_path):
    robot = mr.load("two_link")
    with pytest.raises(ValueError, match='backend must be "c", "cython" or "numpy"'):
        mc.compile(robot, directory=tmp_path, backend="fortran")
    robot.name = "my arm"
    with pytest.raises(ValueError, match="'my arm' cannot name functions"):
        mc.compile(robot, directory=tmp_path)
    assert files(tmp_path) == []


# -- what a kernel says ------------------------------------------------------------------------


def test_files_and_manifest(tmp_path):
    source = {"file": "arm.yaml", "sha256": "0" * 64}
    kernel = build(everything_program(), tmp_path / "arm", source=source)
    assert files(tmp_path) == ["arm"]
    assert files(tmp_path / "arm") == ["all_ops.c", "all_ops.h", "liball_ops.so", "manifest.json"]
    assert kernel.library == tmp_path / "arm" / "liball_ops.so"
    assert kernel.source == tmp_path / "arm" / "all_ops.c"
    assert kernel.header == tmp_path / "arm" / "all_ops.h"
    manifest = json.loads((tmp_path / "arm" / "manifest.json").read_text())
    assert manifest == kernel.manifest
    assert manifest["input"] == source
    assert manifest["parameters"] == [
        {"name": "mass", "default": 2.5, "description": ""},
        {"name": "offset", "default": None, "description": ""},
    ]
    (function,) = manifest["functions"]
    assert [a["name"] for a in function["inputs"]] == ["q", "qd", "parameters"]
    assert function["outputs"][0] == {
        "name": "M", "shape": [2, 3], "unit": "kg m^2", "description": "a matrix",
    }  # fmt: skip
    assert function["ops"] == kernel.ops["everything"]
    compiler = find_compiler()
    assert manifest["compiler"]["version"] == compiler.version
    assert manifest["compiler"]["flags"] == list(compiler.flags)
    assert set(manifest["versions"]) == {"moro", "python", "numpy", "sympy"}
    assert set(manifest["files"]) == {"all_ops.c", "all_ops.h", "liball_ops.so"}


def test_files_without_a_compiler(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    kernel = build(affine(2), tmp_path / "arm", "numpy")
    assert files(tmp_path / "arm") == ["affine.py", "manifest.json"]
    assert kernel.library is None
    assert kernel.header is None
    assert kernel.source == tmp_path / "arm" / "affine.py"
    assert kernel.manifest["compiler"] is None
    assert np.array_equal(kernel.f([1, 2, 3]), [2, 4, 6])


def test_repr_and_names(tmp_path):
    kernel = build(everything_program(), tmp_path / "arm")
    assert repr(kernel).startswith("<Kernel all_ops: 3 joints, everything (")
    assert "parameters mass, offset" in repr(kernel)
    assert str(kernel.library) in repr(kernel)
    assert dir(kernel).count("everything") == 1
    with pytest.raises(AttributeError, match="no 'tau'; its functions are: everything"):
        kernel.tau  # noqa: B018


def test_opening_a_kernel(tmp_path):
    build(affine(2), tmp_path / "arm")
    kernel = mc.Kernel(tmp_path / "arm")
    assert np.array_equal(kernel.f([1, 2, 3]), [2, 4, 6])
    with pytest.raises(FileNotFoundError):
        mc.Kernel(tmp_path / "other")
    manifest = tmp_path / "arm" / "manifest.json"
    manifest.write_text(manifest.read_text().replace(f'"format": {FORMAT}', '"format": 0'))
    with pytest.raises(ValueError, match="another version"):
        mc.Kernel(tmp_path / "arm")


def test_opening_a_kernel_by_a_relative_path(tmp_path, monkeypatch):
    build(affine(2), tmp_path / "arm")
    monkeypatch.chdir(tmp_path)
    kernel = mc.Kernel("arm")
    monkeypatch.chdir("/")
    assert np.array_equal(kernel.f([1, 2, 3]), [2, 4, 6])
    assert kernel.source.is_file()


# -- built once --------------------------------------------------------------------------------


def test_built_once(tmp_path, monkeypatch):
    done = count_compilations(monkeypatch)
    first = build(affine(2), tmp_path / "arm")
    second = build(affine(2), tmp_path / "arm")
    assert (first.reused, second.reused, len(done)) == (False, True, 1)
    assert second.manifest["created"] == first.manifest["created"]


def test_built_again_when_something_that_shapes_it_changes(tmp_path, monkeypatch):
    done = count_compilations(monkeypatch)
    folder = tmp_path / "arm"
    build(affine(2), folder)
    build(affine(3), folder)
    assert len(done) == 2
    monkeypatch.setenv("CC", f"{find_compiler().command[0]} -DOTHER")
    build(affine(3), folder)
    assert len(done) == 3
    monkeypatch.delenv("CC")
    build(affine(3), folder, "numpy")
    assert files(folder) == ["affine.py", "manifest.json"]
    build(affine(3), folder)
    assert files(folder) == ["affine.c", "affine.h", "libaffine.so", "manifest.json"]
    assert len(done) == 4


@pytest.mark.parametrize("name", ["libaffine.so", "affine.c", "manifest.json"])
@pytest.mark.parametrize("damage", [b"", b"{}", None])
def test_built_again_when_a_file_is_damaged_or_missing(tmp_path, name, damage):
    folder = tmp_path / "arm"
    build(affine(2), folder)
    (folder / name).unlink()
    if damage is not None:
        (folder / name).write_bytes(damage)
    kernel = build(affine(2), folder)
    assert not kernel.reused
    assert np.array_equal(kernel.f([1, 2, 3]), [2, 4, 6])


def test_the_input_is_recorded_even_if_the_kernel_is_there(tmp_path):
    build(affine(2), tmp_path / "arm", source={"sha256": "a"})
    kernel = build(affine(2), tmp_path / "arm", source={"sha256": "b"})
    assert kernel.reused
    assert kernel.manifest["input"] == {"sha256": "b"}
    assert files(tmp_path / "arm") == ["affine.c", "affine.h", "libaffine.so", "manifest.json"]


def test_a_rebuilt_library_is_the_new_one(tmp_path):
    """In the same process, at the same path, the old one still in use."""
    kernels = [build(affine(factor), tmp_path / "arm") for factor in (2, 3, 5)]
    assert len({kernel.library for kernel in kernels}) == 1
    for kernel, factor in zip(kernels, (2, 3, 5), strict=True):
        assert np.array_equal(kernel.f(np.ones(3)), np.full(3, factor))
        assert np.array_equal(kernel.f(np.ones((9, 3))), np.full((9, 3), factor))
    assert np.array_equal(mc.Kernel(tmp_path / "arm").f(np.ones(3)), np.full(3, 5))


def test_other_files_of_the_folder_stay(tmp_path):
    folder = tmp_path / "arm"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    build(affine(2), folder)
    build(affine(3), folder)
    assert (folder / "notes.txt").read_text() == "mine"


# -- whole or not at all -----------------------------------------------------------------------


@pytest.fixture
def broken_compiler(tmp_path_factory, monkeypatch):
    """A compiler that introduces itself, and then writes half a library and fails."""
    path = tmp_path_factory.mktemp("broken") / "cc"
    real = shutil.which(find_compiler().command[0])
    path.write_text(
        "#!/bin/sh\n"
        f'case "$*" in *-dM*) exec {real} "$@";; esac\n'
        "echo half > libaffine.so\necho 'internal error: out of ideas' >&2\nexit 4\n"
    )
    path.chmod(0o755)
    monkeypatch.setenv("CC", str(path))


@pytest.mark.usefixtures("broken_compiler")
def test_nothing_is_left_when_the_compiler_fails(tmp_path):
    with pytest.raises(ToolchainError, match="out of ideas"):
        build(affine(2), tmp_path / "arm")
    assert files(tmp_path) == []


def test_the_old_kernel_stays_when_the_compiler_fails(tmp_path, request):
    old = build(affine(2), tmp_path / "arm")
    request.getfixturevalue("broken_compiler")
    with pytest.raises(ToolchainError, match="out of ideas"):
        build(affine(3), tmp_path / "arm")
    assert mc.Kernel(tmp_path / "arm").manifest == old.manifest
    assert np.array_equal(mc.Kernel(tmp_path / "arm").f(np.ones(3)), np.full(3, 2))


def test_a_library_that_cannot_be_loaded(tmp_path, monkeypatch):
    real = shutil.which(find_compiler().command[0])
    path = tmp_path / "cross"
    path.write_text(
        "#!/bin/sh\n"
        f'case "$*" in *-dM*) exec {real} "$@";; esac\n'
        "echo 'for another machine' > libaffine.so\n"
    )
    path.chmod(0o755)
    monkeypatch.setenv("CC", str(path))
    with pytest.raises(ToolchainError, match=r'cannot be loaded(.|\n)*backend="numpy"'):
        build(affine(2), tmp_path / "build" / "arm")
    assert files(tmp_path / "build") == []


def test_no_compiler(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(ToolchainError, match="no-such-compiler: not found"):
        build(affine(2), tmp_path / "arm")
    assert files(tmp_path) == []


def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        build(affine(2), tmp_path / "file" / "arm")
    (tmp_path / "arm").write_text("in the way")
    with pytest.raises(OSError, match="arm"):
        build(affine(2), tmp_path / "arm")
    assert files(tmp_path) == ["arm", "file"]
    assert (tmp_path / "arm").read_text() == "in the way"


def test_two_threads_build_one_kernel(tmp_path, monkeypatch):
    done = count_compilations(monkeypatch)
    kernels = []

    def work():
        kernels.append(build(affine(2), tmp_path / "arm"))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(kernels) == 4
    assert len(done) == 1
    assert files(tmp_path) == ["arm"]


def test_two_processes_build_one_kernel(tmp_path):
    code = (
        "import sys, moro as mr, moro_codegen as mc\n"
        "kernel = mc.compile(mr.load('two_link'), directory=sys.argv[1])\n"
        "print(kernel.reused, kernel.tau([1, 2], [0, 0], [0, 0])[0])\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    processes = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    printed = [process.communicate()[0].split() for process in processes]
    assert sorted(p[0] for p in printed) == ["False", "True"]
    assert printed[0][1] == printed[1][1]
    assert len(files(tmp_path)) == 1


def test_the_environment_of_the_process_stays(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path, environment = list(sys.path), dict(os.environ)
    build(affine(2), "arm")
    assert Path.cwd() == tmp_path
    assert sys.path == path
    assert dict(os.environ) == environment
    assert files(tmp_path) == ["arm"]


# -- the NumPy backend -------------------------------------------------------------------------


def test_numpy_in_chunks(tmp_path, monkeypatch):
    """Many samples go through in parts, whatever is broadcast and wherever results go."""
    from moro_codegen import calls

    kernel = build(generate(reference_model("two_link")), tmp_path / "arm", "numpy")
    rng = np.random.default_rng(1)
    q, qd = rng.uniform(-1, 1, (13, 1, 2)), rng.uniform(-1, 1, (7, 2))
    qdd = np.zeros(2)
    expected = kernel.tau(q, qd, qdd)
    monkeypatch.setattr(calls, "CHUNK", 10)
    assert np.array_equal(kernel.tau(q, qd, qdd), expected)
    out = np.empty((2, 7, 13)).T
    kernel.tau(q, qd, qdd, out=out)
    assert np.array_equal(out, expected)


def test_the_numpy_module_works_alone(tmp_path):
    """The emitted module needs NumPy only."""
    kernel = build(everything_program(), tmp_path / "arm", "numpy")
    code = (
        "import importlib.util as u, sys, numpy as np\n"
        "spec = u.spec_from_file_location('m', sys.argv[1])\n"
        "m = u.module_from_spec(spec); spec.loader.exec_module(m)\n"
        "M, v, energy = m.everything([0.1, 0.2, 0.3], np.ones((4, 3)), [2, 0.5])\n"
        "assert 'moro' not in sys.modules and 'moro_codegen' not in sys.modules\n"
        "print(M.shape, v.shape, energy.shape, repr(float(energy[2])))\n"
    )
    done = subprocess.run(
        [sys.executable, "-B", "-c", code, str(kernel.source)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    energy = kernel.everything([0.1, 0.2, 0.3], np.ones(3), [2, 0.5])[2]
    assert done.stdout.split("\n")[0] == f"(4, 2, 3) (4, 3) (4,) {float(energy)!r}"
