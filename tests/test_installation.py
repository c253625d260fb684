"""What is installed: one version, said in one place, and no other project's moro."""

import os
import re
import subprocess
import sys
from pathlib import Path

import yaml

import moro

ROOT = Path(__file__).parents[1]


def python(folder, *arguments, **environment):
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=os.environ | environment,
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_the_module_is_the_command(tmp_path):
    done = python(tmp_path, "-m", "moro_codegen", "--version")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"moro-codegen {moro.__version__} in {ROOT / 'moro'}\n")
    assert re.search(r"Python 3\.\d+\.\d+, numpy \d.*, sympy \d", done.stdout)


def test_versions_without_a_compiler(tmp_path):
    done = python(tmp_path, "-m", "moro_codegen", "--version", CC="no_such_compiler")
    assert done.returncode == 0
    assert "no_such_compiler" in done.stdout


def test_another_moro_is_refused(tmp_path):
    (tmp_path / "moro").mkdir()
    (tmp_path / "moro/__init__.py").write_text('__version__ = "0.5.0"\nclass Robot: pass\n')
    done = python(tmp_path, "-c", "import moro_codegen")
    assert done.returncode == 1
    assert f"`import moro` finds {tmp_path / 'moro'}, not the package" in done.stderr
    assert "pip uninstall moro moro-codegen" in done.stderr


def test_what_another_moro_leaves_behind_is_refused(tmp_path):
    (tmp_path / "moro").mkdir()  # __init__.py went with the other
    (tmp_path / "moro/model.py").touch()
    done = python(tmp_path, "-c", "import moro_codegen")
    assert "pip uninstall moro moro-codegen" in done.stderr


def test_other_errors_of_imports_keep_their_words(tmp_path):
    (tmp_path / "sympy.py").write_text("raise ImportError('broken', name='sympy')\n")
    done = python(tmp_path, "-c", "import moro_codegen; moro_codegen.compile")
    assert "ImportError: broken" in done.stderr
    assert "pip uninstall" not in done.stderr


def test_ci_tests_what_is_claimed():
    project = (ROOT / "pyproject.toml").read_text()
    claimed = re.findall(r"Programming Language :: Python :: (3\.\d+)", project)
    tested = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())
    assert tested["jobs"]["check"]["strategy"]["matrix"]["python"] == claimed
    assert f'requires-python = ">={claimed[0]}"' in project
    assert f"Python {claimed[0]} to {claimed[-1]}" in (ROOT / "README.md").read_text()


def test_windows_is_told_so_on_installation():
    code = (
        "import sys, runpy, numpy, setuptools; sys.platform = 'win32'; runpy.run_path('setup.py')"
    )
    done = python(ROOT, "-c", code)
    assert done.returncode == 1
    assert "needs Linux or macOS; on Windows it runs in WSL" in done.stderr
