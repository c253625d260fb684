"""What moro-codegen prints to a terminal, a pipe, a machine; and what it says when stopped."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from moro_codegen.cli import main

COMMAND = [sys.executable, "-m", "moro_codegen"]
SEVERAL = "tau,inertia_matrix,coriolis_matrix,forward_dynamics"


def printed(capsys, *arguments):
    """What the command prints in this process, which is no terminal."""
    with pytest.raises(SystemExit) as stopped:
        main([*arguments, "--backend", "numpy"], prog_name="moro-codegen")
    assert stopped.value.code == 0
    return capsys.readouterr().out


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def on_terminal(*arguments, columns):
    """What the command prints on a terminal, without escape sequences."""
    ours, theirs = pty.openpty()
    variables = os.environ | {"COLUMNS": str(columns), "TERM": "xterm"}
    job = subprocess.Popen(
        [*COMMAND, *arguments], stdin=theirs, stdout=theirs, stderr=subprocess.DEVNULL,
        env=variables,
    )  # fmt: skip
    os.close(theirs)
    text = b""
    try:
        while part := os.read(ours, 4096):
            text += part
    except OSError:  # Linux says so at the end of a terminal
        pass
    assert job.wait(timeout=120) == 0
    return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text.decode()).replace("\r\n", "\n")


def test_a_pipe_gets_a_row_a_line_without_trailing_blanks(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    text = printed(capsys, "two_link", "-f", SEVERAL, "--no-benchmark")
    lines = text.splitlines()
    assert lines == [line.rstrip() for line in lines]
    assert "largest error" in text
    assert any(re.match("largest error .* verified: 84 states, against the", x) for x in lines)
    assert any(x.endswith("inertia_matrix(q), coriolis_matrix(q, qd), forward_dynamics(q, qd, tau)")
               for x in lines)  # fmt: skip


def test_a_terminal_gets_no_longer_lines_than_it_has_columns():
    arguments = ("puma560", "-f", "tau,inertia_matrix", "--backend", "numpy", "--no-benchmark")
    text = on_terminal(*arguments, columns=60)
    table = text[: text.index("build/puma560/")]
    assert max(map(len, table.splitlines())) <= 60
    assert re.search(r"largest error .* verified: \d+ states,.*\n {20,}", table)


def test_timings_say_of_what_they_are(capsys):
    text = printed(capsys, "two_link", "-f", "tau,jacobian")
    rows = re.findall(r"^(?:compiled kernel|the same in NumPy|SymPy lambdify) .*", text, re.M)
    assert len(rows) == 5
    assert all(re.search(r"\btau\b", row) for row in rows)


def test_one_json_document(capsys):
    text = printed(capsys, "two_link", "-f", "tau,inertia_matrix", "--json")
    found = json.loads(text)
    assert found["verified"] is True
    assert found["verification"]["errors"].keys() == {"tau", "inertia_matrix"}
    assert 0 < found["verification"]["errors"]["tau"] < found["verification"]["tolerance"]
    assert found["operations"]["tau"]["mul"] == 13
    assert found["times"].keys() == {"derive", "generate", "compile", "verify"}
    assert {(t["function"], t["batch"]) for t in found["timings"]} == {
        ("tau", 1), ("tau", 4096), ("inertia_matrix", 1), ("inertia_matrix", 4096)
    }  # fmt: skip
    assert Path(found["directory"], "manifest.json").is_file()
    again = json.loads(printed(capsys, "two_link", "-f", "tau,inertia_matrix", "--json"))
    assert again["times"]["compile"] is None


def test_what_is_not_finite_is_null_in_json(capsys, monkeypatch):
    from moro_codegen import verify

    checks = sys.modules[verify.__module__].CHECKS
    pair = sys.modules[verify.__module__].Pair
    monkeypatch.setitem(checks, "tau", lambda x, tau: [pair(tau * float("nan"), x.tau)])
    with pytest.raises(SystemExit) as stopped:
        main(["two_link", "--backend", "numpy", "--json", "--no-benchmark"])
    assert stopped.value.code == 1
    found = json.loads(capsys.readouterr().out)
    assert found["verified"] is False
    assert found["verification"]["errors"] == {"tau": None}


@pytest.mark.parametrize("folder", ["[", "[project]", "[bold]x", ":smile:"])
def test_paths_are_no_markup(folder, capsys):
    text = printed(capsys, "two_link", "-o", folder, "--no-benchmark")
    assert f"\n{folder}/two_link/: manifest.json" in text


def test_a_path_that_closes_a_tag(capsys, tmp_path):
    text = printed(capsys, "two_link", "-o", "[/]", "--no-benchmark")
    assert "[/]/two_link/: manifest.json" in text
    assert (tmp_path / "[" / "]" / "two_link" / "two_link.py").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_interrupt_exits_with_130(tmp_path):
    """Not with 1, which says that the kernel is wrong."""
    compiler = tmp_path / "cc"
    compiler.write_text(f"#!/bin/sh\ntouch {tmp_path}/running\nexec sleep 60\n")
    compiler.chmod(0o755)
    job = subprocess.Popen(
        [*COMMAND, "two_link"], env=os.environ | {"CC": str(compiler)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        # what a shell starts in the background does not hear interrupts
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    end = time.monotonic() + 60
    while not (tmp_path / "running").exists():
        assert time.monotonic() < end
        time.sleep(0.05)
    job.send_signal(signal.SIGINT)
    out, err = job.communicate(timeout=60)
    assert job.returncode == 130
    assert (out, err) == ("", "moro-codegen: interrupted\n")
    assert not (tmp_path / "build" / "two_link").exists()
