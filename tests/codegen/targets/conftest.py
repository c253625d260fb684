"""Exports in C that many tests build."""

import shutil

import pytest
from exports import EXPORTS, two_link
from filelock import FileLock

import moro
import moro_codegen as mc


@pytest.fixture(scope="session")
def exports(tmp_path_factory, worker_id):
    """The exports by name, each made when it is first asked for, by one of pytest's workers."""
    own = tmp_path_factory.getbasetemp()
    folder = (own if worker_id == "master" else own.parent) / "exports"
    folder.mkdir(exist_ok=True)

    def made(name):
        arm, functions, options = EXPORTS[name]
        with FileLock(folder / f"{name}.lock"):
            if not (folder / name).exists():
                robot = two_link(payload=0.5, lost=None) if arm == "two_link" else moro.load(arm)
                mc.export(robot, folder / name, ("c",), functions, **options)
        return folder / name / "c"

    return made


@pytest.fixture
def copy(exports, tmp_path):
    """A copy of an export to work in."""
    return lambda name: shutil.copytree(exports(name), tmp_path / name)
