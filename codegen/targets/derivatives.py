"""Derivatives of exported functions as functions of their own, with the entries that are not zero.

Of y = f(x), where y are all results and x all inputs, run-time parameters among them:

    jac_f(x)            dy/dx
    adj1_f(x, w)        g = (dy/dx)^T w
    jac_adj1_f(x, w)    dg/dx, the Hessian of w . y, and dg/dw = (dy/dx)^T

Matrices count column by column. Names, and what else the functions are given, are CasADi's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from moro.model import Model
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.graph.derivatives import gradient, jacobian
from moro_codegen.graph.nodes import Graph, Node, count, fewest, replaced, schedule
from moro_codegen.graph.precise import vanishing
from moro_codegen.passes.arrival import soonest
from moro_codegen.passes.factor import factored
from moro_codegen.program import Program, Routine, generate, scheduled
from moro_codegen.signature import parameters_input

#: {function: (the one of the catalogue that has its derivatives, by each of its inputs)}
KNOWN = {
    "tau": "tau_derivatives",
    "bias": "tau_derivatives",
    "gravity_vector": "tau_derivatives",
    "forward_dynamics": "forward_dynamics_derivatives",
    "potential_energy": "gravity_vector",
}
#: what takes more operations is left out: compilers would be at it for minutes
MOST = 40_000


@dataclass(frozen=True)
class Matrix:
    """An input or a result, column by column."""

    name: str
    rows: int
    columns: int
    #: empty for an input that nothing depends on
    entries: tuple[Node, ...]
    #: whether entries that are zero are left out
    sparse: bool = False

    @property
    def size(self) -> int:
        """The number of entries, zero or not."""
        return self.rows * self.columns

    @property
    def places(self) -> list[int]:
        """Which entries there are."""
        zero = self.entries[0].graph.zero if self.entries else None
        return [k for k, x in enumerate(self.entries) if not (self.sparse and x is zero)]


@dataclass(frozen=True)
class Differentiable:
    """A function, or derivatives of one: what it takes, and what it returns in nodes."""

    name: str
    inputs: tuple[Matrix, ...]
    outputs: tuple[Matrix, ...]

    @property
    def given(self) -> tuple[Matrix, ...]:
        """The inputs of its derivatives: those of its own, and its results, which are not used."""
        results = (Matrix(f"out_{y.name}", y.rows, y.columns, ()) for y in self.outputs)
        return (*self.inputs, *results)

    @property
    def x(self) -> list[Node]:
        """All inputs."""
        return [node for a in self.inputs for node in a.entries]

    @property
    def y(self) -> list[Node]:
        """All results."""
        return [node for a in self.outputs for node in a.entries]

    @property
    def routine(self) -> Routine | None:
        """The routine of what is not zero; None if everything is."""
        inputs = tuple(
            Argument(a.name, (a.size,), "", "") for a in self.inputs
            if a.entries and a.name != "parameters"
        )  # fmt: skip
        outputs = tuple(
            Argument(a.name, (len(a.places),), "", "") for a in self.outputs if a.places
        )
        results = [a.entries[k] for a in self.outputs for k in a.places]
        if not results:
            return None
        function = Function(self.name, inputs, outputs, "Derivatives.", _in_nodes)
        return scheduled(function, inputs, outputs, soonest(factored(results)))

    @property
    def operations(self) -> int:
        """How many operations it takes."""
        return sum(count(schedule(self.y)).values())


def differentiated(
    model: Model, program: Program
) -> Iterator[tuple[Differentiable, tuple[Differentiable, ...]]]:
    """Yield every function of a program of the model, and its derivatives: jac, adj1, jac_adj1.

    Those of more than ``MOST`` operations are left out.
    """
    whole = _with_known(model, program)
    routines = {routine.function.request: routine for routine in whole.routines}
    for routine in islice(whole.routines, len(program.routines)):
        known = routines.get(KNOWN.get(routine.function.request, ""))
        f = _differentiable(routine, program)
        J = _jacobian(f, known)
        weights = tuple(_inputs(f"adj_{y.name}", y) for y in f.outputs)
        adjoint = _adjoint(f, weights, J)
        found = (_first(f, J), adjoint, _second(f, adjoint, weights, J))
        yield f, tuple(d for d in found if d.operations <= MOST)


def _with_known(model: Model, program: Program) -> Program:
    """Return the program, in one graph with the functions that have derivatives of its own ones.

    Without them if they depend on parameters that the program does not have.
    """
    functions = [routine.function for routine in program.routines]
    there = {f.request for f in functions}
    needed = dict.fromkeys(KNOWN[name] for name in there if name in KNOWN)
    whole = generate(model, (*functions, *(name for name in needed if name not in there)))
    return whole if whole.parameters == program.parameters else program


def _differentiable(routine: Routine, program: Program) -> Differentiable:
    graph: Graph = routine.results[0].graph
    inputs = []
    for a in (*routine.inputs, *parameters_input(program.parameters)):
        entries = tuple(graph.input(a.name, k) for k in range(a.size))
        inputs.append(Matrix(a.name, a.size, 1, entries))
    outputs, first = [], 0
    for a in routine.outputs:
        rows = a.sizes[0] if a.sizes else 1
        columns = math.prod(a.sizes[1:])
        flat = routine.results[first : first + a.size]
        entries = tuple(flat[i * columns + j] for j in range(columns) for i in range(rows))
        outputs.append(Matrix(a.name, rows, columns, entries))
        first += a.size
    return Differentiable(routine.function.name, tuple(inputs), tuple(outputs))


def _inputs(name: str, like: Matrix) -> Matrix:
    graph = like.entries[0].graph
    entries = tuple(graph.input(name, k) for k in range(like.size))
    return Matrix(name, like.rows, like.columns, entries)


# -- derivatives ----------------------------------------------------------------------------------


def _jacobian(f: Differentiable, known: Routine | None) -> list[list[Node]]:
    """Return dy/dx, a list of rows: forwards, backwards, or by the catalogue."""
    x, y = f.x, f.y
    forwards = jacobian(y, x)
    ways = [forwards, [gradient([row], [row.graph.one], x) for row in y]]
    if known is not None:
        ways.append(_by_catalogue(f, known, forwards))
    shortest = iter(fewest(([e for row in J for e in row] for J in ways), y[0].graph))
    return _without_zeros([list(islice(shortest, len(x))) for _ in y])


def _without_zeros(rows: Sequence[Sequence[Node]]) -> list[list[Node]]:
    """Return rows in which what is zero whatever the inputs are is the graph's zero."""
    zero = vanishing(node for row in rows for node in row)
    return [[node.graph.zero if node in zero else node for node in row] for row in rows]


def _by_catalogue(
    f: Differentiable, known: Routine, forwards: Sequence[Sequence[Node]]
) -> list[list[Node]]:
    """Return dy/dx with what the catalogue has of it: blocks by q, qd, .., and not by parameters.

    What the other function takes besides is zero.
    """
    graph, n = forwards[0][0].graph, f.inputs[0].size
    own = {a.name for a in f.inputs}
    still = {graph.input(a.name, k): graph.zero
             for a in known.inputs if a.name not in own for k in range(a.size)}  # fmt: skip
    entries = replaced(known.results, still)
    rows = len(forwards)
    blocks = [a for a in f.inputs if a.name != "parameters"]
    return [
        [entries[(b * rows + i) * n + j] for b in range(len(blocks)) for j in range(n)]
        + list(forwards[i][len(blocks) * n :])
        for i in range(rows)
    ]


def _first(f: Differentiable, J: Sequence[Sequence[Node]]) -> Differentiable:
    return Differentiable(f"jac_{f.name}", f.given, tuple(_blocks(f.outputs, f.inputs, J)))


def _adjoint(
    f: Differentiable, weights: Sequence[Matrix], J: Sequence[Sequence[Node]]
) -> Differentiable:
    w = [node for a in weights for node in a.entries]
    graph = w[0].graph
    products = (
        sum((a * row[j] for a, row in zip(w, J, strict=True)), graph.zero) for j in range(len(f.x))
    )
    entries = iter(fewest((gradient(f.y, w, f.x), list(products)), graph))
    outputs = tuple(
        Matrix(f"adj_{a.name}", a.rows, 1, tuple(islice(entries, a.size))) for a in f.inputs
    )
    return Differentiable(f"adj1_{f.name}", (*f.given, *weights), outputs)


def _second(
    f: Differentiable,
    adjoint: Differentiable,
    weights: Sequence[Matrix],
    J: Sequence[Sequence[Node]],
) -> Differentiable:
    """Return dg/dx, of which one half is computed, nothing by the results, and dg/dw."""
    x = f.x
    H = _without_zeros(jacobian(adjoint.y, x))
    unused = sum(y.size for y in f.outputs)
    zero = x[0].graph.zero
    rows = [
        [H[max(i, j)][min(i, j)] for j in range(len(x))] + [zero] * unused + [row[i] for row in J]
        for i in range(len(x))
    ]
    blocks = _blocks(adjoint.outputs, adjoint.inputs, rows)
    return Differentiable(f"jac_{adjoint.name}", adjoint.given, tuple(blocks))


def _blocks(
    outputs: Sequence[Matrix], inputs: Sequence[Matrix], J: Sequence[Sequence[Node]]
) -> Iterator[Matrix]:
    """Yield the block of every result by every input."""
    top = 0
    for y in outputs:
        left = 0
        for x in inputs:
            entries = tuple(J[top + i][left + j] for j in range(x.size) for i in range(y.size))
            yield Matrix(f"jac_{y.name}_{x.name}", y.size, x.size, entries, sparse=True)
            left += x.size
        top += y.size


def _in_nodes(*_: object) -> Outputs:
    raise NotImplementedError("derivatives are made in nodes, not built anew")
