"""moro-codegen: the whole job, its table, its exit codes, and what wrong input gets."""

import json
import shutil
import sys
from pathlib import Path

import pytest
from command import run

from moro_codegen import FUNCTIONS, Kernel

ROBOTS = Path(__file__).parents[3] / "moro" / "robots"


def test_whole_job(tmp_path):
    done = run("puma560", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for row in (
        "joints                    6   RRRRRR",
        "operations              309   ",
        "                         44   of these for friction and rotor inertia",
        "time to derive",
        "time to generate",
        "time to compile",
        "verified: 84 states, against the closed form",
        "compiled kernel",
        "the same in NumPy",
        "SymPy lambdify",
        "x the kernel",
        "build/puma560/: libpuma560.so, manifest.json, puma560.c, puma560.h",
    ):
        assert row in done.stdout
    manifest = json.loads((tmp_path / "build/puma560/manifest.json").read_text())
    assert manifest["input"]["file"] == "puma560.yaml"
    assert len(manifest["input"]["sha256"]) == 64
    assert manifest["compiler"]["flags"]
    assert manifest["functions"][0]["ops"]["mul"] > 100


def test_second_run_reuses_and_changed_input_rebuilds(tmp_path):
    path = tmp_path / "arm.yaml"
    text = (ROBOTS / "two_link.yaml").read_text()
    path.write_text(text)
    assert "built before" not in run(path, "--no-benchmark", cwd=tmp_path).stdout
    again = run(path, "--no-benchmark", cwd=tmp_path)
    assert "built before from the same input" in again.stdout
    assert "compiled kernel" not in again.stdout
    path.write_text(text.replace("mass: 1", "mass: 2"))
    changed = run(path, "--no-benchmark", cwd=tmp_path)
    assert changed.returncode == 0
    assert "built before" not in changed.stdout


def test_output_folder_and_numpy_backend(tmp_path):
    done = run("two_link", "-o", "kernels", "--backend", "numpy", cwd=tmp_path, CC="no-such-cc")
    assert done.returncode == 0, done.stderr
    assert {p.name for p in (tmp_path / "kernels/two_link").iterdir()} >= {
        "two_link.py",
        "manifest.json",
    }
    assert not (tmp_path / "build").exists()


def test_run_time_parameters_are_listed(tmp_path):
    text = (ROBOTS / "two_link.yaml").read_text()
    path = tmp_path / "arm.yaml"
    path.write_text(text.replace("mass: 1", "mass: m") + "parameters: {m: 1.5}\n")
    done = run(path, "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "parameters               1   m" in done.stdout


def test_functions(tmp_path):
    functions = "tau, inertia_matrix,tau+inertia_matrix,tau_derivatives"
    done = run("two_link", "--functions", functions, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for row in (
        "two_link: tau(q, qd, qdd), inertia_matrix(q), tau_inertia_matrix(q, qd, qdd)",
        "operations  sin-cos    error ",
        "\ntau_inertia_matrix ",
        "\ntau_derivatives ",
        "verified: 84 states",
        "one call of tau from Python",
        "in a batch of 4096, per sample",
        "libtwo_link.so, manifest.json, two_link.c, two_link.h",
    ):
        assert row in done.stdout
    kernel = Kernel(tmp_path / "build" / "two_link")
    tau, M = kernel.tau_inertia_matrix([1, 2], [0, 0], [1, 0])
    assert tau == pytest.approx(M[:, 0] + kernel.tau([1, 2], [0, 0], [0, 0]), rel=1e-13)
    again = run("two_link", "-f", "tau", "--no-benchmark", cwd=tmp_path)
    assert "operations   " in again.stdout
    assert {path.name for path in (tmp_path / "build/two_link").iterdir()} == {
        "manifest.json", "two_link.c", "two_link.h", "libtwo_link.so",
    }  # fmt: skip


def test_functions_without_tau(tmp_path):
    done = run("two_link", "-f", "jacobian@1", "--backend", "numpy", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "one call of jacobian_1 from Python" in done.stdout
    assert "jacobian_1 per sample of 4096" in done.stdout
    assert "two_link: jacobian_1(q)" in done.stdout


def test_cython_backend(tmp_path):
    done = run("two_link", "--backend", "cython", "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "verified: 84 states" in done.stdout
    assert "manifest.json, two_link_cython/" in done.stdout


def test_single_precision(tmp_path):
    done = run("two_link", "--scalar", "float", "-f", "tau,inertia_matrix", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for row in ("scalar type", "float   single precision", "verified: 84 states", "SymPy lambdify"):
        assert row in done.stdout
    assert json.loads((tmp_path / "build/two_link/manifest.json").read_text())["scalar"] == "float"
    assert "float tau[2]" in (tmp_path / "build/two_link/two_link.h").read_text()
    again = run("two_link", "--no-benchmark", cwd=tmp_path)
    assert "built before" not in again.stdout
    assert "scalar type" not in again.stdout
    assert "double tau[2]" in (tmp_path / "build/two_link/two_link.h").read_text()
    refused(
        run("two_link", "--scalar", "float", "--backend", "cython", cwd=tmp_path),
        "double precision only",
    )
    refused(run("two_link", "--scalar", "half", cwd=tmp_path), "'half'", "double", "float")


def test_unknown_functions_and_targets(tmp_path):
    refused(
        run("two_link", "-f", "tau,inertia_matrx", cwd=tmp_path),
        "no 'inertia_matrx'; did you mean 'inertia_matrix'? there are tau, ",
    )
    refused(run("two_link", "-f", ",", cwd=tmp_path), "none given; there are tau, ")
    refused(run("two_link", "-f", "tau,tau", cwd=tmp_path), "two functions are called tau")
    refused(run("two_link", "-f", "tau+tau", cwd=tmp_path), "tau is asked for twice in tau+tau")
    refused(run("two_link", "-f", "jacobian@hand", cwd=tmp_path), "no frame is called 'hand'")
    refused(run("two_link", "-f", "jacobin@1", cwd=tmp_path), "no 'jacobin'; did you mean")
    export = ("two_link", "--export", "out", "--target")
    refused(run(*export, "c,pyton", cwd=tmp_path), "did you mean 'python'?")
    refused(run("two_link", "--target", "c", cwd=tmp_path), "add --export DIR")
    refused(run("two_link", "--batch", cwd=tmp_path), "add --export DIR")
    refused(run("ur5", "-f", "forward_dynamics", cwd=tmp_path), "no inertia resists joint 6")
    assert not (tmp_path / "build").exists()


def test_a_wrong_function_fails_the_whole(tmp_path, monkeypatch, capsys):
    """The verdict covers every function, not only tau."""
    from moro_codegen import cli, verify

    checks = sys.modules[verify.__module__].CHECKS
    pair = sys.modules[verify.__module__].Pair
    monkeypatch.setitem(checks, "inertia_matrix", lambda x, M: [pair(M, 2 * x.M)])
    monkeypatch.chdir(tmp_path)
    arguments = ["two_link", "-f", "tau,inertia_matrix", "--no-benchmark", "--backend", "numpy"]
    with pytest.raises(SystemExit) as stopped:
        cli.main(arguments)
    assert stopped.value.code == 1
    assert "NOT VERIFIED" in capsys.readouterr().out


def test_help_explains_itself(tmp_path):
    done = run("--help", cwd=tmp_path)
    assert done.returncode == 0
    words = (
        "ROBOT",
        "puma560",
        "--output",
        "--backend",
        "--scalar",
        "--export",
        "--target",
        "Exit code",
        "manifest",
    )
    for word in (
        *words,
        *FUNCTIONS,
        "jacobian[@FRAME]",
        "Jacobian of the last frame: velocity of its origin",
    ):
        assert word in done.stdout


def refused(done, *words):
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    for word in words:
        assert word in done.stderr


def test_missing_file(tmp_path):
    refused(run("robot.yaml", cwd=tmp_path), "robot.yaml")
    refused(run("pma560", cwd=tmp_path), "did you mean `puma560`", "packaged")
    refused(run(cwd=tmp_path), "Missing argument 'ROBOT'")


def test_bad_file_names_file_line_and_field_and_leaves_nothing(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text((ROBOTS / "two_link.yaml").read_text().replace("mass: 1", "mass: -1"))
    done = run(path, cwd=tmp_path)
    refused(done, "arm.yaml:", "links[1].mass", "links[2].mass")
    assert not (tmp_path / "build").exists()


def test_no_masses(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("links:\n  - {joint: revolute, a: 1, alpha: 0, d: 0, theta: 0}\n")
    refused(run(path, cwd=tmp_path), "no masses", "add mass, com and inertia")


def test_missing_compiler_names_the_fallback_and_leaves_nothing(tmp_path):
    done = run("two_link", cwd=tmp_path, CC="no-such-cc")
    refused(done, "no-such-cc", "numpy")
    assert not list((tmp_path / "build").glob("two_link*")) if (tmp_path / "build").exists() else 1


def test_failing_compiler_shows_its_own_words(tmp_path):
    compiler = tmp_path / "cc"
    compiler.write_text('#!/bin/sh\necho "cc: cannot do this" >&2\nexit 1\n')
    compiler.chmod(0o755)
    done = run("two_link", cwd=tmp_path, CC=str(compiler))
    refused(done, "cc: cannot do this", "numpy")
    assert not (tmp_path / "build/two_link").exists()


def test_output_that_is_a_file(tmp_path):
    (tmp_path / "taken").write_text("")
    refused(run("two_link", "-o", "taken", cwd=tmp_path), "taken")


@pytest.mark.sweep
@pytest.mark.parametrize("name", sorted(path.stem for path in ROBOTS.glob("*.yaml")))
def test_every_packaged_arm_verifies(name, tmp_path):
    shutil.copy(ROBOTS / f"{name}.yaml", tmp_path / "mine.yaml")
    done = run("mine.yaml", "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "verified" in done.stdout
