"""Paths and names of which there is no file, or none that can be read."""

from __future__ import annotations

import errno
import pickle
from pathlib import Path

import pytest

from moro import load
from moro.formats.loading import Problem, RobotFileError, read


def message(source: object) -> str:
    with pytest.raises(RobotFileError) as caught:
        load(source)
    return str(caught.value)


def test_a_missing_file_names_its_neighbour(tmp_path):
    (tmp_path / "my_arm.yaml").write_text("links:\n  - {joint: revolute, axis: z}\n")
    found = tmp_path / "my_arm.yaml"
    assert message(tmp_path / "my_amr.yaml").endswith(f"no such file; did you mean `{found}`?")
    assert message(str(tmp_path / "other.yaml")).endswith("other.yaml: no such file")
    assert message(tmp_path / "no" / "folder.yaml").endswith("folder.yaml: no such file")


def test_a_missing_arm_names_the_packaged_ones():
    assert message("pumma560") == (
        "pumma560: neither a file nor a packaged arm; did you mean `puma560`?"
        " (packaged are cobra600, palletizer, panda, puma560, solo12, stanford_arm, two_link,"
        " ur5, ur5e, xarm7)"
    )
    assert "(packaged are cobra600," in message("")
    assert "(packaged are cobra600," in message("kuka")


def test_a_folder(tmp_path):
    assert message(tmp_path).endswith("is a folder; expected a robot file")
    assert message(".").endswith("is a folder; expected a robot file")


def test_paths_that_cannot_be(tmp_path):
    assert "cannot be read" in message("a\0b.yaml")
    assert "cannot be read" in message("x" * 5000 + ".yaml")


def test_an_unreadable_file(monkeypatch):
    def refuse(*_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # a mode of 0 does not stop the superuser
    assert message("arm.yaml") == "arm.yaml: cannot be read: Permission denied"


@pytest.mark.parametrize("source", [3, None, 1.5, ["puma560"]])
def test_what_is_neither_a_name_nor_a_path(source):
    with pytest.raises(TypeError):
        read(source)


def test_errors_can_be_sent_between_processes():
    error = RobotFileError("arm.yaml", [Problem(2, "name", "bad")])
    again = pickle.loads(pickle.dumps(error))  # noqa: S301 - of this test's own making
    assert str(again) == str(error) == "arm.yaml:2: name: bad"
    assert again.problems == error.problems
