"""A model whose scalars are nodes of a graph: what functions are built from.

A function that follows from M(q) and G(q) alone is the same for an arm with fewer inertial
parameters and other frames: it is built for several such arms, and the one that takes the fewest
operations is kept (``System.dynamics``). Where the last frame is, and how high the masses are, has
to be asked of the arm itself (``System.geometry``). Beside what the recursions give stands the
closed form, where it is short (``System.closed_form``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any

from moro.algorithms.coordinates import displacements
from moro.algorithms.drives import Functions, drive_torques, spring_torques
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture, posture, with_frame
from moro.model import Model
from moro.spatial.vectors import Scalar
from moro_codegen.functions.alternatives import ClosedForms, Route, cheapest, nothing
from moro_codegen.functions.function import Function
from moro_codegen.graph.nodes import Graph, Node, cost
from moro_codegen.passes import PASSES, Pass, equivalent_postures, rearranged
from moro_codegen.passes.factor import factored

if TYPE_CHECKING:  # SymPy, which help does without
    from moro_codegen.functions.short_forms import ShortForms

#: results of more operations take long to make: of equivalent arms, they are for only so many
MANY, FEW = 800, 4

#: from an arm in a posture to results, flat
Algorithm = Callable[[Posture], Sequence[Scalar]]


@dataclass(frozen=True)
class System:
    """A model whose scalars are nodes of a graph."""

    graph: Graph
    model: Model
    #: leave out rotor inertia and friction
    rigid: bool = False
    #: the run-time parameters, by symbol
    parameters: Mapping[Any, Node] = field(default_factory=dict)
    #: what its functions are made small by
    passes: tuple[Pass, ...] = PASSES
    #: closed forms of the same model; None: they are not asked for
    forms: ShortForms | None = None
    #: the function that is built, and by which routes each was
    function: str = ""
    routes: dict[str, set[Route]] = field(default_factory=dict)

    @property
    def rotors(self) -> list[Scalar]:
        """The rotor inertias."""
        return [0 if self.rigid else x.drive.rotor_inertia for x in self.model.coordinates]

    def route(self, function: Function) -> str:
        """Return by which routes a function was made, in words."""
        if not function.algorithm:
            return "expression"
        made = self.routes.get(function.request, {Route.RECURSION})
        return ", ".join(route.value for route in Route if route in made)

    def posture(self, q: Sequence[Node]) -> Posture:
        """Return the arm at q."""
        angles = displacements(self.model, q)
        pairs = [(self.graph.sin(angle), self.graph.cos(angle)) for angle in angles]
        return posture(self.model, q, pairs)

    def with_tip(self, q: Sequence[Node]) -> Posture:
        """Return the arm with its joints at q, and the last frame as a further link."""
        tip = self.model.tip
        return with_frame(self.posture(q), tip.link, tip.placement)

    def closed_form(self, formula: str, *motion: Sequence[Node]) -> ClosedForms:
        """Return what makes nodes of a closed form at q, and qd and qdd where it depends on them.

        ``formula`` is a method of ``ShortForms``. What is returned is told how many pairs of terms
        there may be, and yields nothing if there are more.
        """
        if self.forms is None or Pass.CLOSED_FORMS not in self.passes:
            return nothing
        return partial(self.forms.nodes, formula, self.graph, self.parameters, motion)

    def dynamics(
        self, arm: Posture, *algorithms: Algorithm, closed_form: ClosedForms = nothing
    ) -> list[Node]:
        """Return the cheapest results: of the algorithms for equivalent arms, or a closed form."""
        return self._fewest(self._alternatives(arm, algorithms), closed_form)

    def geometry(
        self, q: Sequence[Node], algorithm: Algorithm, closed_form: ClosedForms = nothing
    ) -> list[Node]:
        """Return the cheapest results for the arm itself, with frame n as a further link."""
        arm = self.with_tip(q)
        return self._fewest((algorithm(x) for x in rearranged(arm, self.passes)), closed_form)

    def _fewest(
        self, recursions: Iterable[Sequence[Scalar]], closed_form: ClosedForms
    ) -> list[Node]:
        route, results = cheapest(self.graph, recursions, closed_form, self.passes)
        self.routes.setdefault(self.function, set()).add(route)
        return results

    def _alternatives(
        self, arm: Posture, algorithms: Sequence[Algorithm]
    ) -> Iterator[Sequence[Scalar]]:
        """Yield the results of every algorithm for every equivalent arm.

        With run-time parameters, again with sums searched for what cancels: parameters that the
        equations do not have, at the cost of parts that sums shared.
        """
        arms = self._tried(arm, algorithms[0])
        yield from (run(other) for run in algorithms for other in arms)
        if self.graph.has_parameters:
            self.graph.cancels = True
            arms = self._tried(arm, algorithms[0])
            yield from (factored(self.nodes(run(other))) for run in algorithms for other in arms)
            self.graph.cancels = False

    def _tried(self, arm: Posture, algorithm: Algorithm) -> Sequence[Posture]:
        """Return equivalent arms: where results are long, the few whose torques are shortest."""
        arms = list(equivalent_postures(arm, self.passes))
        if len(arms) <= FEW or cost(self.nodes(algorithm(arms[0]))) <= MANY:
            return arms
        rates, accelerations = (
            [self.graph.input(name, k) for k in range(self.model.nv)] for name in ("qd", "qdd")
        )
        costs = [cost(self.nodes(joint_torques(x, rates, accelerations))) for x in arms]
        shortest = sorted(range(len(arms)), key=costs.__getitem__)[:FEW]
        return [arms[k] for k in sorted(shortest)]

    def nodes(self, scalars: Iterable[Scalar]) -> list[Node]:
        """Return nodes for scalars, some of which may be numbers."""
        return [self.graph.constant(x) for x in scalars]

    def drives(
        self, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Scalar]
    ) -> Sequence[Scalar]:
        """Return the torques of rotor inertia, friction and springs."""
        springs = spring_torques(self.model, q)
        if self.rigid:
            return springs
        return sum_of(drive_torques(self.model, qd, qdd, self.functions), springs)

    @property
    def functions(self) -> Functions:
        """What friction is made of."""
        call = self.graph.call
        return Functions(self.graph.sign, partial(call, "tanh"), partial(call, "exp"))


def flat(rows: Iterable[Iterable[Scalar]]) -> list[Scalar]:
    """Return the entries of rows, one after another."""
    return list(chain.from_iterable(rows))


def sum_of(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """Return a + b."""
    return [x + y for x, y in zip(a, b, strict=True)]


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """Return a . b."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def parts(entries: Sequence[Node], count: int) -> list[Sequence[Node]]:
    """Return the entries in so many equal parts."""
    size = len(entries) // count
    return [entries[k * size : (k + 1) * size] for k in range(count)]
