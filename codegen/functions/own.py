"""Functions of one's own: SymPy expressions of an arm's motion, as functions that can be generated.

An expression is a number, a SymPy expression, a matrix or an array; of the joint variables, their
first and second derivatives by time, and the parameters of the robot. A column (n x 1) is a vector,
as in the rest of the kernels; every other shape is kept.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from moro.abc import t
from moro.checks.values import number, suggestion
from moro.model import Model, as_model
from moro_codegen import registry
from moro_codegen.functions.arguments import QD, QDD, Argument, Q
from moro_codegen.functions.function import Function
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Graph, Node

#: what an expression can depend on besides parameters, in the order of a function's inputs
MOTION = (Q, QD, QDD)
#: longer expressions are not written out in headers and docstrings
SHOWN = 200


@dataclass(frozen=True, eq=False)
class UserFunction:
    """A SymPy expression that becomes a function of a kernel.

        payload_moment = mc.Function("payload_moment", m * g * robot.T[0, 3])
        kernel = mc.compile(robot, functions=("tau", payload_moment))
        kernel.payload_moment(q)

    ``expression`` is a scalar, matrix or array of the joint variables q_i(t), their derivatives
    by t, and the robot's parameters; or a list or tuple of those, for several results. A column is
    a vector. The function takes those of q, qd and qdd that occur, in this order (q if none does).
    ``summary`` and ``unit`` go into docstrings and headers. ``parameters`` are symbols that the
    robot does not have, or their names, with their defaults (None: no default):

        torque = mc.Function("torque", -Kp * q1, parameters={Kp: 100})
        kernel.torque(q, parameters={"Kp": 50})

    Raises ValueError if ``name`` cannot name a function in C and Python, if the expression is
    empty or has more than two axes, or does not hold one of the parameters; TypeError for what is
    no expression, or no number.
    """

    name: str
    expression: Any
    summary: str = ""
    unit: str = "SI"
    parameters: Mapping[Any, Any] = field(default_factory=dict, repr=False)
    #: the expression's results: shape and entries of each
    results: tuple[Result, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        check_name(self.name)
        for text in (self.summary, self.unit):
            if not isinstance(text, str):
                raise TypeError(f"a summary or unit is text, not {text!r}")
        object.__setattr__(self, "results", results_of(self.expression, self.name))
        for result in self.results:
            if len(result.shape) > 2:
                raise ValueError(
                    f"{self.name}: a result has at most two axes, found shape {result.shape}"
                )
        own = own_defaults(self.parameters, self.results, self.name)
        object.__setattr__(self, "parameters", own)

    def entry(self, robot: Any) -> Function:
        """Return the function for a robot or a model.

        Raises ValueError if there are symbols that neither has, or that both have.
        """
        scope = Scope.of(as_model(robot), self.parameters, self.name)
        formula = Formula.of(self.name, self.results, scope)
        entry = formula.entry(self.summary, self.unit)
        return replace(entry, parameters=self.parameters)


@dataclass(frozen=True)
class Result:
    """An array of expressions: its shape, and its entries, row-major."""

    shape: tuple[int, ...]
    entries: tuple[Any, ...]


@dataclass(frozen=True)
class Scope:
    """What expressions may contain: for each symbol the input that it is a component of."""

    robot: str
    #: joint variables and their derivatives: (name of the argument, index)
    motion: Mapping[Any, tuple[str, int]]
    #: run-time parameters, in order
    parameters: Sequence[Any]

    @classmethod
    def of(cls, model: Model, own: Iterable[Any], name: str) -> Scope:
        """Return what an expression of a model may contain that brings parameters of its own.

        Raises ValueError if the model has them as well.
        """
        names = {str(symbol) for symbol in model.defaults}
        for symbol in own:
            if str(symbol) in names:
                raise ValueError(
                    f"{name}: {symbol} is a parameter of {model.name} already, which gives its "
                    "default: leave it out of the function's parameters"
                )
        motion: dict[Any, tuple[str, int]] = {}
        for i, q in enumerate(model.qs):
            motion[q] = ("q", i)
            if not q.is_Symbol:
                motion[q.diff(t)], motion[q.diff(t, 2)] = ("qd", i), ("qdd", i)
        return cls(model.name, motion, (*model.defaults, *own))

    def used(self, expressions: Iterable[Any], name: str) -> set[Any]:
        """Return the symbols that occur. Raise ValueError for those that are not known."""
        known = {*self.motion, *self.parameters}
        used, unknown, seen = set(), set(), set()
        stack = list(expressions)
        while stack:
            item = stack.pop()
            if item in known:
                used.add(item)
            elif isinstance(item, (sp.Symbol, AppliedUndef, sp.Derivative)):
                unknown.add(item)
            elif item not in seen:
                seen.add(item)
                stack.extend(item.args)
        if unknown:
            raise ValueError(self._complaint(name, sorted(unknown, key=str)))
        return used

    def _complaint(self, name: str, unknown: Sequence[Any]) -> str:
        names = [str(symbol) for symbol in self.parameters]
        there = f"its parameters {', '.join(names)}" if names else "it has no parameters"
        alike = [str(symbol) for symbol in unknown if str(symbol) in names]
        hint = f"; the robot's {', '.join(alike)} has other assumptions" if alike else ""
        return (
            f"{name} contains {', '.join(map(str, unknown))}: known of {self.robot} are its joint "
            f"variables {', '.join(str(q) for q, (a, _) in self.motion.items() if a == 'q')}, "
            f"their first and second derivatives by time, and {there}{hint}"
            f"{self._remedy(unknown, names) if not alike else ''}"
        )

    def _remedy(self, unknown: Sequence[Any], names: Sequence[str]) -> str:
        """Return the name that is nearest, or how a symbol becomes a parameter."""
        symbols = [str(symbol) for symbol in unknown if symbol.is_Symbol and symbol != t]
        near = next(filter(None, (suggestion(x, names) for x in symbols)), "")
        if near or not symbols:
            return near
        given = ", ".join(f"{x}: default" for x in symbols)
        return f"; symbols of its own it gets by parameters={{{given}}}"


@dataclass(frozen=True)
class Formula:
    """Results over a scope, with the inputs that occur in them."""

    name: str
    results: tuple[Result, ...]
    scope: Scope
    #: what occurs of the scope
    used: frozenset[Any]
    inputs: tuple[Argument, ...]

    @classmethod
    def of(cls, name: str, results: tuple[Result, ...], scope: Scope) -> Formula:
        """Return the formula. Raise ValueError if results contain what is not in scope."""
        used = scope.used((x for result in results for x in result.entries), name)
        arguments = {scope.motion[symbol][0] for symbol in used if symbol in scope.motion}
        inputs = tuple(a for a in MOTION if a.name in arguments) or (Q,)
        return cls(name, results, scope, frozenset(used), inputs)

    def nodes(
        self, graph: Graph, parameters: Mapping[Any, Node], *given: Sequence[Node]
    ) -> list[list[Node]]:
        """Return the entries of each result, for the parameters and components of the inputs."""
        values = dict(zip((a.name for a in self.inputs), given, strict=True))
        known = {s: values[a][i] for s, (a, i) in self.scope.motion.items() if s in self.used}
        convert = Converter(graph, {**parameters, **known})
        try:
            return [[convert(x) for x in result.entries] for result in self.results]
        except (ValueError, ZeroDivisionError) as error:
            raise ValueError(f"{self.name}: {error}") from None

    def entry(self, summary: str, unit: str) -> Function:
        """Return the function that computes the results."""
        name, several = self.name, len(self.results) > 1
        outputs = tuple(
            Argument(f"{name}_{k}" if several else name, result.shape, unit, _shown(result))
            for k, result in enumerate(self.results, 1)
        )

        def build(system: System, *given: Sequence[Node]) -> list[list[Node]]:
            return self.nodes(system.graph, system.parameters, *given)

        return Function(
            name, self.inputs, outputs, summary or "A function of the user's own.", build
        )


def results_of(expression: Any, name: str) -> tuple[Result, ...]:
    """Return the results of an expression, one for each item of a list or tuple."""
    if isinstance(expression, (list, tuple, sp.Tuple)):
        if not expression:
            raise ValueError(f"{name}: an empty list has no results")
        return tuple(_result(item, name) for item in expression)
    return (_result(expression, name),)


def own_defaults(parameters: Any, results: Iterable[Result], name: str) -> dict[Any, Any]:
    """Return {symbol: default} of the parameters given for results, by symbol or by name.

    Raises ValueError, with the nearest symbol, for one that they do not hold; TypeError for what
    is no number.
    """
    if not isinstance(parameters, Mapping):
        raise TypeError(f"{name}: parameters must be a dictionary {{symbol: default}}")
    held = {str(s): s for result in results for x in result.entries for s in x.free_symbols - {t}}
    found = {}
    for key, default in parameters.items():
        symbol = held.get(str(key))
        if symbol is None:
            raise ValueError(f"{name} does not contain {key}{suggestion(str(key), held)}")
        if symbol in found:
            raise ValueError(f"{name}: {key} is given two defaults")
        found[symbol] = None if default is None else number(default, f"{name}: default of {key}")
    return found


def check_name(name: Any) -> None:
    """Raise unless a name can be that of a function, in C and in Python."""
    if not isinstance(name, str):
        raise TypeError(f"a function's name is a string, not {name!r}")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise ValueError(
            f"a function cannot be named {name!r}: letters, digits and underscores only, a letter "
            "first"
        )
    if keyword.iskeyword(name) or name in {a.name for a in MOTION} | registry.reserved():
        raise ValueError(f"a function cannot be named {name!r}: generated code uses that name")


def _result(value: Any, name: str) -> Result:
    if isinstance(value, sp.MatrixExpr):
        value = value.as_explicit()
    if isinstance(value, (sp.MatrixBase, sp.NDimArray, np.ndarray)):
        shape = tuple(int(n) for n in value.shape)
        entries = sp.flatten([value.tolist()])
        if isinstance(value, sp.MatrixBase) and shape[1] == 1:
            shape = shape[:1]
    else:
        shape, entries = (), [value]
    if not entries:
        raise ValueError(f"{name}: an array of shape {shape} has no entries")
    return Result(shape, tuple(_entry(x, name) for x in entries))


def _entry(value: Any, name: str) -> Any:
    """Return an entry as a SymPy expression; text is not parsed."""
    try:
        entry = sp.sympify(value, strict=True)
    except sp.SympifyError:
        entry = None
    if not isinstance(entry, sp.Expr):
        raise TypeError(f"{name}: {value!r} is neither a number nor a SymPy expression")
    return entry


def _shown(result: Result) -> str:
    """Return a short scalar as it is written, else what kind of thing it is."""
    if not result.shape:
        text = str(result.entries[0])
        if len(text) <= SHOWN:
            return text
    kind = ("expression", "vector", "matrix")[min(len(result.shape), 2)]
    return f"the {kind} given"
