"""What can be generated: for each function its name, arguments, meaning and algorithm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from moro_codegen.frames import equivalent_postures
from moro_codegen.graph import Graph, Node, fewest

from moro.algorithms.drives import drive_torques
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture, posture
from moro.model import Model

#: a dimension is a number, or "n" for the number of joints
Shape = tuple[str | int, ...]


@dataclass(frozen=True)
class Argument:
    """An input or output array: row-major, components of ``shape``."""

    name: str
    shape: Shape
    unit: str
    #: what it is, with the frame it is expressed in
    description: str


@dataclass(frozen=True)
class System:
    """A model whose scalars are nodes of a graph."""

    graph: Graph
    model: Model
    #: leave out rotor inertia and friction
    rigid: bool = False

    def posture(self, q: Sequence[Node]) -> Posture:
        """Return the arm with its joints at q."""
        angles = [x + joint.offset for x, joint in zip(q, self.model.joints, strict=True)]
        pairs = [(self.graph.sin(angle), self.graph.cos(angle)) for angle in angles]
        return posture(self.model, q, pairs)


@dataclass(frozen=True)
class Function:
    """A function of the dynamics: what C, Python, the headers and the docs say of it.

    ``build`` takes the system and one sequence of nodes per input, and returns one flat sequence
    of nodes per output.
    """

    name: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    summary: str
    build: Callable[..., Sequence[Sequence[Node]]]


def _tau(
    system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
) -> list[Sequence[Node]]:
    postures = equivalent_postures(system.posture(q))
    tau = fewest((joint_torques(arm, qd, qdd) for arm in postures), system.graph)
    if not system.rigid:
        drives = drive_torques(system.model, qd, qdd, system.graph.sign)
        tau = [body + drive for body, drive in zip(tau, drives, strict=True)]
    return [tau]


Q = Argument("q", ("n",), "rad or m", "joint positions")
QD = Argument("qd", ("n",), "rad/s or m/s", "joint velocities")
QDD = Argument("qdd", ("n",), "rad/s^2 or m/s^2", "joint accelerations")
TAU = Argument(
    "tau", ("n",), "N m or N", "joint torques, about the joint axes (forces, along them)"
)

FUNCTIONS = {
    function.name: function
    for function in (
        Function(
            "tau",
            (Q, QD, QDD),
            (TAU,),
            "Inverse dynamics: M(q) qdd + C(q, qd) qd + G(q), with rotor inertia and friction.",
            _tau,
        ),
    )
}
