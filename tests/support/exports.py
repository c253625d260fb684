"""Exports as their users have them: a folder outside the project, and programs run in it."""

import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
import sympy as sp

import moro
import moro_codegen as mc
from moro.abc import q1, qd2

STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror")
#: every function of the catalogue, several in one call, at a frame, of one's own
FUNCTIONS = (
    *mc.FUNCTIONS,
    ("tau", "inertia_matrix"),
    "jacobian@1",
    mc.Function("power", [q1 * qd2, sp.Matrix([q1, qd2 * q1])], "A scalar and a vector."),
)
#: functions of which some export has all
SOME = ("tau", "forward_dynamics", "regressor", ("tau", "inertia_matrix"))
#: exports in C that tests share: arm, functions, options
EXPORTS = {
    "double": ("two_link", FUNCTIONS, {}),
    "float": ("two_link", SOME, {"dtype": "float32"}),
    "batch": ("two_link", SOME, {"batch": True}),
    "tau": ("two_link", ("tau",), {}),
    "tauf": ("two_link", ("tau",), {"dtype": "float32"}),
    "puma": ("puma560", ("tau", "forward_dynamics"), {}),
    "pumaf": ("puma560", ("tau", "forward_dynamics"), {"dtype": "float32"}),
}
#: pytest, when it runs inside pytest, must not read our own pyproject.toml
VARIABLES = {"PYTHONDONTWRITEBYTECODE": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


def two_link(name="two_link", **parameters):
    """The packaged arm; parameters, by name, are added to the mass of link 2."""
    robot = moro.load("two_link")
    if parameters:
        symbols = {sp.Symbol(key): value for key, value in parameters.items()}
        robot.masses = [1, 1 + sum(symbols)]
        robot.parameters = symbols
    robot.name = name
    return robot


def run(*command, cwd, fails=False, **environment):
    """Run a program; return what it printed."""
    done = subprocess.run(
        list(map(str, command)), cwd=cwd, env={**os.environ, **VARIABLES, **environment},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert bool(done.returncode) == fails, done.stdout + done.stderr
    return done.stdout + done.stderr


def python(*arguments, cwd, **environment):
    return run(sys.executable, *arguments, cwd=cwd, **environment)


def needs(*tools):
    """Skip a test, with a message, where a tool is missing."""
    return pytest.mark.skipif(
        any(shutil.which(tool) is None for tool in tools),
        reason=f"{' or '.join(tools)} is not installed on this machine",
    )


def compilers():
    """GCC and Clang, each skipped where it is missing."""
    return [pytest.param(name, marks=needs(name)) for name in ("gcc", "clang")]


def errors(printed):
    """The errors that a self-test printed."""
    assert "passed" in printed
    return {name: float(x) for name, x in re.findall(r"^(\w+) +(\d\.\de[-+]\d+)", printed, re.M)}


def tree(folder):
    """The bytes of all files in a folder, by path."""
    paths = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def states(n, count=5):
    """States q, qd, qdd as rows."""
    return np.random.default_rng(1).uniform(-2, 2, (3, count, n))
