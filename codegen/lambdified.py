"""Any symbolic result as a fast function of NumPy arrays, without a compiler."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from moro.model import Model, as_model
from moro.robot import Robot
from moro_codegen.backends.floats import emit as emit_floats
from moro_codegen.backends.numpy import functions as emit_numpy
from moro_codegen.calls import Calls
from moro_codegen.emit.describe import docstring
from moro_codegen.functions.own import Formula, Scope, own_defaults, results_of
from moro_codegen.graph.nodes import Graph
from moro_codegen.passes import Pass
from moro_codegen.program import arranged, assembled, parameter_nodes

NAME = "lambdified"


def lambdify(
    expression: Any, robot: Robot | Model, parameters: Mapping[Any, Any] | None = None
) -> Callable[..., Any]:
    """Return a function f(q[, qd[, qdd]], parameters=None, out=None) of arrays.

        f = mc.lambdify(robot.coriolis_matrix(), robot)
        f(q, qd)                          # q, qd: (n,) or (samples, n); here a matrix, (..., n, n)

    ``expression`` is a scalar, matrix or array of SymPy of the robot's joint variables, their
    derivatives by time and its parameters; a list or tuple of them gives a tuple of results. A
    column is a vector. f takes those of q, qd and qdd that occur, in this order (q if none does),
    with any number of axes in front, which are broadcast; and those of the robot's ``parameters``
    that occur: a dict by name, a sequence in the robot's order, or None for their defaults.
    ``help(f)`` names them all. ``parameters`` are further symbols of the expression's own, with
    their defaults (None: no default), as for ``Function``.

    What occurs several times, in all results, is computed once. Raises ValueError for symbols that
    the robot does not have, TypeError for what is no expression.
    """
    model = as_model(robot)
    results = results_of(expression, "the expression")
    own = own_defaults(parameters or {}, results, "the expression")
    formula = Formula.of("the expression", results, Scope.of(model, own, "the expression"))
    defaults = {s: x for s, x in {**model.defaults, **own}.items() if s in formula.used}
    graph = Graph()
    nodes = parameter_nodes(graph, defaults)
    function = replace(formula, name=NAME).entry("The expression of a robot given.", "SI")
    build = partial(formula.nodes, graph, nodes)
    routine = arranged(function, graph, {"n": model.nv}, build, (Pass.COMMON_FACTORS,))
    program = assembled(model, defaults, [routine])
    (signature,) = program.signatures
    calls = signature.calls
    of_arrays = _function(emit_numpy(program), f"_{NAME}_of_arrays")
    of_floats = _function(emit_floats(program), NAME)
    doc = "\n".join(docstring(signature))
    return calls.function(calls.in_chunks(of_arrays), doc, _of_one_state(of_floats, calls))


def _function(text: str, name: str) -> Callable[..., Any]:
    names: dict[str, Any] = {}
    exec(compile(text, "<lambdified>", "exec"), names)  # noqa: S102 - written by us just now
    function: Callable[..., Any] = names[name]
    return function


def _of_one_state(of_floats: Callable[..., Any], calls: Calls) -> Callable[..., Any]:
    """Return a function of arrays that works on lists of floats, for one state.

    Other arrays, and divisions by zero, are NotImplemented.
    """
    cores = [a.shape for a in calls.operands]
    shapes = [a.shape for a in calls.outputs]

    def function(*args: Any) -> Any:
        for x, core in zip(args, cores, strict=True):
            if type(x) is not np.ndarray or x.shape != core or x.dtype != np.float64:
                return NotImplemented
        try:
            with np.errstate(all="ignore"):
                flat = of_floats(*[x.tolist() for x in args])
        except ZeroDivisionError:
            return NotImplemented
        values = [
            np.array(x).reshape(core) if core else np.float64(x[0])
            for x, core in zip(flat, shapes, strict=True)
        ]
        return tuple(values) if len(values) > 1 else values[0]

    return function
