"""Notebooks run, and give the outputs that they hold."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from docs.refresh import NOTEBOOKS

ROOT = Path(__file__).parent.parent
#: an image is compared by its being there: its bytes depend on fonts and on versions
COMPARED = ("text/plain", "text/latex", "text/html")


def outputs(path):
    """What a notebook shows, cell by cell."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    return [[shown(x) for x in cell["outputs"]] for cell in code]


def shown(output):
    data = output.get("data", {})
    kinds = sorted(data)
    return kinds, *(data.get(kind) for kind in COMPARED), output.get("text")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_shows_what_it_holds(path, tmp_path):
    copy = tmp_path / path.name
    shutil.copy(path, copy)
    variables = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-m", "docs.refresh", str(copy)]
    subprocess.run(command, cwd=ROOT, env=variables, check=True)
    assert outputs(copy) == outputs(path), f"if what is new is right: python -m docs.refresh {path}"


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 2
