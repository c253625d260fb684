"""From a model to a program: for every function asked for, the operations to carry out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

from moro.checks import distinct_names
from moro.model import Model
from moro_codegen.convert import Converter
from moro_codegen.factor import factored
from moro_codegen.functions import FUNCTIONS, Argument, Function, System, own_parameters
from moro_codegen.graph import Graph, Node, count, parameters_of, replaced, schedule
from moro_codegen.progress import tell


@dataclass(frozen=True)
class Parameter:
    """A number of the model that is given at run time."""

    name: str
    default: float | None
    #: what it is of the robot, "mass of link 2"; or ""
    description: str


@dataclass(frozen=True)
class Routine:
    """A function of one arm, ready to be written in any language."""

    function: Function
    #: with their shapes in numbers; run-time parameters are not among them
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    #: every node to be computed, operands first: what ``angles`` need, then their sines and
    #: cosines, then the rest; no constants and inputs
    schedule: tuple[Node, ...]
    #: the joint angles (sums, with offsets) whose sines and cosines are needed
    angles: tuple[Node, ...]
    #: flat, row-major, in the order of ``outputs``
    results: tuple[Node, ...]
    #: how many of "add", "sub" (with "neg"), "mul", "div", "sincos" (pairs), "sign", "call"
    ops: dict[str, int]


@dataclass(frozen=True)
class Program:
    """The routines of one arm."""

    name: str
    dof: int
    joint_kinds: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    routines: tuple[Routine, ...]
    #: what the kernel computes with
    scalar: Literal["double", "float"] = "double"
    #: for those who read the files: of the robot's frames ("" if it is not known), and gravity in
    #: frame 0 [m/s^2] as text (None if it was not set)
    convention: str = ""
    gravity: tuple[str, ...] | None = None


def generate(
    model: Model,
    functions: Sequence[str | Function] = ("tau",),
    parameters: Mapping[Any, Any] | None = None,
    *,
    rigid: bool = False,
) -> Program:
    """Return the program of the functions, which are given or named.

    ``parameters`` maps every symbol of the model to its default, or to None; functions may bring
    more of their own. Those that a result depends on become run-time parameters of the program, in
    this order: the k-th is the input ("parameters", k). ``rigid`` leaves out rotor inertia and
    friction.

    Raises ValueError for a function that does not exist, for two defaults of one parameter, and
    for two symbols of one name.
    """
    unknown = [name for name in functions if isinstance(name, str) and name not in FUNCTIONS]
    if unknown:
        raise ValueError(f"unknown functions {unknown}; there are {sorted(FUNCTIONS)}")
    wanted = [FUNCTIONS[f] if isinstance(f, str) else f for f in functions]
    defaults = {**(parameters or {}), **own_parameters(wanted)}
    known = run_time_parameters(defaults)
    graph = Graph()
    nodes = {symbol: graph.input("parameters", k) for k, symbol in enumerate(defaults)}
    system = System(graph, model.map(Converter(graph, nodes)), rigid, nodes)
    routines, used = without_unused([routine(system, function) for function in wanted])
    return Program(
        model.name,
        model.dof,
        tuple(joint.type.name for joint in model.joints),
        tuple(known[k] for k in used),
        routines,
    )


def run_time_parameters(defaults: Mapping[Any, Any]) -> tuple[Parameter, ...]:
    """Return the parameters with these symbols and defaults (None: no default).

    Raises ValueError for two symbols of one name.
    """
    distinct_names(defaults)
    return tuple(
        Parameter(str(symbol), None if default is None else float(default), "")
        for symbol, default in defaults.items()
    )


def without_unused(routines: Sequence[Routine]) -> tuple[tuple[Routine, ...], list[int]]:
    """Return routines that number the run-time parameters they use from 0, and those used."""
    used = sorted(set().union(*(parameters_of(routine.results) for routine in routines)))
    if used == list(range(len(used))):
        return tuple(routines), used
    graph = routines[0].results[0].graph
    new = {graph.input("parameters", k): graph.input("parameters", i) for i, k in enumerate(used)}
    return tuple(
        _scheduled(x.function, x.inputs, x.outputs, replaced(x.results, new)) for x in routines
    ), used


def routine(system: System, function: Function) -> Routine:
    """Return the routine of one function."""
    build = partial(function.build, system)
    return arranged(function, system.graph, system.model.dof, build)


def arranged(
    function: Function, graph: Graph, dof: int, build: Callable[..., Sequence[Sequence[Node]]]
) -> Routine:
    """Return the routine of what ``build`` makes of a function's inputs."""
    tell(f"generating {function.name}")
    inputs = tuple(_resolved(argument, dof) for argument in function.inputs)
    outputs = tuple(_resolved(argument, dof) for argument in function.outputs)
    nodes = [[graph.input(a.name, k) for k in range(_size(a))] for a in inputs]
    results = factored([x for output in build(*nodes) for x in output])
    return _scheduled(function, inputs, outputs, results)


def _scheduled(
    function: Function,
    inputs: tuple[Argument, ...],
    outputs: tuple[Argument, ...],
    results: Sequence[Node],
) -> Routine:
    """Return the routine of results, with its operations in order."""
    order, angles = _angles_first(schedule(results))
    return Routine(function, inputs, outputs, order, angles, tuple(results), count(order))


def _angles_first(order: Sequence[Node]) -> tuple[tuple[Node, ...], tuple[Node, ...]]:
    """Return the schedule with angles, their sines and cosines in front, and the angles."""
    moving = set()  # what depends on q and on no sine or cosine
    fixed = set()  # what does not depend on q
    for node in order:
        if all(a in fixed or _is_fixed(a) for a in node.args):
            fixed.add(node)
        elif node.op not in ("sin", "cos") and all(
            a in moving or a in fixed or not a.args for a in node.args
        ):
            moving.add(node)
    trig = [
        node
        for node in order
        if node.op in ("sin", "cos") and (node.args[0] in moving or _is_position(node.args[0]))
    ]
    angles = tuple(dict.fromkeys(node.args[0] for node in trig))
    first = [*schedule(angles), *trig]
    placed = set(first)
    return (*first, *(node for node in order if node not in placed)), angles


def _is_position(node: Node) -> bool:
    return node.op == "input" and node.value[0] == "q"


def _is_fixed(node: Node) -> bool:
    return not node.args and not _is_position(node)


def _resolved(argument: Argument, dof: int) -> Argument:
    return replace(argument, shape=tuple(dof if size == "n" else size for size in argument.shape))


def _size(argument: Argument) -> int:
    return math.prod(int(size) for size in argument.shape)
