"""The regressor of an arm in its base parameters, as a function that can be generated.

``Robot.base_parameters`` says which parameters those are: each is led by an inertial parameter of a
link in Khalil's frame, by a rotor inertia, or by friction. The column of Y that belongs to it is
what the torques are per unit of its leader.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from moro.algorithms.body_regressor import PARAMETERS, body_regressor
from moro.identification.base_parameters import base_parameters_of, terms_of_drive
from moro.model import Model
from moro.spatial.vectors import Scalar
from moro_codegen.functions.catalogue import REGRESSOR
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Node


@dataclass(frozen=True)
class Regressor:
    """The request for "regressor" that says which base parameters count.

        kernel = mc.compile(robot, functions=("tau", mc.Regressor(zeros=True)))
        Y, p = kernel.regressor(q, qd, qdd)

    ``zeros`` is that of ``robot.base_parameters(zeros)``: whether to keep (True) or leave out
    (False) all parameters whose value is zero.
    """

    zeros: bool | None = None

    def __post_init__(self) -> None:
        if self.zeros not in (None, True, False):
            raise TypeError(f"zeros must be True, False or None, not {self.zeros!r}")

    def entry(self, model: Model) -> Function:
        """Return the function for a model."""
        return regressor(model, self.zeros)


def regressor(model: Model, zeros: bool | None = None) -> Function:
    """Return the function (q, qd, qdd) -> (Y, p) of a model: tau = Y p.

    Y (n x b) and p (b) are those of ``robot.regressor(zeros)``, in the order of
    ``robot.base_parameters(zeros)``.
    """
    base = base_parameters_of(model, zeros)
    names = ", ".join(str(parameter.symbol) for parameter in base)

    def build(
        system: System, q: Sequence[Node], qd: Sequence[Node], qdd: Sequence[Node]
    ) -> Outputs:
        columns = list(zip(*body_regressor(system.posture(q), qd, qdd), strict=True))

        def column(link: int, name: str) -> Sequence[Scalar]:
            if name in PARAMETERS:
                return columns[len(PARAMETERS) * link + PARAMETERS.index(name)]
            own = qdd[link]
            if name != "IA":
                drive = system.model.coordinates[link].drive
                own = terms_of_drive(drive, q[link], qd[link], system.functions)[name]
            return [own if i == link else 0 for i in range(model.nv)]

        rows = zip(*(column(*parameter.leader) for parameter in base), strict=True)
        values = map(Converter(system.graph, system.parameters), base.values)
        zero = system.graph.zero
        return [[x + zero for row in rows for x in row], list(values)]

    Y, p = REGRESSOR.outputs
    return replace(
        REGRESSOR,
        outputs=(replace(Y, shape=("n", len(base))), replace(p, shape=(len(base),))),
        summary=f"{REGRESSOR.summary} The base parameters p are, in this order, about the origins "
        f"of Khalil's frames: {names}.",
        build=build,
    )
