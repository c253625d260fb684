"""The export in C, as its users have it: built by make and CMake, checked by its own self-test."""

import ctypes
import math
import platform
import re
from dataclasses import replace

import numpy as np
import pytest
from exports import EXPORTS, STRICT, compilers, errors, needs, run, states, two_link

import moro
import moro_codegen as mc

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@needs("make")
@pytest.mark.parametrize("name", ["double", "float", "batch", "puma", "pumaf"])
@pytest.mark.parametrize("compiler", compilers())
def test_make_check(copy, compiler, name):
    """Without a warning; every function within rounding."""
    flags = "-O1 " + " ".join(STRICT)
    found = errors(run("make", "check", f"CC={compiler}", f"CFLAGS={flags}", cwd=copy(name)))
    limit = 1e-4 if name in ("float", "pumaf") else 1e-12
    assert max(found.values()) < limit
    assert len(found) == len(EXPORTS[name][1])


@needs("make", "cc", "qemu-x86_64")
@pytest.mark.skipif(platform.machine() != "x86_64", reason="names of x86 processors")
def test_an_older_processor_says_what_it_lacks(copy):
    """In an emulator: before anything is computed that it cannot."""
    folder, flags = copy("batch"), "CFLAGS=-O3 -march=x86-64-v3"
    newer, older = (f"RUN=qemu-x86_64 -cpu {name}" for name in ("Haswell", "Nehalem"))
    assert errors(run("make", "check", flags, newer, cwd=folder))
    printed = run("make", "check", flags, older, cwd=folder, fails=True)
    assert "two_link: this processor lacks avx" in printed


SINCOS = """
#include <math.h>
void mine(double angle, double *sine, double *cosine);
void mine(double angle, double *sine, double *cosine)
{
    *sine = sin(angle);
    *cosine = cos(angle);
}
"""


@needs("make", "cc")
@pytest.mark.parametrize("name", ["tau", "batch"])
def test_sines_of_ones_own_and_plain_c(copy, name):
    folder = copy(name)
    flags = "CFLAGS=-O1 " + " ".join(STRICT)
    found = errors(run("make", "check", flags, "CPPFLAGS=-DMORO_PLAIN_C", cwd=folder))
    assert max(found.values()) < 1e-12
    run("make", "clean", cwd=folder)
    (folder / "mine.c").write_text(SINCOS)
    run("cc", "-c", "mine.c", cwd=folder)
    macro = "CPPFLAGS=-DTWO_LINK_SINCOS=mine"
    found = errors(run("make", "check", flags, macro, "LDLIBS=mine.o", cwd=folder))
    assert max(found.values()) < 1e-12
    run("make", "clean", cwd=folder)
    failed = run("make", "check", macro, cwd=folder, fails=True)
    assert "mine" in failed  # nothing else computes sines


@needs("make", "cc")
def test_what_is_wrong_fails_the_check(copy):
    folder = copy("puma")
    source = (folder / "puma560.c").read_text()
    constant = re.search(r"= (0\.\d{4,}) \*", source)
    at = constant.start(1)
    (folder / "puma560.c").write_text(source[:at] + "9" + source[at:])
    printed = run("make", "check", cwd=folder, fails=True)
    assert "WRONG" in printed
    assert "FAILED" in printed
    refused = run("make", "clean", "check", "CFLAGS=-ffast-math", cwd=folder, fails=True)
    assert "fast-math" in refused


@pytest.mark.parametrize("compiler", compilers())
@pytest.mark.parametrize("name", ["float", "batch"])
def test_sanitizers(copy, compiler, name):
    folder = copy(name)
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    try:
        run(compiler, *SANITIZERS, "empty.c", "-o", "empty", cwd=folder)
    except AssertionError:
        pytest.skip("this compiler has no sanitizers")
    sources = [path.name for path in folder.glob("two_link*.c")]
    flags = ("-std=c99", "-g", "-O1", *SANITIZERS)
    run(compiler, *flags, "selftest.c", *sources, "-lm", "-o", "selftest", cwd=folder)
    assert errors(run("./selftest", cwd=folder))


@needs("nm")
@pytest.mark.parametrize("compiler", compilers())
@pytest.mark.parametrize("name", ["puma", "pumaf"])
def test_freestanding(copy, compiler, name):
    """For one sample nothing is needed but a few functions of <math.h>."""
    folder = copy(name)
    f = "f" * (name == "pumaf")
    source = f"puma560{f}.c"
    flags = ("-std=c99", "-ffreestanding", "-O2", *STRICT)
    run(compiler, *flags, "-c", source, "-o", "k.o", cwd=folder)
    needed = set(re.findall(r"U (\w+)", run("nm", "-u", "k.o", cwd=folder)))
    libm = {f"{x}{f}" for x in ("sin", "cos", "atan2", "fabs", "sincos")}
    own = {"__cpu_model", "__cpu_indicator_init", "_GLOBAL_OFFSET_TABLE_"}  # the compiler's
    assert needed <= {*libm, *own}
    text = (folder / source).read_text() + (folder / f"puma560{f}.h").read_text()
    assert "_batch" not in text
    assert "_loop" not in text


@needs("make", "gcc")
def test_stack_and_computed_torque(copy):
    folder = copy("puma")
    printed = run("make", "-s", "stack", "CC=gcc", cwd=folder)
    sizes = dict(re.findall(r"^puma560_(\w+)\t(\d+) bytes", printed, re.M))
    assert set(sizes) == {"tau", "forward_dynamics", "fault"}
    assert 100 < int(sizes["tau"]) < int(sizes["forward_dynamics"]) < 10_000
    run("make", "computed_torque", cwd=folder)
    first, *_, last = re.findall(r"error (\S+),", run("./computed_torque", cwd=folder))
    assert float(first) == 0.1
    assert float(last) < 1e-5


USER = r"""
#include <stdio.h>
#include <math.h>
#include "two_link.h"
#include "two_linkf.h"

int main(void)
{
    const double q[TWO_LINK_N] = {0.5, -0.3}, zero[2] = {0};
    const float qf[2] = {0.5f, -0.3f}, zerof[2] = {0};
    double tau[2], p[TWO_LINK_PARAMETERS];
    float tauf[2], pf[TWO_LINKF_PARAMETERS];
    for (int k = 0; k < TWO_LINK_PARAMETERS; k++)
        p[k] = two_link_default_parameters[k];
    if (p[TWO_LINK_PARAMETER_payload] != 0.5 || !isnan(p[TWO_LINK_PARAMETER_lost]))
        return 1;
    p[TWO_LINK_PARAMETER_lost] = 0.25;
    pf[TWO_LINKF_PARAMETER_payload] = 0.5f;
    pf[TWO_LINKF_PARAMETER_lost] = 0.25f;
    if (two_link_fault() || two_linkf_fault())
        return 2;
    two_link_tau(q, zero, zero, p, tau);
    two_linkf_tau(qf, zerof, zerof, pf, tauf);
    printf("%.17g %.17g %.9g %.9g\n", tau[0], tau[1], (double)tauf[0], (double)tauf[1]);
    printf("%s %s %g\n", TWO_LINK_VERSION, TWO_LINK_MODEL, two_link_q_max[0]);
    return 0;
}
"""
PROJECT = """
cmake_minimum_required(VERSION 3.15)
project(user LANGUAGES C CXX)
find_package(two_link REQUIRED)
find_package(two_linkf REQUIRED)
add_executable(user user.c)
target_link_libraries(user PRIVATE two_link::two_link two_linkf::two_linkf)
"""


def printed_by_user(printed):
    """Torques, and the version and model, of what the user's program printed."""
    numbers, said = printed.strip().splitlines()[-2:]
    tau = np.array(numbers.split(), float)
    kernel = mc.compile(two_link(payload=0.5, lost=None), backend="numpy")
    expected = kernel.tau([0.5, -0.3], [0, 0], [0, 0], {"lost": 0.25})
    np.testing.assert_allclose(tau[:2], expected, rtol=1e-12)
    np.testing.assert_allclose(tau[2:], expected, rtol=1e-5)
    version, digest, limit = said.split()
    assert version == moro.__version__
    assert re.fullmatch("[0-9a-f]{64}", digest)
    assert float(limit) == math.inf


@needs("cmake", "cc", "c++")
@pytest.mark.parametrize("shared", ["OFF", "ON"])
def test_find_package_with_double_and_float_of_one_arm(copy, tmp_path, shared):
    for name in ("tau", "tauf"):
        folder = copy(name)
        run("cmake", "-B", "build", f"-DBUILD_SHARED_LIBS={shared}", cwd=folder)
        run("cmake", "--build", "build", cwd=folder)
        run("ctest", "--test-dir", "build", cwd=folder)
        run("cmake", "--install", "build", "--prefix", tmp_path / "place", cwd=folder)
    user = tmp_path / "user"
    user.mkdir()
    (user / "user.c").write_text(USER)
    (user / "CMakeLists.txt").write_text(PROJECT)
    run("cmake", "-B", "build", f"-DCMAKE_PREFIX_PATH={tmp_path / 'place'}", cwd=user)
    run("cmake", "--build", "build", cwd=user)
    printed_by_user(run("build/user", cwd=user))


@needs("make", "cc", "pkg-config")
def test_pkg_config(copy, tmp_path):
    for name in ("tau", "tauf"):
        run("make", "install", f"PREFIX={tmp_path / 'place'}", cwd=copy(name))
    (tmp_path / "user.c").write_text(USER)
    path = {"PKG_CONFIG_PATH": str(tmp_path / "place/lib/pkgconfig")}
    flags = run("pkg-config", "--cflags", "--libs", "two_link", "two_linkf", cwd=tmp_path, **path)
    run("cc", "-std=c99", *STRICT, "user.c", *flags.split(), "-lm", "-o", "user", cwd=tmp_path)
    libraries = str(tmp_path / "place/lib")
    printed_by_user(
        run("./user", cwd=tmp_path, LD_LIBRARY_PATH=libraries, DYLD_LIBRARY_PATH=libraries)
    )


@needs("c++")
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_the_header_is_good_for_cpp(copy, standard):
    folder = copy("tau")
    (folder / "user.cpp").write_text(
        '#include "two_link.h"\nint n() { return TWO_LINK_N + TWO_LINK_PARAMETER_payload; }\n'
    )
    run("c++", f"-std={standard}", *STRICT, "-c", "user.cpp", cwd=folder)


def test_the_words_of_others_stay_words(tmp_path):
    """Names and summaries with what C, make and Doxygen call something else."""
    evil = '*/ #error "x" ??/ \\ @param \u202e λ'
    model = two_link(payload=0.5).model()
    named = [replace(x, name=n) for x, n in zip(model.coordinates, ('a"b\\n', evil), strict=True)]
    function = mc.Function("own", model.qs[0], evil, unit="*/")
    model = replace(model, coordinates=tuple(named))
    (folder,) = mc.export(model, tmp_path, functions=(function,))
    run("make", "check", "CFLAGS=-O0 " + " ".join(STRICT), cwd=folder)


def test_limits_and_names(exports):
    source = (exports("puma") / "puma560.c").read_text()
    low = re.search(r"puma560_q_min\[6\] = \{(.*?)\}", source, re.S)[1].split(",")
    assert np.allclose([float(x) for x in low], np.radians([-160, -45, -225, -110, -100, -266]))


def test_states_of_reference(exports, tmp_path):
    """The numbers are those of moro's own kernel."""
    kernel = mc.compile(moro.load("puma560"), ("tau",), tmp_path)
    run("cc", "-shared", "-fPIC", "-O2", exports("puma") / "puma560.c", "-lm", "-o", "arm.so",
        cwd=tmp_path)  # fmt: skip
    library = ctypes.CDLL(str(tmp_path / "arm.so"))
    for state in zip(*states(6), strict=True):
        tau = np.empty(6)
        library.puma560_tau(*(ctypes.c_void_p(x.ctypes.data) for x in (*state, tau)))
        np.testing.assert_allclose(tau, kernel.tau(*state), rtol=1e-12)
