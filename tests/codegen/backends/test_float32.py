"""Kernels in single precision: errors, batches, and arrays of float32 as they are."""

import shutil
import subprocess
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from arms import NAMES, reference_model, reference_states
from programs import everything_program, program, sines

import moro as mr
import moro_codegen as mc
from moro_codegen.backends.c_text import emit
from moro_codegen.emit.statements import literal
from moro_codegen.pipeline import build
from moro_codegen.program import generate

STRICT = (
    "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror",
)  # fmt: skip


def single_precision(one):
    return replace(one, scalar="float")


@pytest.fixture(scope="module")
def circle(tmp_path_factory):
    one = single_precision(program(*map(sines, range(1, 8)), dof=7))
    return build(one, tmp_path_factory.mktemp("sines") / "sines")


@pytest.fixture(scope="module", params=["c", "numpy"])
def arm(request, tmp_path_factory):
    one = single_precision(generate(reference_model("puma560")))
    return build(one, tmp_path_factory.mktemp("puma560") / "puma560", request.param)


def angles():
    """Random angles of every size up to 1e3, and those nearest to multiples of pi/4."""
    rng = np.random.default_rng(1)
    with mpmath.workprec(200):
        near = np.array([float(k * mpmath.pi / 4) for k in range(1, 1280)], np.float32)
    near = np.concatenate([near, np.nextafter(near, np.float32(0)), -near[::9]])
    return np.concatenate(
        [
            rng.uniform(-4, 4, 20_000).astype(np.float32),
            rng.uniform(-1e3, 1e3, 20_000).astype(np.float32),
            (10 ** rng.uniform(-37, 3, 2000) * rng.choice([-1, 1], 2000)).astype(np.float32),
            near[abs(near) < 1e3],
            np.array([0, -0.0, 1e-45, 1e3, -1e3], np.float32),
        ]
    )


def test_sines_within_two_units_in_the_last_place(circle):
    """The double's sine is exact enough: its own error is some 1e-9 units of a float."""
    x = angles()
    for found, exact in zip(circle.sines_1(x[:, None]), (np.sin, np.cos), strict=True):
        right = exact(x.astype(float))
        units = np.abs(found[:, 0] - right) / np.spacing(np.abs(right).astype(np.float32))
        assert units.max() < 1.5


@pytest.mark.parametrize("n", range(1, 8))
def test_any_number_of_angles_gives_the_same_bits(circle, n):
    x = angles()[::13]
    x = np.concatenate([x, np.array([3e4, -1e30, np.inf, np.nan] * 5, np.float32)])
    x = np.random.default_rng(n).permutation(x)[: len(x) // n * n].reshape(-1, n)
    function = getattr(circle, f"sines_{n}")
    batch = function(x)
    single = [np.array(rows) for rows in zip(*map(function, x), strict=True)]
    alone = circle.sines_1(x.reshape(-1, 1))
    for k in range(2):
        assert batch[k].dtype == np.float32
        assert np.array_equal(batch[k], single[k], equal_nan=True)
        assert np.array_equal(batch[k].ravel(), alone[k].ravel(), equal_nan=True)
        assert np.array_equal(np.isnan(batch[k]), ~np.isfinite(x))


@pytest.mark.parametrize("name", NAMES)
def test_errors_of_tau(tmp_path, name):
    """Against the double kernel, relative to the largest torque of all joints."""
    one = generate(reference_model(name))
    single, double = build(single_precision(one), tmp_path / "f"), build(one, tmp_path / "d")
    rng = np.random.default_rng(2)
    x = rng.uniform(-3, 3, (3, 2000, one.dof)).astype(np.float32)
    right = double.tau(*x)
    errors = np.abs(single.tau(*x) - right).max(axis=1) / np.abs(right).max(axis=1)
    assert np.median(errors) < 3e-7
    assert errors.max() < 1e-5


def test_reference(arm):
    for s in reference_states("puma560"):
        tau = arm.tau(s["q"], s["qd"], s["qdd"])
        assert tau.dtype == np.float32
        assert np.abs(tau - s["tau"]).max() < 1e-5 * np.abs(s["tau"]).max()


@pytest.mark.parametrize("n", [0, 1, 5, 15, 16, 17, 40, 100])
def test_batches_are_single_calls_to_the_last_bit(arm, n):
    given = np.random.default_rng(n).uniform(-2, 2, (3, n, 6)).astype(np.float32)
    tau = arm.tau(*given)
    assert tau.dtype == np.float32
    single = np.array([arm.tau(*rows) for rows in zip(*given, strict=True)]).reshape(n, 6)
    if arm.backend == "c":
        assert np.array_equal(tau, single)
    else:
        assert np.allclose(tau, single, rtol=1e-5, atol=1e-5)
    for layout in (np.asfortranarray, lambda x: np.repeat(x, 2, 0)[::2], lambda x: x[::-1][::-1]):
        out = layout(np.empty((n, 6), np.float32))
        assert arm.tau(*map(layout, given), out=out) is out
        assert np.array_equal(out, tau)


def test_kinds_of_arrays(arm):
    q, qd, qdd = np.random.default_rng(3).uniform(-2, 2, (3, 6)).astype(np.float32)
    expected = arm.tau(q, qd, qdd)
    for kind in (np.float64, ">f4", np.longdouble):
        assert np.array_equal(arm.tau(q.astype(kind), qd, qdd.astype(kind)), expected)
    assert np.array_equal(arm.tau(q.tolist(), qd, qdd), expected)
    out = np.empty(6, np.float32)
    assert arm.tau(q, qd, qdd, out=out) is out
    assert np.array_equal(out, expected)
    with pytest.raises(TypeError, match="out must hold float32, found float64"):
        arm.tau(q, qd, qdd, out=np.empty(6))
    assert "float32" in arm.tau.__doc__


def test_every_operation_and_parameters(tmp_path):
    double = build(everything_program(), tmp_path / "d")
    single = build(single_precision(everything_program()), tmp_path / "f")
    rng = np.random.default_rng(4)
    q, qd = rng.uniform(-2, 2, (2, 37, 3)).astype(np.float32)
    given = {"parameters": {"offset": 0.5}}
    for one, right in zip(
        single.everything(q, qd, **given), double.everything(q, qd, **given), strict=True
    ):
        assert one.dtype == np.float32
        assert np.abs(one - right).max() < 1e-5 * max(1, np.abs(right).max())
    assert type(single.everything(q[0], qd[0], **given)[2]) is np.float32


@pytest.mark.parametrize("flags", [(), ("-march=native",), ("-DMORO_PLAIN_C",)])
@pytest.mark.parametrize("compiler", [c for c in ("gcc", "clang") if shutil.which(c)])
def test_no_warnings(tmp_path, compiler, flags):
    """Nor a double anywhere."""
    for one in (everything_program(), generate(reference_model("two_link"))):
        texts = emit(single_precision(one))
        assert not any("double" in text for text in texts.values())
        for name, text in texts.items():
            (tmp_path / name).write_text(text)
        command = [compiler, *STRICT, *flags, "-O1", "-c", f"{one.name}.c"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_constants():
    assert literal(0.1, "f") == "0.1f"
    assert literal(1, "f") == "1.0f"
    assert literal(-1e-5, "f") == "-1e-05f"
    assert np.float32(literal(1 / 3, "f")[:-1]) == np.float32(1 / 3)
    for huge in (1e39, float(np.finfo(np.float32).max) * (1 + 2**-24), float("inf")):
        with pytest.raises(ValueError, match="not finite"):
            literal(huge, "f")


def test_compile(tmp_path):
    robot = mr.load("two_link")
    single = mc.compile(robot, directory=tmp_path, dtype="float32")
    double = mc.compile(robot, directory=tmp_path)
    assert single.directory != double.directory
    assert single.manifest["scalar"] == "float"
    assert mc.compile(robot, directory=tmp_path, dtype=np.float32).reused
    x = np.array([0.3, -0.4], np.float32)
    assert single.tau(x, x, x) == pytest.approx(double.tau(x, x, x), rel=1e-6)
    with pytest.raises(ValueError, match=r'dtype must be "float64" or "float32", not "?\'half\''):
        mc.compile(robot, directory=tmp_path, dtype="half")
    with pytest.raises(ValueError, match="double precision only"):
        mc.compile(robot, directory=tmp_path, backend="cython", dtype="float32")
