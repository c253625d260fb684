"""Programs for tests: hand-made functions of every shape, and a plain evaluation of any graph."""

import math
from pathlib import Path

import numpy as np

from moro.model import REVOLUTE, Body, Joint, Model, Placement
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Graph
from moro_codegen.passes import PASSES, Pass
from moro_codegen.program import Program, routine
from moro_codegen.signature import RuntimeParameter

EYE = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def bare_model(n, kind=REVOLUTE):
    """A model with n joints and nothing else: enough for functions that do not ask it."""
    place = Placement(EYE, (0, 0, 0))
    joints = tuple(Joint(kind, i - 1, place) for i in range(n))
    bodies = tuple(Body(0, (0, 0, 0), ((0, 0, 0),) * 3) for _ in range(n))
    return Model("bare", joints, bodies, (0, 0, 0))


def program(*functions, dof=3, parameters=(), name="hand_made"):
    """A program of Functions over one graph, as written; parameters are (name, default) pairs."""
    rearranging = (Pass.COMMON_DIVISORS, Pass.ORDER_OF_ARRIVAL)
    passes = tuple(x for x in PASSES if x not in rearranging)
    system = System(Graph(), bare_model(dof), passes=passes)
    return Program(
        name,
        dof,
        ("revolute",) * dof,
        tuple(RuntimeParameter(name, default, "") for name, default in parameters),
        tuple(routine(system, function) for function in functions),
    )


def vector(name, size="n", unit="rad"):
    return Argument(name, (size,), unit, f"the vector {name}")


def everything(system, q, qd):
    """Every operation, results of every shape: a matrix, a vector and a scalar."""
    graph = system.graph
    parameters = [graph.input("parameters", k) for k in range(2)]
    mass, offset = parameters
    s1, c1, s12 = graph.sin(q[0]), graph.cos(q[0]), graph.sin(q[0] + q[1])
    tilt = graph.cos(offset)
    root = graph.call("sqrt", graph.call("exp", s1) + q[1] * q[1])
    ratio = (q[0] - (qd[1] - q[1])) / (2 + c1 * c1)
    nested = graph.sin(0.1 * root + s12)
    signs = graph.sign(qd[0]) * mass - graph.sign(qd[1])
    matrix = [
        q[0], graph.constant(-1.5), -(ratio * tilt),
        s12, graph.call("atan2", root, ratio), mass / (1 + root),
    ]  # fmt: skip
    return [matrix, [signs, nested, signs * nested - 3], [ratio - (root - (s1 - c1))]]


EVERYTHING = Function(
    "everything",
    (vector("q"), vector("qd")),
    (
        Argument("M", (2, 3), "kg m^2", "a matrix"),
        Argument("v", (3,), "N m", "a vector"),
        Argument("energy", (), "J", "a scalar"),
    ),
    "Every operation there is.",
    everything,
)
PARAMETERS = (("mass", 2.5), ("offset", None))


def everything_program():
    return program(EVERYTHING, dof=3, parameters=PARAMETERS, name="all_ops")


def evaluate(routine, *inputs, parameters=()):
    """Results of a routine, from its graph, operation by operation, by NumPy."""
    arguments = {a.name: np.asarray(x, float) for a, x in zip(routine.inputs, inputs, strict=True)}
    arguments["parameters"] = np.asarray(parameters, float)
    samples = np.broadcast_shapes(*(x.shape[:-1] for x in arguments.values()))
    values = {}

    def value(node):
        if node.op == "const":
            return np.float64(float(node.value))
        if node.op == "input":
            name, index = node.value
            return arguments[name][..., index]
        return values[node]

    for node in routine.schedule:
        values[node] = _OPERATIONS[node.op](node, *map(value, node.args))
    flat = iter(routine.results)
    results = []
    for a in routine.outputs:
        components = [
            np.broadcast_to(value(next(flat)), samples) for _ in range(math.prod(a.shape))
        ]
        results.append(np.stack(components, axis=-1).reshape(samples + a.shape))
    return results


_FUNCTIONS = {"atan2": np.arctan2, "sqrt": np.sqrt, "exp": np.exp}
_OPERATIONS = {
    "add": lambda _, a, b: a + b,
    "sub": lambda _, a, b: a - b,
    "mul": lambda _, a, b: a * b,
    "div": lambda _, a, b: a / b,
    "neg": lambda _, a: -a,
    "sin": lambda _, a: np.sin(a),
    "cos": lambda _, a: np.cos(a),
    "sign": lambda _, a: np.sign(a),
    "call": lambda node, *a: _FUNCTIONS[node.value](*a),
}


def affine(factor, name="affine"):
    """f(q) = factor q: small, and told apart by what it returns."""
    return program(
        Function(
            "f",
            (vector("q"),),
            (vector("y", 3),),
            "A multiple.",
            lambda system, q: [[factor * x for x in q]],
        ),
        name=name,
    )


def sines(n):
    """sin and cos of n angles."""
    return Function(
        f"sines_{n}",
        (vector("q", n),),
        (vector("sine", n), vector("cosine", n)),
        "Sines and cosines.",
        lambda system, q: [[system.graph.sin(x) for x in q], [system.graph.cos(x) for x in q]],
    )


def files(folder):
    """Names of what is there, besides the locks of builders."""
    return sorted(path.name for path in Path(folder).iterdir() if path.suffix != ".lock")
