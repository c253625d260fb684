"""moro-codegen: the whole job, its table, its exit codes, and what wrong input gets."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROBOTS = Path(__file__).parents[2] / "moro" / "robots"


def run(*arguments, cwd, **environment):
    command = [sys.executable, "-m", "moro_codegen.cli", *map(str, arguments)]
    variables = os.environ | {"COLUMNS": "100"} | environment
    return subprocess.run(
        command, cwd=cwd, env=variables, capture_output=True, text=True, check=False, timeout=120
    )


def test_whole_job(tmp_path):
    done = run("puma560", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for row in (
        "joints                    6   RRRRRR",
        "operations",
        "time to derive",
        "time to generate",
        "time to compile",
        "verified: 84 states, against the closed form",
        "compiled kernel",
        "the same in NumPy",
        "SymPy lambdify",
        "x the kernel",
        "build/puma560/: manifest.json, puma560.c, puma560.h, puma560.so",
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


def test_help_explains_itself(tmp_path):
    done = run("--help", cwd=tmp_path)
    assert done.returncode == 0
    for word in ("ROBOT", "puma560", "--output", "--backend", "Exit code", "manifest"):
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


@pytest.mark.parametrize("name", sorted(path.stem for path in ROBOTS.glob("*.yaml")))
def test_every_packaged_arm_verifies(name, tmp_path):
    shutil.copy(ROBOTS / f"{name}.yaml", tmp_path / "mine.yaml")
    done = run("mine.yaml", "--no-benchmark", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "verified" in done.stdout
