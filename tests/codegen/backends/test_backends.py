"""Backends are objects: one made outside, as CONTRIBUTING says, is as good as those of moro."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from programs import everything_program, files

import moro as mr
import moro_codegen as mc
from moro.abc import q1
from moro_codegen import registry
from moro_codegen.backends import Backend, Opened, get, register
from moro_codegen.emit.describe import docstring
from moro_codegen.emit.statements import Assign, Call, Load, ReduceAngles, Sines, body

MATH = {"atan2": "arctan2", "asin": "arcsin", "acos": "arccos", "atan": "arctan", "fabs": "abs"}


class Toy(Backend):
    """Lines ``name = expression`` that Python runs with NumPy, one text for all functions."""

    name = "toy"
    reserved = frozenset({"toy_word", "np"})

    def emit(self, program):
        texts = [self.routine(program, routine) for routine in program.routines]
        return {f"{program.name}.lines": "\n---\n".join(texts)}

    def routine(self, program, routine):
        inputs = {a.name: a for a in program.signature(routine).inputs}
        text = body(program, routine, {*self.reserved, *inputs, "results"})
        lines = [line for statement in text.statements for line in self.lines(statement, inputs)]
        return "\n".join([*lines, f"results = [{', '.join(text.results)}]"])

    def lines(self, statement, inputs):
        match statement:
            case Load(name, argument, index):
                place = np.unravel_index(index, inputs[argument].sizes)
                yield f"{name} = {argument}[..., {', '.join(map(str, place))}]"
            case Assign(name, expression):
                yield f"{name} = {expression}"
            case Call(name, function, arguments):
                yield f"{name} = np.{MATH.get(function, function)}({', '.join(arguments)})"
            case ReduceAngles(names, angles, _):
                yield from map("{} = {}".format, names, angles)
            case Sines(angles, pairs, _):
                for angle, pair in zip(angles, pairs, strict=True):
                    for name, function in zip(pair, ("sin", "cos"), strict=True):
                        yield f"{name or '_'} = np.{function}({angle})"

    def loaded(self, folder, name):
        return folder / f"{name}.lines"

    def open(self, folder, content):
        texts = content.decode().split("\n---\n")
        functions = [
            (name, s.calls.function(s.calls.in_chunks(self.function(s, text)), docstring(s)[0]))
            for (name, s), text in zip(folder.signatures.items(), texts, strict=True)
        ]
        return Opened(self.loaded(folder.path, folder.name), functions)

    def function(self, signature, text):
        def of_arrays(*arrays):
            names = {a.name: x for a, x in zip(signature.inputs, arrays, strict=True)}
            exec(text, {"np": np}, names)  # noqa: S102 - what it wrote itself
            cores = zip(arrays, signature.inputs, strict=True)
            samples = np.broadcast_shapes(*(x.shape[: x.ndim - len(a.shape)] for x, a in cores))
            found = iter(names["results"])
            flat = [
                np.stack([np.broadcast_to(next(found), samples) for _ in range(a.size)], axis=-1)
                for a in signature.outputs
            ]
            shapes = [samples + a.sizes for a in signature.outputs]
            results = [x.reshape(shape) for x, shape in zip(flat, shapes, strict=True)]
            return results if len(results) > 1 else results[0]

        return of_arrays


@pytest.fixture
def toy():
    backend = Toy()
    register(backend)
    yield backend
    registry.BACKENDS.remove("toy")


def test_what_it_writes_computes_what_numpy_does(toy, tmp_path):
    ours, theirs = (mc.build(everything_program(), tmp_path / b, b) for b in ("numpy", "toy"))
    q, qd = np.random.default_rng(0).uniform(-2, 2, (2, 4, 3))
    for x, y in zip(ours.everything(q, qd, [2, 3]), theirs.everything(q, qd, [2, 3]), strict=True):
        np.testing.assert_allclose(x, y, rtol=1e-13)
    with pytest.raises(ValueError, match=r"q \(the vector q\) must have shape"):
        theirs.everything([1, 2], [1, 2, 3], [2, 3])


FUNCTIONS = (
    "tau", "jacobian", "inertia_matrix", "forward_dynamics", "tau_derivatives", "regressor",
)  # fmt: skip


def test_functions_are_verified(toy, tmp_path):
    robot = mr.load("puma560")
    kernel = mc.compile(robot, functions=FUNCTIONS, directory=tmp_path, backend="toy")
    assert kernel.backend == "toy"
    assert kernel.library is None
    assert kernel.source.suffix == ".lines"
    assert mc.verify(kernel, robot).passed
    again = mc.compile(robot, functions=FUNCTIONS, directory=tmp_path, backend="toy")
    assert again.reused


def test_the_command_knows_it(tmp_path):
    """Where it is registered before the command is imported."""
    words = ["two_link", "--backend", "toy", "--no-benchmark"]
    program = (
        "from test_backends import Toy, register\nregister(Toy())\n"
        f"from moro_codegen.cli import main\nmain({words})"
    )
    here = Path(__file__).parent
    path = os.pathsep.join(map(str, (here, here.parents[1] / "support")))
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env=os.environ | {"PYTHONPATH": path},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "verified" in done.stdout
    assert files(tmp_path / "build/two_link") == ["manifest.json", "two_link.lines"]


def test_its_words_are_reserved(toy, tmp_path):
    with pytest.raises(ValueError, match="cannot be named 'toy_word': generated code uses"):
        mc.Function("toy_word", q1)
    registry.BACKENDS.remove("toy")
    own = mc.Function("toy_word", sp.sin(q1))
    register(toy)
    with pytest.raises(ValueError, match="cannot be named 'toy_word': generated code uses"):
        mc.compile(mr.load("two_link"), (own,), tmp_path, backend="toy")
    assert files(tmp_path) == []


def test_damage_is_seen_and_kernels_of_forgotten_backends_are_not_opened(toy, tmp_path):
    kernel = mc.build(everything_program(), tmp_path / "arm", "toy")
    kernel.source.write_text("results = []")
    with pytest.raises(ValueError, match=r"all_ops.lines is not the file"):
        mc.Kernel(kernel.directory)
    mc.build(everything_program(), tmp_path / "arm", "toy")
    registry.BACKENDS.remove("toy")
    with pytest.raises(ValueError, match='backend must be "c", "cython" or "numpy", not \'toy\''):
        mc.Kernel(kernel.directory)
    register(toy)


def test_names_belong_to_one(toy):
    with pytest.raises(ValueError, match="there is a backend 'toy' already"):
        register(Toy())
    with pytest.raises(ValueError, match="there is a backend 'c' already"):
        register(type("Other", (Toy,), {"name": "c"})())
    with pytest.raises(ValueError, match='backend="toy" is for every processor'):
        mc.build(everything_program(), "nowhere", "toy", arch="x86-64-v3")
    assert get("toy") is toy
