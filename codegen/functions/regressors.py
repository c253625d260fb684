"""Regressors of an arm: what torques and momenta are per unit of its inertial parameters.

They are of the base parameters (``Robot.base_parameters``), each of which is led by an inertial
parameter of a link in Khalil's frame, by a rotor inertia, or by friction; the column of Y that
belongs to it is what the torques are per unit of its leader. Or they are of the standard
parameters, ten a link and those of the drives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from moro.algorithms.body_regressor import PARAMETERS, body_regressor, reference_regressor
from moro.algorithms.posture import Posture, weightless
from moro.identification.base_parameters import (
    base_parameters_of,
    drive_coefficients,
    terms_of_drive,
)
from moro.identification.standard_parameters import Standard, parameters
from moro.model import Model
from moro.spatial.vectors import Scalar
from moro_codegen.functions.catalogue import (
    MOMENTUM_REGRESSOR,
    PASSIVITY_REGRESSOR,
    REGRESSOR,
)
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.nodes import Node


class _Kind(NamedTuple):
    """What a regressor is of."""

    function: Function
    #: from an arm and the inputs after q: the rows of Y of the bodies
    rows: Callable[..., Sequence[Sequence[Scalar]]]
    #: from the inputs after q: what rotors are multiplied by
    rotors: Callable[..., Sequence[Node]]
    #: whether friction and springs have columns that are not zero
    drives: bool = True


def _momentum_rows(arm: Posture, qd: Sequence[Node]) -> Sequence[Sequence[Scalar]]:
    """Return those of M qd: of torques at rest, without gravity, for the acceleration qd."""
    return body_regressor(weightless(arm), [0] * arm.nv, qd)


KINDS = {
    "tau": _Kind(REGRESSOR, body_regressor, lambda qd, qdd: qdd),
    "tau_passivity": _Kind(PASSIVITY_REGRESSOR, reference_regressor, lambda qd, qd_r, qdd_r: qdd_r),
    "momentum": _Kind(MOMENTUM_REGRESSOR, _momentum_rows, lambda qd: qd, drives=False),
}


@dataclass(frozen=True)
class Regressor:
    """The request for a regressor that says which parameters count, and of what it is.

        kernel = mc.compile(robot, functions=("tau", mc.Regressor(zeros=True)))
        Y, p = kernel.regressor(q, qd, qdd)

    ``zeros`` is that of ``robot.base_parameters(zeros)``: whether to keep (True) or leave out
    (False) all parameters whose value is zero. With ``standard`` it is of all standard parameters:
    XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ and M of every link in Khalil's frame, zero or not, and those
    of the drives. ``of`` is "tau", "tau_passivity" or "momentum": Y p is what the function of that
    name returns. Without ``values`` it returns Y alone: p is the same for all samples.
    """

    zeros: bool | None = None
    of: str = "tau"
    standard: bool = False
    values: bool = True

    def __post_init__(self) -> None:
        if self.zeros not in (None, True, False):
            raise TypeError(f"zeros must be True, False or None, not {self.zeros!r}")
        if self.of not in KINDS:
            raise ValueError(f"a regressor is of {', '.join(KINDS)}, not of {self.of!r}")
        if self.standard and self.zeros is not None:
            raise ValueError("a regressor of the standard parameters has all of them: leave zeros")

    def entry(self, model: Model) -> Function:
        """Return the function for a model."""
        return regressor(model, self.zeros, self.of, self.standard, self.values)


def regressor(
    model: Model,
    zeros: bool | None = None,
    of: str = "tau",
    standard: bool = False,
    values: bool = True,
) -> Function:
    """Return the function that ``Regressor`` asks for, of a model.

    Y (n x b) and p (b) are in the order of ``robot.base_parameters(zeros)``; standard ones from the
    base to the tips, those of a link in the order of ``PARAMETERS``, its drive's behind them.
    """
    kind = KINDS[of]
    base = None if standard else base_parameters_of(model, zeros)
    chosen = standard_parameters(model) if base is None else [x.leader for x in base]
    names = ", ".join(str(x.symbol) for x in (chosen if base is None else base))

    def build(system: System, q: Sequence[Node], *given: Sequence[Node]) -> Outputs:
        columns = list(zip(*kind.rows(system.posture(q), *given), strict=True))
        rotors, qd = kind.rotors(*given), given[0]

        def column(parameter: Standard) -> Sequence[Scalar]:
            link, name = parameter
            if name in PARAMETERS:
                return columns[len(PARAMETERS) * link + PARAMETERS.index(name)]
            own: Scalar = rotors[link]
            if name != "IA":
                drive = system.model.coordinates[link].drive
                terms = terms_of_drive(drive, q[link], qd[link], system.functions)
                own = terms[name] if kind.drives else 0
            return [own if i == link else 0 for i in range(model.nv)]

        Y = system.nodes(x for row in zip(*map(column, chosen), strict=True) for x in row)
        if not values:
            return [Y]
        if base is None:
            known = standard_values(system.model)
            return [Y, system.nodes(known[x] for x in chosen)]
        return [Y, list(map(Converter(system.graph, system.parameters), base.values))]

    return _described(kind.function, standard, values, names, len(chosen), build)


def standard_parameters(model: Model) -> list[Standard]:
    """Return the standard parameters of a model, those of its drives among them."""
    bodies = [Standard(i, name) for i in range(len(model.bodies)) for name in PARAMETERS]
    drives = [
        Standard(j, name) for j in range(model.nv) for name in ("IA", *drive_coefficients(model, j))
    ]
    return sorted(bodies + drives, key=lambda x: x.place)


def standard_values(model: Model) -> Mapping[Standard, Scalar]:
    """Return the values of the standard parameters, in the scalars of the model."""
    found: dict[Standard, Any] = {}
    for i, body in enumerate(model.bodies):
        found |= {Standard(i, name): x for name, x in parameters(body.moments).items()}
    for j, x in enumerate(model.coordinates):
        found[Standard(j, "IA")] = x.drive.rotor_inertia
        found |= {Standard(j, name): y for name, y in drive_coefficients(model, j).items()}
    return found


def _described(
    function: Function,
    standard: bool,
    values: bool,
    names: str,
    count: int,
    build: Callable[..., Outputs],
) -> Function:
    name, which = function.name, "base"
    Y, p = function.outputs
    if standard:
        which = "standard"
        name = name if name.startswith(which) else f"{which}_{name}"
        Y, p = (replace(a, description=a.description.replace("base", which)) for a in (Y, p))
    outputs = replace(Y, shape=("n", count)), replace(p, shape=(count,))
    return replace(
        function,
        name=name,
        kind=function.name,
        outputs=outputs if values else outputs[:1],
        summary=f"{function.summary} The {which} parameters p are, in this order, about the "
        f"origins of Khalil's frames: {names}.",
        build=build,
    )
