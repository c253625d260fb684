"""The exports in Python, used where there is no moro: a module, and a package that pip builds."""

import ast
import shutil
import sys

import numpy as np
import pytest
from exports import FUNCTIONS, python, run, states, two_link

import moro_codegen as mc
from moro_codegen.backends import toolchain


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    return mc.compile(arm(), ("tau", "inertia_matrix"), tmp_path_factory.mktemp("kernel"))


def arm():
    return two_link(payload=0.5, lost=None)


USE = """
import json, sys
import numpy as np
import {module} as arm
q, qd, qdd = np.array({states})
given = dict(payload=0.25, lost=0.5)
tau = arm.tau(q, qd, qdd, parameters=given, threads=2)
out = np.empty((len(q), 2))
assert arm.tau(q, qd, qdd, [0.25, 0.5], out) is out
assert np.array_equal(out, tau)
try:
    arm.tau(q, qd, [0, 0, 0], given)
except ValueError as error:
    assert "qdd (joint accelerations) must have shape (2,) or (..., 2), found (3,)" in str(error)
assert "joint positions" in arm.tau.__doc__
assert not [name for name in sys.modules if name.startswith(("moro", "sympy"))]
print(json.dumps(tau.tolist()))
"""


def check_use(module, kernel, cwd, **environment):
    """Use a module as kernels are used, in a process that has no moro."""
    given = states(2)
    text = USE.format(module=module, states=given.tolist())
    printed = python("-W", "error", "-c", text, cwd=cwd, **environment)
    expected = kernel.tau(*given, {"payload": 0.25, "lost": 0.5})
    np.testing.assert_allclose(np.array(ast.literal_eval(printed)), expected, rtol=1e-12)


def check_states(file, cwd, functions, limit, **environment):
    """Run the test of an export, which prints the largest error of each function."""
    printed = python(file, cwd=cwd, **environment).splitlines()
    assert printed[-1] == "passed"
    assert len(printed) == functions + 1
    assert max(float(line.split()[1]) for line in printed[:-1]) < limit


@pytest.mark.sweep
def test_a_module_where_it_is_written(kernel, tmp_path):
    (folder,) = mc.export(arm(), tmp_path, ("python",), FUNCTIONS)
    check_use("two_link", kernel, folder)
    check_states("test_two_link.py", folder, len(FUNCTIONS), 1e-12)
    python("-m", "pytest", "-q", "-p", "no:cacheprovider", cwd=folder)
    module = folder / "two_link.py"
    module.write_text(module.read_text().replace("= 0.5 *", "= 0.501 *"))
    assert "AssertionError" in python("test_two_link.py", cwd=folder, fails=True)


def test_a_module_in_single_precision(tmp_path):
    (folder,) = mc.export(arm(), tmp_path, ("python",), FUNCTIONS, "float32")
    check_states("test_two_linkf.py", folder, len(FUNCTIONS), 1e-5)


@pytest.mark.sweep
def test_a_wheel(kernel, tmp_path):
    """Built by `python -m build`, from the sdist, and installed elsewhere."""
    pytest.importorskip("build", reason="build, which makes wheels, is not installed")
    (folder,) = mc.export(arm(), tmp_path, ("cython",), ("tau", "inertia_matrix"))
    environment = {"MORO_CFLAGS": "-O1"}
    python("-m", "build", "--no-isolation", cwd=folder, **environment)
    (wheel,) = (folder / "dist").glob("two_link_kernel-*.whl")
    site = tmp_path / "site"
    python("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", site, wheel,
           cwd=tmp_path)  # fmt: skip
    check_use("two_link_kernel", kernel, tmp_path, PYTHONPATH=str(site))
    test = folder / "tests/test_two_link.py"
    check_states(test, tmp_path, 2, 1e-12, PYTHONPATH=str(site))
    installed = {path.name for path in (site / "two_link_kernel").iterdir()}
    assert {"functions.pxd", "__init__.pxd", "two_link.h"} < installed
    assert not [name for name in sys.modules if name == "two_link_kernel"]


@pytest.mark.sweep
def test_a_package_where_it_is_written(tmp_path):
    """And on a processor that lacks what it was built for: it says so, and does not crash."""
    (folder,) = mc.export(arm(), tmp_path, ("cython",), ("tau",), prefix="mine")
    new = "avx2" in toolchain.find_compiler().features
    flags = "-O1 -march=x86-64-v3" if new else "-O1"
    python("setup.py", "--quiet", "build_ext", "--inplace", cwd=folder, MORO_CFLAGS=flags)
    check_states("tests/test_mine.py", folder, 1, 1e-12, PYTHONPATH=".")
    if new and shutil.which("qemu-x86_64"):
        older = ("qemu-x86_64", "-cpu", "Nehalem", sys.executable)
        printed = run(*older, "-c", "import mine_kernel", cwd=folder, fails=True)
        assert "ImportError: mine_kernel cannot be used here: this processor lacks avx" in printed
