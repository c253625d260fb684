"""Text of others in emitted code stays text: names, summaries, units, meanings, in every language.

Were any of it taken for code, a file named ``struck`` would be written, or nothing compile.
"""

import ast
import json
import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from programs import vector

import moro as mr
import moro_codegen as mc
from moro.abc import q1
from moro_codegen.backends.c_text import emit as emit_c
from moro_codegen.backends.cython import emit as emit_cython
from moro_codegen.backends.numpy import emit as emit_numpy
from moro_codegen.backends.toolchain import find_compiler
from moro_codegen.emit.escape import c_comment, printable, python_docstring
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function
from moro_codegen.pipeline import build

STRIKE = "open('struck', 'w')"
HOSTILE = [
    f'"""\n{STRIKE}\n"""', f'""" + {STRIKE} + """', f"'''\n{STRIKE}\n'''", f"\n{STRIKE}\n#",
    f'\\""" ; {STRIKE}', f"x\r{STRIKE}", f"x\u2028{STRIKE}", f"x\x0c{STRIKE}", f"x\x85{STRIKE}",
    "*/ int struck(void) { return 1; } /*", "*\\\n/ int struck;", "??/\n*/ int struck;", "end \\",
    "end ??/", "end *", 'end "', "end '", "/* nested", "// line", "{{ 7 * 7 }}", "{% raw %}",
    "\u202e\u2066bidi", "nul\0", "bell\a", "\ud800 half", "\\N{BELL} \\x41 \\u0041", "%s {0}",
    "\u03b8\u0307 and \u20ac", "'); " + STRIKE + "; ('",
]  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE)
def test_one_line_that_shows_what_it_is(text):
    line = printable(text)
    assert line.isprintable()
    assert printable(line) == line
    assert printable("\u03b8 \u00b7 \\theta") == "\u03b8 \u00b7 \\theta"


@pytest.mark.parametrize("text", HOSTILE)
def test_comments_of_c(text):
    line = c_comment(text)
    assert not re.search(r"\*/|/\*|\?\?|\\$|[*/]$", line)
    assert line.isprintable()


@pytest.mark.parametrize("text", HOSTILE)
def test_docstrings(text):
    (statement,) = ast.parse(f'"""{python_docstring(text)}"""').body
    assert ast.literal_eval(statement.value) == printable(text)


def hostile(program):
    """Every text of a program that its author chose, hostile; names of parameters differ."""
    dirty = "".join(HOSTILE)
    routines = [
        replace(
            r,
            function=replace(r.function, summary=dirty),
            inputs=tuple(replace(a, unit=dirty, description=dirty) for a in r.inputs),
            outputs=tuple(replace(a, unit=dirty, description=dirty) for a in r.outputs),
        )
        for r in program.routines
    ]
    return replace(program, routines=tuple(routines), gravity=(dirty, "0", dirty))


@pytest.fixture(scope="module")
def program():
    """The sum of as many parameters as there are hostile names, times x."""
    from programs import program

    def scaled(system, x):
        parameters = [system.graph.input("parameters", k) for k in range(len(HOSTILE))]
        return [[sum(parameters[1:], parameters[0]) * x[0]]]

    function = Function(
        "scaled", (vector("x", 1),), (Argument("y", (1,), "1", "y"),), "Scaled.", scaled
    )
    parameters = tuple((name, 1.0) for name in HOSTILE)
    return hostile(program(function, dof=1, parameters=parameters, name="arm"))


@pytest.mark.parametrize("backend", ["c", "cython", "numpy"])
def test_kernels(program, backend, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kernel = build(program, tmp_path / "arm", backend)
    assert kernel.scaled([2.0]) == 2 * len(HOSTILE)
    assert kernel.scaled([2.0], {HOSTILE[0]: 3.0}) == 2 * len(HOSTILE) + 4
    assert list(kernel.parameters) == HOSTILE
    assert printable("".join(HOSTILE)) in kernel.scaled.__doc__
    assert not (tmp_path / "struck").exists()
    json.loads((kernel.directory / "manifest.json").read_text())


def test_python(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (text,) = emit_numpy(program).values()
    names = {"__name__": "arm"}
    exec(compile(text, "arm.py", "exec"), names)  # noqa: S102
    assert names["scaled"]([2.0]) == 2 * len(HOSTILE)
    package = emit_cython(program)
    for path, text in package.items():
        text.encode()
        if path.endswith(".py"):
            compile(text, path, "exec")
    assert not (tmp_path / "struck").exists()


@pytest.mark.parametrize("standard", ["-std=c99", "-xc++"])
def test_headers_without_a_warning(program, tmp_path, standard):
    texts = emit_c(program)
    (tmp_path / "arm.h").write_text(texts["arm.h"])
    (tmp_path / "main.c").write_text('#include "arm.h"\nint struck;\nint main(void) {return 0;}\n')
    command = [*find_compiler().command, "-Wall", "-Wextra", "-Werror", "-Wno-bidi-chars"]
    command += [standard, "-Wtrigraphs", "-Wcomment", "-fsyntax-only", "main.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", HOSTILE)
def test_lambdify(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    symbol = sp.Symbol(name)
    robot = mr.Robot((symbol, 0, 0, q1), name="arm")
    robot.parameters = {symbol: 2}
    f = mc.lambdify(robot.T[0, 3], robot)
    assert f(np.zeros(1)) == f([0.0], {name: 2}) == 2
    assert printable(name) in f.__doc__
    assert not (tmp_path / "struck").exists()


@pytest.mark.parametrize("text", HOSTILE)
def test_functions_of_ones_own(text):
    """Summary, unit and the formula itself, which is shown, may hold anything."""
    robot = mr.Robot((sp.Symbol(text), 0, 0, q1), name="arm")
    robot.parameters = {sp.Symbol(text): 2}
    function = mc.Function("reach", robot.T[0, 3], summary=text, unit=text)
    f = function.entry(robot.model())
    assert f.summary == text


@pytest.mark.parametrize("name", HOSTILE)
def test_robots_and_functions_are_named_by_identifiers(name, tmp_path):
    with pytest.raises(ValueError, match="cannot be named"):
        mc.Function(name, q1)
    robot = mr.Robot((1, 0, 0, q1), name=name)
    with pytest.raises(ValueError, match="cannot name functions"):
        mc.compile(robot, ("forward_kinematics",), directory=tmp_path)
    assert not list(tmp_path.iterdir())
