"""Long routines in parts: each part gets what it reads, and the numbers stay right."""

import platform
import re
import subprocess
from collections import Counter
from functools import partial

import numpy as np
import pytest
from arms import random_model, reference_model
from exports import needs, run
from programs import evaluate, everything_program

from moro_codegen.backends import c_text as c
from moro_codegen.backends.toolchain import LONG, QUICK, find_compiler
from moro_codegen.emit.parts import ANGLES, Give, Keep, Take, in_parts, ordered
from moro_codegen.emit.statements import (
    Assign,
    Call,
    Identifiers,
    Load,
    ReduceAngles,
    RoutineBody,
    Sines,
    body,
)
from moro_codegen.pipeline import build
from moro_codegen.program import generate

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")


@pytest.fixture(params=[1, 5, 20])
def length(request, monkeypatch):
    """Let the C of every program be divided, into parts of so many statements."""
    monkeypatch.setattr(c, "in_parts", partial(in_parts, length=request.param))
    return request.param


def divided(program, length):
    """The routine's statements, and its parts."""
    (routine,) = program.routines
    text = body(program, routine, ())
    sizes = [(a.name, a.size) for a in program.signature(routine).inputs]
    return text, in_parts(text, sizes, length)


def test_short_routines_stay_whole():
    text, parts = divided(generate(reference_model("panda")), 500)
    (steps,) = parts.steps
    assert sorted(map(repr, steps)) == sorted(map(repr, text.statements))
    assert parts.room == 0


@pytest.mark.parametrize("arm", ["puma560", "everything"])
@pytest.mark.parametrize("length", [1, 2, 13, 100, 1000])
def test_every_value_is_where_it_is_read(arm, length):
    """Carry the steps out by name: nothing is read that its own part does not know."""
    program = everything_program() if arm == "everything" else generate(reference_model(arm))
    text, parts = divided(program, min(length, 13) if arm == "everything" else length)
    statements = [s for s in text.statements if not isinstance(s, Load)]
    inputs = program.signature(program.routines[0]).inputs
    places = dict(enumerate((a.name, k) for a in inputs for k in range(a.size)))
    first = {a.name: sum(b.size for b in inputs[:i]) for i, a in enumerate(inputs)}
    done, given, kept = [], {}, 0
    for steps in parts.steps:
        known = set()
        for step in steps:
            match step:
                case Load(name, argument, index):
                    assert places[first[argument] + index] == (argument, index)
                    known.add(name)
                case Take(name, place):
                    assert places[place] == name
                    known.add(name)
                case Keep(name, place):
                    assert name in known
                    assert place < parts.room
                    places[place] = name
                    kept += 1
                case Give(name, index):
                    assert name in known
                    assert index not in given
                    given[index] = name
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
            if not isinstance(step, (Load, Take, Keep, Give)):
                done.append(step)
    assert Counter(done) == Counter(statements)
    if len(parts.steps) > 1:
        others = {k: name for k, name in enumerate(text.results) if k not in given}
        assert known.issuperset(read(others.values()))
        assert all(text.results[k] == name for k, name in given.items())
        assert not any(name in known for name in others.values() if name not in loaded(text))
        assert parts.room < kept + sum(a.size for a in inputs)


def loaded(text):
    return {s.name for s in text.statements if isinstance(s, Load)}


def test_few_values_wait():
    """In the order of parts; and angles are taken a few at a time, with arrays of their own."""
    n = 20 * ANGLES
    names = [f"q{k}" for k in range(n)]
    pairs = tuple((f"s{k}", f"c{k}") for k in range(n))
    loads = [Load(name, "q", k) for k, name in enumerate(names)]
    products = [Assign(f"p{k}", f"s{k} * c{k}") for k in range(n)]
    sums = [Assign(f"a{k}", f"{f'a{k - 1} + ' if k else ''}p{k}") for k in range(n)]
    sines = Sines(tuple(names), pairs, ("angle", "sine", "cosine"))
    text = RoutineBody((*loads, sines, *products, *sums), (f"a{n - 1}",), Identifiers(["angle"]))
    parts = in_parts(text, [("q", n)], 40)
    assert parts.room == n  # what waits lies where inputs were
    pieces = [step for steps in parts.steps for step in steps if isinstance(step, Sines)]
    assert [len(s.angles) for s in pieces] == [ANGLES] * 20
    assert len({name for s in pieces for name in s.arrays}) == 60
    shared = [Assign(f"p{k}", f"x * {k}") for k in range(n)]
    order = ordered([*shared, *sums], text.results)
    assert order == [x for pair in zip(shared, sums, strict=True) for x in pair]


def read(expressions):
    """Names in expressions of C."""
    tokens = " ".join(expressions)
    for symbol in "()+-*/,":
        tokens = tokens.replace(symbol, " ")
    return {token for token in tokens.split() if token[0].isalpha()}


def test_an_empty_routine():
    assert in_parts(RoutineBody((), ("0.0",)), (), 1).steps == ((),)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_numbers(tmp_path, monkeypatch, length, compiler):
    """Batches are single calls to the last bit, and both are what the graph says.

    Also where so little stack is allowed that there are few lanes.
    """
    monkeypatch.setenv("CC", compiler)
    monkeypatch.setattr(c, "STACK", c.STACK if length == 20 else 1)
    try:
        find_compiler()
    except RuntimeError:
        pytest.skip(f"no {compiler} on this machine")
    rng = np.random.default_rng(length)
    program = generate(random_model(rng, 5))
    kernel = build(program, tmp_path / "arm")
    assert "arm_tau_lanes_part_1(" in kernel.source.read_text()
    assert ("Fewer lanes" in kernel.source.read_text()) == (length != 20)
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


@pytest.mark.sweep
@pytest.mark.skipif(platform.machine() != "x86_64", reason="is for registers of x86")
@needs("gcc")
def test_the_stack_of_batches_of_long_arms(tmp_path):
    """Below 32 kB, where registers are large; and short routines keep all lanes."""
    model = random_model(np.random.default_rng(5), 48, tree=True)
    for name, text in c.emit(generate(model, ("tau", "gravity_vector"))).items():
        (tmp_path / name).write_text(text)
    command = ("-std=c99", *QUICK["gcc"], "-march=x86-64-v4", "-fstack-usage", "-c", "arm.c")
    run("gcc", *command, cwd=tmp_path)
    sizes = re.findall(r":([\w.]+)\t(\d+)", (tmp_path / "arm.su").read_text())
    taken = {name: int(size) for name, size in sizes}
    whole = sum(size for name, size in taken.items() if re.match("arm_tau_(batch|lanes)$", name))
    part = max(size for name, size in taken.items() if "arm_tau_lanes_part" in name)
    assert 8_000 < whole + part < 32_768
    text = (tmp_path / "arm.c").read_text()
    short, fewer, long = map(text.index, ("arm_gravity_vector_batch(", "Fewer", "arm_tau_batch("))
    assert short < fewer < long
