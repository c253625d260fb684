"""Long routines in parts: each part gets what it reads, and the numbers stay right."""

import subprocess
from functools import partial

import numpy as np
import pytest
from arms import random_model, reference_model
from programs import evaluate, everything_program

from moro_codegen.backends import c_text as c
from moro_codegen.backends.toolchain import LONG, find_compiler
from moro_codegen.emit.parts import Keep, Take, in_parts
from moro_codegen.emit.statements import Assign, Call, Load, ReduceAngles, RoutineBody, Sines, body
from moro_codegen.pipeline import build
from moro_codegen.program import generate

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")


@pytest.fixture(params=[1, 5, 40])
def length(request, monkeypatch):
    """Let the C of every program be divided, into parts of so many statements."""
    monkeypatch.setattr(c, "in_parts", partial(in_parts, length=request.param))
    return request.param


def test_short_routines_stay_whole():
    program = generate(reference_model("panda"))
    text = body(program, program.routines[0], ())
    parts = in_parts(text)
    assert parts.steps == (text.statements,)
    assert parts.room == 0


@pytest.mark.parametrize("length", [1, 2, 13, 100])
def test_every_value_is_where_it_is_read(length):
    """Carry the steps out by name: nothing is read that its own part does not know."""
    program = generate(reference_model("puma560"))
    text = body(program, program.routines[0], ())
    parts = in_parts(text, length)
    statements = [s for s in text.statements if not isinstance(s, Load)]
    assert len(parts.steps) == max(1, round(len(statements) / length))
    done, places, kept = [], {}, 0
    for steps in parts.steps:
        known = set()
        for step in steps:
            match step:
                case Load(name):
                    known.add(name)
                case Take(name, place):
                    assert places[place] == name
                    known.add(name)
                case Keep(name, place):
                    assert name in known
                    assert place < parts.room
                    places[place] = name
                    kept += 1
                case Sines(angles, pairs, _):
                    assert known.issuperset(read(angles))
                    known.update(name for pair in pairs for name in pair)
                case ReduceAngles(names, angles, _):
                    assert known.issuperset(read(angles))
                    known.update(names)
                case Assign(name, expression):
                    assert known.issuperset(read([expression]))
                    known.add(name)
                case Call(name, _, arguments):
                    assert known.issuperset(read(arguments))
                    known.add(name)
            if not isinstance(step, (Load, Take, Keep)):
                done.append(step)
    assert done == statements
    assert known.issuperset(read(text.results))
    assert parts.room < kept or not kept


def read(expressions):
    """Names in expressions of C."""
    tokens = " ".join(expressions)
    for symbol in "()+-*/,":
        tokens = tokens.replace(symbol, " ")
    return {token for token in tokens.split() if token[0].isalpha()}


def test_an_empty_routine():
    assert in_parts(RoutineBody((), ("0.0",)), 1).steps == ((),)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_numbers(tmp_path, monkeypatch, length, compiler):
    """Batches are single calls to the last bit, and both are what the graph says."""
    monkeypatch.setenv("CC", compiler)
    try:
        find_compiler()
    except RuntimeError:
        pytest.skip(f"no {compiler} on this machine")
    rng = np.random.default_rng(length)
    program = generate(random_model(rng, 5))
    kernel = build(program, tmp_path / "arm")
    assert "arm_tau_lanes_part_1(" in kernel.source.read_text()
    q, qd, qdd = rng.uniform(-3, 3, (3, 27, 5))
    tau = kernel.tau(q, qd, qdd)
    assert np.array_equal(tau, [kernel.tau(*rows) for rows in zip(q, qd, qdd, strict=True)])
    (expected,) = evaluate(program.routines[0], q, qd, qdd)
    scale = np.abs(expected).max(axis=1, keepdims=True)
    assert np.abs((tau - expected) / scale).max() < 1e-13


def test_every_operation(tmp_path, length):
    program = everything_program()
    kernel = build(program, tmp_path / "arm")
    rng = np.random.default_rng(length)
    q, qd, parameters = *rng.uniform(-2, 2, (2, 19, 3)), rng.uniform(0.5, 2, (19, 2))
    results = kernel.everything(q, qd, parameters)
    expected = evaluate(program.routines[0], q, qd, parameters=parameters)
    for k, (result, right) in enumerate(zip(results, expected, strict=True)):
        assert np.abs(result - right).max() < 1e-13 * max(1, np.abs(right).max())
        single = [kernel.everything(*rows)[k] for rows in zip(q, qd, parameters, strict=True)]
        assert np.array_equal(result, single)


@pytest.mark.parametrize("flags", [(), ("-DMORO_PLAIN_C",)])
def test_no_warnings(tmp_path, length, flags):
    for program in (everything_program(), generate(reference_model("two_link"))):
        for name, text in c.emit(program).items():
            (tmp_path / name).write_text(text)
        command = ["cc", *STRICT, *flags, "-O1", "-c", f"{program.name}.c"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_results_may_share_memory_with_inputs(tmp_path, length):
    """The last part alone writes results, when all inputs are read."""
    kernel = build(generate(reference_model("puma560")), tmp_path / "arm")
    source = kernel.source.read_text()
    last_load = source.index("const double qdd1 = qdd[0];")
    assert last_load < source.index("tau[0] = ")
    parts = source[: source.index("void puma560_tau(")]
    assert "tau[" not in parts


def test_long_programs_are_compiled_quickly(tmp_path, monkeypatch):
    from moro_codegen.backends import toolchain as module

    short = build(generate(reference_model("two_link")), tmp_path / "arm")
    assert "-O1" not in short.manifest["compiler"]["flags"]
    monkeypatch.setattr(module, "LONG", 10)
    long = build(generate(reference_model("two_link")), tmp_path / "arm")
    assert not long.reused
    flags = long.manifest["compiler"]["flags"]
    assert flags.index("-O1") > flags.index("-O3")
    x = np.random.default_rng(0).uniform(-1, 1, (3, 20, 2))
    assert np.allclose(long.tau(*x), short.tau(*x), rtol=1e-13, atol=1e-13)
    assert sum(long.ops["tau"].values()) < LONG
