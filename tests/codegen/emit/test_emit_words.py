"""Names that C's headers take: all are known, and parameters may have them."""

import re
import subprocess

import sympy as sp

import moro as mr
import moro_codegen as mc
from moro.abc import q1
from moro_codegen.backends.c_text import RESERVED


def macros():
    """What the headers define, and the compiler by itself, as the preprocessor tells."""
    includes = "".join(f"#include <{name}.h>\n" for name in ("math", "stdint", "stddef"))
    found = set()
    for mode in ("-std=c99", "-std=gnu11", "-D_GNU_SOURCE"):
        command = ["cc", mode, "-dM", "-E", "-x", "c", "-"]
        done = subprocess.run(command, input=includes, capture_output=True, text=True, check=True)
        found |= set(re.findall(r"^#define ([A-Za-z]\w*)", done.stdout, re.MULTILINE))
    return found


def test_macros_of_the_headers_are_reserved():
    assert len(macros()) > 80
    assert macros() <= RESERVED


def test_parameters_called_like_macros_and_types(tmp_path):
    names = sorted(macros() | {"size_t", "int32_t", "double_t"})
    robot = mr.Robot((1, 0, 0, q1))
    robot.masses, robot.cm_positions, robot.gravity = [1], [[-1, 0, 0]], [0, 0, 0]
    robot.inertia_tensors = [sp.diag(1, 1, sum(map(sp.Symbol, names)))]
    kernel = mc.compile(robot, directory=tmp_path)
    assert kernel.tau([0], [0], [2], dict.fromkeys(names, 1)) == [2 * len(names)]
