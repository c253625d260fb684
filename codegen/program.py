"""From a robot to a program: for every function asked for, the operations to carry out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import sympy as sp

from moro.checks.values import distinct_names
from moro.model import Model, as_model
from moro.robot import Robot
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function, own_parameters
from moro_codegen.functions.requested import Request, requested
from moro_codegen.functions.short_forms import ShortForms
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, Node, cost, count, parameters_of, replaced, schedule
from moro_codegen.passes import PASSES, Pass, condensed
from moro_codegen.progress import tell
from moro_codegen.signature import (
    DTYPES,
    Part,
    Real,
    RuntimeParameter,
    Signature,
    parameters_input,
    real,
)


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
    #: by which routes each of the function's parts was made
    routes: tuple[str, ...]
    #: how many of "add", "sub" (with "neg"), "mul", "div", "sincos" (pairs), "sign", "call"
    ops: dict[str, int]


@dataclass(frozen=True)
class Program:
    """The routines of one arm, and all that is said of it: what ``build`` makes a kernel of."""

    name: str
    dof: int
    joint_kinds: tuple[str, ...]
    parameters: tuple[RuntimeParameter, ...]
    routines: tuple[Routine, ...]
    #: what the kernel computes with
    scalar: Real = "double"
    #: for those who read the files: of the robot's frames ("" if it is not known), and gravity in
    #: frame 0 [m/s^2] as text (None if it was not set)
    convention: str = ""
    gravity: tuple[str, ...] | None = None
    #: of the joints; "" where they have none
    joint_names: tuple[str, ...] = ()

    def signature(self, routine: Routine) -> Signature:
        """Return what one of the routines takes and returns."""
        function = routine.function
        return Signature(
            function.name,
            function.summary,
            (*routine.inputs, *parameters_input(self.parameters)),
            routine.outputs,
            self.parameters,
            routine.ops,
            tuple(
                Part(part.kind or part.name, len(part.outputs), part.frame or "", route)
                for part, route in zip(function.parts, routine.routes, strict=True)
            ),
            DTYPES[self.scalar],
        )

    @property
    def signatures(self) -> tuple[Signature, ...]:
        """What the routines take and return."""
        return tuple(map(self.signature, self.routines))


def generate(
    robot: Robot | Model,
    functions: Sequence[Request] = ("tau",),
    *,
    dtype: Any = "float64",
    rigid: bool = False,
    passes: Collection[Pass] = PASSES,
) -> Program:
    """Return the program of a robot's functions, for ``build`` to make a kernel of.

        program = mc.generate(robot, ("tau", "inertia_matrix"))
        kernel = mc.build(program, "build/arm", backend="numpy")

    ``functions`` and ``dtype`` are those of ``compile``. Parameters that a result depends on become
    run-time parameters of the program, those of the robot first, then those that functions bring.
    ``rigid`` leaves out rotor inertia and friction; ``passes`` are what makes the program small.

    Raises ValueError for a function that does not exist, for two defaults of one parameter, and
    for two symbols of one name.
    """
    scalar, model = real(dtype), as_model(robot)
    wanted = requested(functions, model)
    defaults = {**model.defaults, **own_parameters(wanted)}
    graph = Graph()
    nodes = parameter_nodes(graph, defaults)
    system = System(
        graph,
        model.map(Converter(graph, nodes)),
        rigid,
        nodes,
        tuple(passes),
        ShortForms(model, rigid),
    )
    routines, used = without_unused([routine(system, function) for function in wanted])
    symbols = list(defaults)
    return assembled(model, {symbols[k]: defaults[symbols[k]] for k in used}, routines, scalar)


def assembled(
    model: Model, defaults: Mapping[Any, Any], routines: Sequence[Routine], scalar: Real = "double"
) -> Program:
    """Return the program of routines of a model that take parameters, {symbol: default or None}."""
    meanings = {parameter.symbol: parameter.meaning for parameter in model.parameters}
    return Program(
        model.name,
        model.nv,
        tuple(kind.name for kind in model.types),
        tuple(
            RuntimeParameter(str(s), None if x is None else float(x), meanings.get(s, ""))
            for s, x in defaults.items()
        ),
        tuple(routines),
        scalar,
        model.convention,
        None if "gravity" in model.not_set else tuple(map(_text, model.gravity)),
        tuple(x.name for x in model.coordinates),
    )


def _text(value: Any) -> str:
    """Return a number as a decimal, an expression as SymPy writes it."""
    return f"{float(value):.15g}" if sp.sympify(value).is_Rational else str(value)


def parameter_nodes(graph: Graph, parameters: Collection[Any]) -> dict[Any, Node]:
    """Return the inputs that run-time parameters are: the k-th is ("parameters", k).

    Raises ValueError for two symbols of one name.
    """
    distinct_names(parameters)
    return {symbol: graph.input("parameters", k) for k, symbol in enumerate(parameters)}


def without_unused(routines: Sequence[Routine]) -> tuple[tuple[Routine, ...], list[int]]:
    """Return routines that number the run-time parameters they use from 0, and those used."""
    used = sorted(set().union(*(parameters_of(routine.results) for routine in routines)))
    if used == list(range(len(used))):
        return tuple(routines), used
    graph = routines[0].results[0].graph
    inputs = list(parameter_nodes(graph, range(used[-1] + 1)).values())
    new = {inputs[k]: inputs[i] for i, k in enumerate(used)}
    return tuple(
        replace(
            scheduled(x.function, x.inputs, x.outputs, replaced(x.results, new)), routes=x.routes
        )
        for x in routines
    ), used


def routine(system: System, function: Function) -> Routine:
    """Return the routine of one function.

    Of several together, which share more of one recursion, also without closed forms if that takes
    fewer operations.
    """
    tell(f"generating {function.name}")
    systems = [system]
    if function.together and Pass.CLOSED_FORMS in system.passes:
        systems.append(replace(system, forms=None))
    return min((_routine(x, function) for x in systems), key=lambda made: cost(made.results))


def _routine(system: System, function: Function) -> Routine:
    system = replace(system, function=function.request, routes={})
    build = partial(function.build, system)
    sizes = {"n": system.model.nv, "p": len(system.model.defaults)}
    made = arranged(function, system.graph, sizes, build, system.passes)
    return replace(made, routes=tuple(map(system.route, function.parts)))


def arranged(
    function: Function,
    graph: Graph,
    sizes: Mapping[str, int],
    build: Callable[..., Sequence[Sequence[Node]]],
    passes: Collection[Pass] = PASSES,
) -> Routine:
    """Return the routine of what ``build`` makes of a function's inputs; ``sizes`` of n and p."""
    inputs = tuple(_resolved(argument, sizes) for argument in function.inputs)
    outputs = tuple(_resolved(argument, sizes) for argument in function.outputs)
    nodes = [[graph.input(a.name, k) for k in range(a.size)] for a in inputs]
    flat = [x for output in build(*nodes) for x in output]
    return scheduled(function, inputs, outputs, condensed(flat, passes))


def scheduled(
    function: Function,
    inputs: tuple[Argument, ...],
    outputs: tuple[Argument, ...],
    results: Sequence[Node],
) -> Routine:
    """Return the routine of results, with its operations in order."""
    order, angles = _angles_first(schedule(results))
    routes = ("expression",) * len(function.parts)
    return Routine(function, inputs, outputs, order, angles, tuple(results), routes, count(order))


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


def _resolved(argument: Argument, sizes: Mapping[str, int]) -> Argument:
    shape = (sizes[size] if isinstance(size, str) else size for size in argument.shape)
    return replace(argument, shape=tuple(shape))
