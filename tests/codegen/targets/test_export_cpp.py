"""The export in C++, used with arrays, spans and Eigen, from C++17 on, by GCC and Clang."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from exports import STRICT, needs, run, two_link

import moro_codegen as mc
from moro.abc import q1

FUNCTIONS = (
    "tau",
    "inertia_matrix",
    ("tau", "inertia_matrix"),
    "jacobian",
    "kinetic_energy",
    mc.Function("this_one", q1, unit="*/ \\ \n#error"),
)
COMPILERS = [pytest.param(name, marks=needs(name)) for name in ("g++", "clang++")]
EIGEN = [
    path
    for path in map(Path, ("/usr/include/eigen3", "/usr/local/include/eigen3",
                           "/opt/homebrew/include/eigen3"))
    if path.is_dir()
]  # fmt: skip

USER = r"""
#include "two_link.hpp"

#include <cmath>
#include <cstdio>

static_assert(two_link::n == 2 && two_link::joint_names.size() == 2);
static_assert(two_link::q_min[0] < -1e300 && two_link::q_max[1] > 1e300);
static_assert(two_link::default_parameters[two_link::parameter::payload] == 0.5);
static_assert(two_link::version.size() > 0 && two_link::model.size() == 64);

int main()
{
    if (two_link::fault())
        return 1;
    const two_link::Vector<2> q{0.5, -0.3};
    const double qd[2] = {1.0, 2.0};
    std::array<double, 1> parameters = two_link::default_parameters;
    const auto both = two_link::tau_inertia_matrix(q, qd, q, parameters);
    two_link::Vector<2> tau;
    two_link::Matrix<2, 2> M;
    two_link::tau_inertia_matrix(q, qd, q, parameters, tau, M);
    if (both.tau != tau || both.M.entries != M.entries || tau != two_link::tau(q, qd, q))
        return 2;
    double K;
    two_link::kinetic_energy(q, qd, parameters, K);
    if (K != two_link::kinetic_energy(q, qd) || two_link::this_one(q) != 0.5)
        return 3;
    parameters[two_link::parameter::payload] = 2.0;
    tau = two_link::tau(q, qd, q, parameters);
    std::printf("%.17g %.17g %.17g %.17g", tau[0], tau[1], M(0, 1), K);
#ifdef SPANS
    const std::span<const double, 2> view(q);
    if (two_link::tau(view, std::span(qd), view, parameters) != tau)
        return 4;
    double row[8];
    two_link::tau(q, qd, q, parameters, std::span(row).subspan<2, 2>());
    if (row[2] != tau[0] || row[3] != tau[1])
        return 5;
#endif
#ifdef TWO_LINK_EIGEN
    Eigen::VectorXd x(5);
    x << 9.0, 0.5, -0.3, 1.0, 2.0;
    const Eigen::Vector2d qe(0.5, -0.3), qde = x.tail<2>();
    Eigen::Vector2d te;
    two_link::tau(qe, qde, x.segment<2>(1), parameters, te);
    if (te[0] != tau[0] || te != two_link::eigen(tau))
        return 6;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> Me;
    two_link::inertia_matrix(qe, two_link::default_parameters, Me);
    two_link::tau(qe, x.tail(2), qe, parameters, x.segment(0, 2));
    if (Me != two_link::eigen(M) || x[0] != tau[0] || x[1] != tau[1])
        return 7;
    std::puts("\nwith Eigen");
#endif
    return 0;
}
"""


@pytest.fixture(scope="module")
def export(tmp_path_factory):
    robot = two_link(payload=0.5)
    return mc.export(robot, tmp_path_factory.mktemp("cpp"), ("cpp",), FUNCTIONS)[0]


def built(export, folder, *command):
    shutil.copytree(export, folder, dirs_exist_ok=True)
    (folder / "user.cpp").write_text(USER)
    run("cc", "-std=c99", "-O1", "-c", "two_link.c", cwd=folder)
    run(*command, "user.cpp", "two_link.o", "-lm", "-o", "user", cwd=folder)
    return run("./user", cwd=folder)


@needs("cc")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_arrays_and_constants(export, tmp_path, compiler):
    printed = built(export, tmp_path, compiler, "-std=c++17", *STRICT)
    kernel = mc.compile(two_link(payload=0.5), FUNCTIONS[:5], tmp_path / "kernels", "numpy")
    q, qd = [0.5, -0.3], [1.0, 2.0]
    expected = [
        *kernel.tau(q, qd, q, {"payload": 2}),
        kernel.inertia_matrix(q)[0, 1],
        kernel.kinetic_energy(q, qd),
    ]
    np.testing.assert_allclose(np.array(printed.split(), float), expected, rtol=1e-12)


@needs("cc")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_spans(export, tmp_path, compiler):
    (tmp_path / "has.cpp").write_text("#include <span>\nint main() { return 0; }\n")
    try:
        run(compiler, "-std=c++20", "-c", "has.cpp", cwd=tmp_path)
    except AssertionError:
        pytest.skip(f"{compiler} has no <span> on this machine")
    assert built(export, tmp_path, compiler, "-std=c++20", "-DSPANS", *STRICT)


@needs("cc")
@pytest.mark.skipif(not EIGEN, reason="Eigen is not installed on this machine")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_eigen(export, tmp_path, compiler):
    command = (compiler, "-std=c++17", *STRICT, "-isystem", EIGEN[0])
    assert "with Eigen" in built(export, tmp_path, *command)
    without = built(export, tmp_path, *command, "-DTWO_LINK_NO_EIGEN")
    assert "with Eigen" not in without


@needs("c++")
@pytest.mark.parametrize(
    "wrong",
    [
        "two_link::tau(q, q, std::array<double, 3>{})",
        "two_link::tau(q, q)",
        "two_link::inertia_matrix(q, two_link::default_parameters, q)",
    ],
)
def test_wrong_sizes_do_not_compile(export, tmp_path, wrong):
    text = '#include "two_link.hpp"\nvoid f() {{ two_link::Vector<2> q{{}}; {}; }}\n'
    command = ("c++", "-std=c++17", "-I", export, "-c", "user.cpp")
    (tmp_path / "user.cpp").write_text(text.format("two_link::tau(q, q, q)"))
    run(*command, cwd=tmp_path)
    (tmp_path / "user.cpp").write_text(text.format(wrong))
    run(*command, cwd=tmp_path, fails=True)


def test_what_no_namespace_may_be_called(tmp_path):
    with pytest.raises(ValueError, match=r"cannot be called 'class': give another prefix"):
        mc.export(two_link(), tmp_path, ("c", "cpp"), prefix="class")
    assert not list(tmp_path.iterdir())


@needs("cmake", "c++")
def test_cmake_installs_the_header(export, tmp_path):
    shutil.copytree(export, tmp_path / "arm")
    place = tmp_path / "place"
    run("cmake", "-S", "arm", "-B", "build", cwd=tmp_path)
    run("cmake", "--build", "build", cwd=tmp_path)
    run("ctest", "--test-dir", "build", cwd=tmp_path)
    run("cmake", "--install", "build", "--prefix", place, cwd=tmp_path)
    (tmp_path / "user.cpp").write_text(USER)
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.15)\nproject(user LANGUAGES C CXX)\n"
        "find_package(two_link REQUIRED)\nadd_executable(user user.cpp)\n"
        "target_compile_features(user PRIVATE cxx_std_17)\n"
        "target_link_libraries(user PRIVATE two_link::two_link)\n"
    )
    run("cmake", "-B", "user", f"-DCMAKE_PREFIX_PATH={place}", cwd=tmp_path)
    run("cmake", "--build", "user", cwd=tmp_path)
    assert run("user/user", cwd=tmp_path)
