"""What is told while one waits: where somebody sees it, and nowhere else."""

import io
import re
import sys
import time
from types import ModuleType

import pytest

import moro
import moro_codegen as mc
from moro_codegen import progress, waiting


class Terminal(io.StringIO):
    def isatty(self):
        return True


def wait_for(condition):
    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def _at_once(monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.0)


@pytest.mark.usefixtures("_at_once")
def test_a_terminal_shows_what_and_how_long(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress.shown():
        progress.tell("generating tau")
        wait_for(lambda: re.search(r"generating tau \(\d+ s\)", terminal.getvalue()))
        with progress.shown():  # inside another: the same line
            progress.tell("generating [bias]")
            wait_for(lambda: "generating [bias] (" in terminal.getvalue())


def test_a_short_job_shows_nothing(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress.shown():
        progress.tell("generating tau")
    assert terminal.getvalue() == ""


@pytest.mark.usefixtures("_at_once")
def test_a_pipe_gets_nothing(capfd):
    with progress.shown():
        progress.tell("generating tau")
        time.sleep(0.1)
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("_at_once")
def test_a_notebook_shows_a_line_and_clears_it(monkeypatch):
    lines = []

    class DisplayHandle:
        def display(self, data, raw):
            lines.append(data["text/plain"])

        update = display

    display = ModuleType("IPython.display")
    display.DisplayHandle = DisplayHandle
    for name, module in {"ipykernel": ModuleType("ipykernel"), "IPython.display": display}.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setitem(sys.modules, "IPython", ModuleType("IPython"))
    with progress.shown():
        progress.tell("generating tau")
        wait_for(lambda: any(re.fullmatch(r"generating tau \(\d+ s\)", line) for line in lines))
    assert lines[-1] == ""


@pytest.mark.usefixtures("_at_once")
def test_what_is_waited_for_is_said_in_the_line(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "100")
    with progress.shown():
        waiting.say("waiting for the compiler, cc")
        wait_for(lambda: "waiting for the compiler, cc (" in terminal.getvalue())
    assert "moro: " not in terminal.getvalue()


def test_an_error_ends_the_line(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with pytest.raises(KeyError), progress.shown():
        raise KeyError
    progress.tell("nobody listens")
    assert progress._line.get() is None


def test_compiling_and_verifying_tell_each_function(monkeypatch, tmp_path):
    told = []
    monkeypatch.setattr(progress, "_watcher", lambda: lambda line, over: over.wait())
    monkeypatch.setattr(progress.ProgressLine, "tell", lambda self, what: told.append(what))
    robot = moro.load("two_link")
    functions = ("tau", ("gravity_vector", "inertia_matrix"))
    kernel = mc.compile(robot, functions=functions, directory=tmp_path, backend="numpy")
    assert told == [
        "generating tau", "generating gravity_vector_inertia_matrix", "writing two_link",
    ]  # fmt: skip
    told.clear()
    mc.verify(kernel, robot)
    assert told == [
        "comparing tau with the equations",
        "comparing gravity_vector_inertia_matrix with the equations",
    ]
