"""The Cython backend: a folder that builds by itself, the C backend's numbers to the last bit."""

import os
import subprocess
import sys

import numpy as np
import pytest
from programs import EVERYTHING, PARAMETERS, everything_program, files, program, vector

import moro_codegen as mc
from moro_codegen.backends import extension
from moro_codegen.backends.cython import emit
from moro_codegen.backends.toolchain import ToolchainError, find_compiler
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function
from moro_codegen.pipeline import build

MATRIX = Function(
    "of_a_matrix",
    (Argument("A", (2, 3), "1", "a matrix"), vector("x", 3)),
    (Argument("y", (2,), "1", "A x"),),
    "A product.",
    lambda system, A, x: [
        [sum(a * b for a, b in zip(A[i : i + 3], x, strict=True)) for i in (0, 3)]
    ],
)


@pytest.fixture(scope="module")
def kernels(tmp_path_factory):
    """Every operation and shape, compiled both ways, in one extension."""
    functions = program(EVERYTHING, MATRIX, dof=3, parameters=PARAMETERS, name="all_ops")
    folder = tmp_path_factory.mktemp("kernels")
    return {backend: build(functions, folder / backend, backend) for backend in ("c", "cython")}


Q, QD = np.random.default_rng(3).uniform(-2, 2, (2, 4, 5, 3))
GIVEN = np.array([2.5, 0.3])


def same(found, expected):
    assert len(found) == len(expected)
    for x, y in zip(found, expected, strict=True):
        assert type(x) is type(y)
        assert np.array_equal(x, y)
        assert np.shape(x) == np.shape(y)


def test_the_numbers_of_the_c_backend(kernels):
    c, cython = (kernels[backend].everything for backend in ("c", "cython"))
    states = [
        (Q, QD), (Q[0, 0], QD[0, 0]), (Q, QD[0, 0]), (Q[:, ::2], QD[:, ::-2]), (Q[..., ::-1], QD),
        (Q[:0], QD[:0]), (Q[0, 0].tolist(), np.float32(QD)),
    ]  # fmt: skip
    for q, qd in states:
        same(cython(q, qd, parameters=GIVEN), c(q, qd, parameters=GIVEN))
    by_name = {"offset": 0.3}
    same(cython(Q, QD, by_name), c(Q, QD, by_name))
    A = np.random.default_rng(0).uniform(-1, 1, (5, 2, 3))
    product = [kernel.of_a_matrix(A, Q, parameters=GIVEN) for kernel in kernels.values()]
    same(*[[x] for x in product])
    np.testing.assert_allclose(product[0], np.einsum("...ij,...j", A, Q), rtol=1e-14)


def test_out_and_threads(kernels):
    cython = kernels["cython"].everything
    expected = cython(Q, QD, GIVEN)
    out = tuple(np.empty((2, *x.shape))[1] for x in expected)
    assert cython(Q, QD, GIVEN, out=out) is out
    same(out, expected)
    many = np.tile(Q, (40, 10, 1)), np.tile(QD, (40, 10, 1))
    same(cython(*many, GIVEN, threads=2), cython(*many, GIVEN))
    with pytest.raises(ValueError, match="out overlaps x"):
        kernels["cython"].of_a_matrix(np.ones((2, 3)), Q, GIVEN, out=Q[..., :2])


def test_what_a_kernel_says(kernels):
    kernel = kernels["cython"]
    package = kernel.directory / "all_ops_cython" / "all_ops_kernel"
    assert kernel.backend == "cython"
    assert kernel.source == package / "functions.pyx"
    assert kernel.header == package / "all_ops.h"
    assert kernel.library.parent == package
    assert kernel.manifest["compiler"]["cython"]
    assert kernel.ops == kernels["c"].ops
    assert "Every operation there is." in kernel.everything.__doc__
    files = {p.relative_to(package.parent).as_posix() for p in package.parent.rglob("*")}
    assert files - {f"all_ops_kernel/{kernel.library.name}"} == {
        "README.md", "pyproject.toml", "setup.py", "all_ops_kernel", "all_ops_kernel/__init__.py",
        "all_ops_kernel/__init__.pxd", "all_ops_kernel/functions.pyx", "all_ops_kernel/all_ops.c",
        "all_ops_kernel/functions.pxd", "all_ops_kernel/all_ops.h", "all_ops_kernel/calls.py",
    }  # fmt: skip
    with pytest.raises(TypeError, match="no default for offset"):
        kernel.everything(Q, QD)


def test_reopened_and_reused(kernels):
    kernel = kernels["cython"]
    again = mc.Kernel(kernel.directory)
    same(again.everything(Q, QD, GIVEN), kernel.everything(Q, QD, GIVEN))
    functions = program(EVERYTHING, MATRIX, dof=3, parameters=PARAMETERS, name="all_ops")
    assert build(functions, kernel.directory, "cython").reused


def test_the_functions_themselves(kernels):
    """The extension's own take arrays that need no check; others are left to the package's."""
    direct = extension.load(kernels["cython"].library).everything
    one = Q[1, 2], QD[1, 2], GIVEN
    same(direct(*one), kernels["c"].everything(*one))
    for given in ((Q, QD, GIVEN), (Q[1, 2].tolist(), *one[1:]), (Q[1, :, 2][:3], *one[1:])):
        assert direct(*given) is NotImplemented


USER = """
from all_ops_kernel.functions cimport all_ops_everything, all_ops_everything_batch

def energy(double[::1] q, double[::1] qd, double[::1] parameters):
    cdef double M[6]
    cdef double v[3]
    cdef double single, batch
    with nogil:
        all_ops_everything(&q[0], &qd[0], &parameters[0], M, v, &single)
        all_ops_everything_batch(
            1, &q[0], 3, 1, &qd[0], 3, 1, &parameters[0], 2, 1, M, 6, 3, 1, v, 3, 1, &batch, 1
        )
    return single, batch
"""
SCRIPT = """
import sys
import numpy as np, all_ops_kernel, user
q, qd, parameters = np.array([0.1, 0.2, 0.3]), np.ones(3), np.array([2.0, 0.5])
expected = all_ops_kernel.everything(q, qd, parameters)[2]
assert user.energy(q, qd, parameters) == (expected, expected)
assert not any(name.startswith("moro") for name in sys.modules)
print(repr(float(expected)))
"""


@pytest.mark.sweep
def test_pip_install_and_cimport(tmp_path, kernels):
    """Installed without moro, called from Python and, without the GIL, from other Cython code."""
    folder = tmp_path / "all_ops_cython"
    for name, text in emit(everything_program()).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    site = tmp_path / "site"
    environment = {**os.environ, "PYTHONPATH": str(site), "MORO_CFLAGS": "-O1"}
    environment["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"

    def python(*arguments, cwd):
        command = [sys.executable, *arguments]
        done = subprocess.run(
            command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    python("-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index",
           "--target", str(site), str(folder), cwd=tmp_path)  # fmt: skip
    (tmp_path / "user.pyx").write_text(USER)
    python("-m", "Cython.Build.Cythonize", "--inplace", "--3", "user.pyx", cwd=tmp_path)
    printed = python("-W", "error", "-c", SCRIPT, cwd=tmp_path)
    energy = kernels["c"].everything([0.1, 0.2, 0.3], np.ones(3), [2, 0.5])[2]
    assert float(printed) == pytest.approx(energy, rel=1e-14)


def test_pyproject_needs_numpy_only():
    texts = emit(everything_program())
    project = texts["pyproject.toml"].splitlines()
    assert 'dependencies = ["numpy>=1.26"]' in project
    assert 'name = "all-ops-kernel"' in project
    assert not any("import moro" in text or "cimport moro" in text for text in texts.values())
    assert emit(everything_program()) == texts


def test_defaults_of_parameters():
    parameters = (("mass", 2.5), ("length", 0.1))
    text = emit(program(EVERYTHING, dof=3, parameters=parameters))["hand_made_kernel/__init__.py"]
    assert "parameters={'mass': 2.5, 'length': 0.1}" in text


def test_missing_tools_are_named(monkeypatch, tmp_path):
    monkeypatch.setattr(extension, "find_spec", lambda name: None)
    with pytest.raises(ToolchainError, match="needs cython and setuptools: pip install cython"):
        build(everything_program(), tmp_path / "arm", "cython")
    assert list(tmp_path.iterdir()) == []


def test_a_failing_compiler_shows_its_own_words(monkeypatch, tmp_path):
    compiler = find_compiler()
    broken = tmp_path / "cc"
    broken.write_text(
        f'#!/bin/sh\ncase "$*" in *-dM*) exec {compiler.command[0]} "$@";; esac\n'
        "echo 'internal error: out of ideas' >&2\nexit 4\n"
    )
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    with pytest.raises(ToolchainError, match=r"does not compile(.|\n)*out of ideas"):
        build(everything_program(), tmp_path / "build" / "arm", "cython")
    assert not (tmp_path / "build" / "arm").exists()


@pytest.mark.sweep
def test_another_kernel_takes_its_place(tmp_path):
    build(everything_program(), tmp_path / "arm", "cython")
    build(everything_program(), tmp_path / "arm", "numpy")
    assert files(tmp_path / "arm") == ["all_ops.py", "manifest.json"]
