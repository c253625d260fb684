"""The emitted C as C: it compiles without a warning, is called from C, and says what it is."""

import re
import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest
from arms import NAMES, reference_model, reference_states
from programs import EVERYTHING, evaluate, everything_program, program, vector

from moro_codegen.backends.c_text import emit
from moro_codegen.backends.toolchain import find_compiler
from moro_codegen.functions.function import Function
from moro_codegen.program import generate

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
COMPILERS = [name for name in ("cc", "gcc", "clang") if shutil.which(name)]
#: as it comes, for this processor, without vectors
TARGETS = ((), ("-march=native",), ("-DMORO_PLAIN_C",))


def write(program, folder):
    for name, text in emit(program).items():
        (folder / name).write_text(text)
    return folder / f"{program.name}.c"


def run(*command, cwd):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def gantry():
    """No angle, no sign, a result that is a constant and one that is an input."""
    return program(
        Function(
            "sum",
            (vector("q"), vector("qd")),
            (vector("y", 3),),
            "A sum.",
            lambda system, q, qd: [[q[0] + q[1], q[2], system.graph.constant(2)]],
        ),
        name="gantry",
    )


def test_there_is_a_compiler():
    assert COMPILERS


@pytest.mark.parametrize("flags", TARGETS)
@pytest.mark.parametrize("compiler", COMPILERS)
def test_no_warnings(tmp_path, compiler, flags):
    arms = [generate(reference_model(name)) for name in ("puma560", "two_link")]
    for one in (*arms, everything_program(), gantry()):
        source = write(one, tmp_path)
        run(compiler, *STRICT, *flags, "-O1", "-c", source.name, cwd=tmp_path)


@pytest.mark.parametrize("name", NAMES)
def test_no_warnings_when_optimised(tmp_path, name):
    source = write(generate(reference_model(name)), tmp_path)
    run("cc", *STRICT, "-O2", "-march=native", "-c", source.name, cwd=tmp_path)


def test_the_header_is_good_for_cpp(tmp_path):
    compiler = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        pytest.skip("no C++ compiler on this machine")
    source = write(everything_program(), tmp_path)
    run("cc", "-std=c99", "-c", source.name, "-o", "kernel.o", cwd=tmp_path)
    (tmp_path / "main.cpp").write_text(
        '#include "all_ops.h"\n'
        "int main() {\n"
        "    const double q[3] = {0, 0, 0}, qd[3] = {0, 0, 0}, parameters[2] = {1, 0};\n"
        "    double M[6], v[3], energy;\n"
        "    all_ops_everything(q, qd, parameters, M, v, &energy);\n"
        "    return 0;\n"
        "}\n"
    )
    run(compiler, "-Wall", "-Wextra", "-Werror", "main.cpp", "kernel.o", "-o", "main", cwd=tmp_path)
    run("./main", cwd=tmp_path)


MAIN = """
#include <stdio.h>
#include "{name}.h"
#define N {n}
#define COUNT {count}
static const double states[COUNT][3 * N] = {{ {states} }};
int main(void)
{{
    double tau[N], all[COUNT][N];
    for (int k = 0; k < COUNT; k++) {{
        {name}_tau(states[k], states[k] + N, states[k] + 2 * N, tau);
        for (int i = 0; i < N; i++)
            printf("%.17g ", tau[i]);
    }}
    {name}_tau_batch(COUNT, states[0], 3 * N, 1, states[0] + N, 3 * N, 1,
                     states[0] + 2 * N, 3 * N, 1, all[0], N, 1);
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < N; i++)
            printf("%.17g ", all[k][i]);
    return 0;
}}
"""


@pytest.mark.parametrize("flags", [("-O2",), ("-O3", "-march=native"), ("-O1", "-DMORO_PLAIN_C")])
def test_called_from_c(tmp_path, flags):
    """Numbers of shared/reference, through the single and through the batch function."""
    states = reference_states("panda")
    rows = [[*s["q"], *s["qd"], *s["qdd"]] for s in states]
    write(generate(reference_model("panda")), tmp_path)
    numbers = ", ".join("{" + ", ".join(map(repr, row)) + "}" for row in rows)
    (tmp_path / "main.c").write_text(
        MAIN.format(name="panda", n=7, count=len(states), states=numbers)
    )
    run("cc", *STRICT, *flags, "main.c", "panda.c", "-lm", "-o", "main", cwd=tmp_path)
    printed = np.array(run("./main", cwd=tmp_path).split(), float)
    tau = np.array([s["tau"] for s in states])
    single, batch = printed.reshape(2, len(states), 7)
    scale = np.abs(tau).max(axis=1, keepdims=True)
    assert np.abs((single - tau) / scale).max() < 1e-12
    assert np.array_equal(single, batch)


def test_results_may_share_memory_with_inputs(tmp_path):
    one = program(
        Function(
            "rotate",
            (vector("q"),),
            (vector("y", 3),),
            "A rotation of the components.",
            lambda system, q: [[q[1], q[2] + 0.5, q[0]]],
        ),
        name="turn",
    )
    write(one, tmp_path)
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "turn.h"\n'
        "int main(void)\n{\n    double q[3] = {1, 2, 3};\n    turn_rotate(q, q);\n"
        '    printf("%g %g %g", q[0], q[1], q[2]);\n    return 0;\n}\n'
    )
    run("cc", *STRICT, "-O2", "main.c", "turn.c", "-lm", "-o", "main", cwd=tmp_path)
    assert run("./main", cwd=tmp_path) == "2 3.5 1"


SANITIZED = """
#include <stdlib.h>
#include <string.h>
#include "all_ops.h"
#define D sizeof(double)
/* arrays of just the size that is needed, in rows, in columns and backwards, one for all samples */
int main(void)
{
    for (ptrdiff_t n = 0; n <= 20; n++) {
        double *q = malloc(3 * n * D), *qd = malloc(3 * n * D), *parameters = malloc(2 * D);
        double *M = malloc(6 * n * D), *v = malloc(3 * n * D), *energy = malloc(n * D);
        for (ptrdiff_t i = 0; i < 3 * n; i++) {
            q[i] = (double)i;
            qd[i] = 1.0 - (double)i;
        }
        parameters[0] = parameters[1] = 0.5;
        all_ops_everything_batch((size_t)n, q, 3, 1, qd, 3, 1, parameters, 0, 1,
                                 M, 6, 3, 1, v, 3, 1, energy, 1);
        all_ops_everything_batch((size_t)n, q, 1, n, qd, 1, n, parameters, 0, 1,
                                 M, 1, 3 * n, n, v, 1, n, energy, 1);
        if (n)
            all_ops_everything_batch((size_t)n, q + 3 * n - 1, -3, -1, qd + 3 * n - 1, -1, -n,
                                     parameters + 1, 0, -1, M + 6 * n - 1, -6, -1, -2,
                                     v + 3 * n - 1, -1, -n, energy + n - 1, -1);
        for (ptrdiff_t i = 0; i < n; i++)
            all_ops_everything(q + 3 * i, qd + 3 * i, parameters, M + 6 * i, v + 3 * i, energy + i);
        free(q), free(qd), free(parameters), free(M), free(v), free(energy);
    }
    return 0;
}
"""


@pytest.mark.parametrize("target", ["-march=native", "-mtune=generic"])
def test_nothing_is_read_or_written_outside(tmp_path, target):
    """Under AddressSanitizer and UndefinedBehaviorSanitizer, for any number of samples."""
    sanitizers = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    tried = subprocess.run(
        ["cc", *sanitizers, "empty.c", "-o", "empty"],
        cwd=tmp_path,
        capture_output=True,
        check=False,
    )
    if tried.returncode != 0:
        pytest.skip("this compiler has no sanitizers")
    source = write(everything_program(), tmp_path)
    (tmp_path / "main.c").write_text(SANITIZED)
    flags = ("-std=c99", "-g", "-O1", target, *sanitizers)
    run("cc", *flags, "main.c", source.name, "-lm", "-o", "main", cwd=tmp_path)
    run("./main", cwd=tmp_path)


def test_nothing_but_math_h():
    for text in emit(generate(reference_model("puma560"))).values():
        included = set(re.findall(r"#include [<\"](.*)[>\"]", text))
        assert included <= {"math.h", "stddef.h", "stdint.h", "sys/auxv.h", "puma560.h"}
        for word in ("malloc", "static double", "static int", "errno"):
            assert word not in text


def test_fast_math_is_refused(tmp_path):
    source = write(gantry(), tmp_path)
    done = subprocess.run(
        ["cc", "-ffast-math", "-c", source],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "fast-math" in done.stderr


def test_the_same_text_every_time():
    texts = [emit(generate(reference_model("puma560"))) for _ in range(2)]
    assert texts[0] == texts[1]


def test_constants_are_shortest_doubles():
    values = (Fraction("0.1"), Fraction(1, 3), 2, 1e-300, Fraction("4318") / 10**4)
    constants = Function(
        "f", (vector("q"),), (vector("y", 5),), "", lambda s, q: [[q[0] * x for x in values]]
    )
    source = emit(program(constants, name="constants"))["constants.c"]
    for text in ("0.1", "0.3333333333333333", "2.0", "1e-300", "0.4318"):
        assert f" = {text} * q1;" in source


def test_statements_have_names_of_the_theory():
    source = emit(generate(reference_model("puma560")))["puma560.c"]
    assert "const double s2 = sine[0], c2 = cosine[0];" in source
    assert "const double qdd6 = qdd[5];" in source
    assert "const double tau6 = " in source
    assert max(map(len, source.splitlines())) <= 110


def test_sums_of_angles_and_matrix_entries_have_names():
    source = emit(everything_program())["all_ops.c"]
    assert "const double s12 = sine[1];" in source
    assert "const double M22 = atan2(" in source


def test_the_header_documents_everything():
    header = emit(everything_program())["all_ops.h"]
    for line in (
        "Every operation there is.",
        "q[3]           [rad]     the vector q",
        "M[2][3]        [kg m^2]  a matrix",
        "energy         [J]       a scalar",
        "parameters[0]  mass, default 2.5",
        "parameters[1]  offset, no default",
        "joint 3: revolute (rad, torque in N m)",
        "sine-cosine",
        "Generated by moro",
        "do not edit",
        "(3),(3),(2)->(2,3),(3),()",
    ):
        assert line in header


def test_names_of_parameters_do_not_collide(tmp_path):
    """Parameters named like joints, temporaries, keywords, functions, or not like C at all."""
    names = (
        "q1",
        "t1",
        "s1",
        "c1",
        "for",
        "sin",
        "lanes",
        "y",
        "m_{1}",
        "m_1",
        "2nd",
        "angle",
        "λ",
    )

    def build(system, q):
        graph = system.graph
        parameters = [graph.input("parameters", k) for k in range(len(names))]
        total = graph.sin(q[0]) * parameters[0]
        for p in parameters[1:]:
            total = total * p + graph.cos(q[0]) * p
        return [[total]]

    one = program(
        Function("f", (vector("q"),), (vector("y", 1),), "A sum.", build),
        parameters=[(name, 1.0) for name in names],
        name="names",
    )
    source = write(one, tmp_path)
    run("cc", *STRICT, "-c", source.name, cwd=tmp_path)


def test_constants_must_be_finite():
    huge = Function("f", (vector("q"),), (vector("y", 1),), "", lambda s, q: [[q[0] * 10**400]])
    with pytest.raises((ValueError, OverflowError), match=r"finite|too large"):
        emit(program(huge))


def test_random_expressions_keep_their_structure(tmp_path):
    """Parentheses: an expression in integers is exact, so the text must give the same integer."""
    rng = np.random.default_rng(7)

    def build(system, q):
        nodes = list(q)
        for _ in range(60):
            a, b = (nodes[i] for i in rng.integers(max(0, len(nodes) - 8), len(nodes), 2))
            operation = rng.integers(5)
            nodes.append(
                a + b if operation == 0 else a - b if operation < 3 else -a if operation == 3
                else a * int(rng.integers(-2, 3))
            )  # fmt: skip
        return [nodes[-12:]]

    one = program(Function("f", (vector("q"),), (vector("y", 12),), "", build), name="tree")
    from moro_codegen.pipeline import build as build_kernel

    kernel = build_kernel(one, tmp_path / "tree")
    q = rng.integers(-9, 10, (20, 3)).astype(float)
    (expected,) = evaluate(one.routines[0], q)
    assert np.abs(expected).max() < 2**53
    assert np.array_equal(kernel.f(q), expected)
    assert np.array_equal([kernel.f(row) for row in q], expected)


def test_the_compiler_in_use_is_one_of_those_tested():
    assert find_compiler().command[0] in COMPILERS


def test_the_hand_made_function_has_every_operation():
    (routine,) = program(EVERYTHING, parameters=(("mass", 1.0), ("offset", 0.0))).routines
    ops = {node.op for node in routine.schedule}
    assert ops == {"add", "sub", "mul", "div", "neg", "sin", "cos", "sign", "call"}
