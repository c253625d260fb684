"""What can be generated: for each function its name, arguments, meaning and algorithm."""

from __future__ import annotations

from dataclasses import replace

from moro_codegen.functions.arguments import QD, QD_R, QDD, QDD_R, Argument, Q
from moro_codegen.functions.catalogue import (
    derivatives,
    energies,
    forward_dynamics,
    inverse_dynamics,
    kinematics,
    matrices,
    momentum,
    operational_space,
    parameter_derivatives,
    products,
    second_derivatives,
    steps,
)
from moro_codegen.functions.function import Function, Outputs

FUNCTIONS = {
    function.name: function
    for group in (
        inverse_dynamics,
        matrices,
        forward_dynamics,
        derivatives,
        kinematics,
        energies,
        momentum,
        operational_space,
        products,
        second_derivatives,
        parameter_derivatives,
        steps,
    )
    for function in group.FUNCTIONS
}


def _of_no_robot(*_: object) -> Outputs:
    raise ValueError("the regressor is that of a robot: compile(robot, functions=('regressor',))")


def _regressor(name: str, inputs: tuple[Argument, ...], summary: str, of: str) -> Function:
    """Return what is known of a regressor without a robot (``regressors``); b parameters."""
    return Function(
        name,
        inputs,
        (
            Argument("Y", ("n", "b"), "SI", f"{of} per unit of each base parameter"),
            Argument("p", ("b",), "SI", "base parameters, with the values of the model"),
        ),
        summary,
        _of_no_robot,
        "body regressors (Atkeson, An & Hollerbach), columns of base parameters",
    )


TORQUES = "torques (forces)"
REGRESSOR = _regressor(
    "regressor",
    (Q, QD, QDD),
    "Regressor: tau = Y(q, qd, qdd) p, friction and rotor inertia included.",
    TORQUES,
)
PASSIVITY_REGRESSOR = _regressor(
    "passivity_regressor",
    (Q, QD, QD_R, QDD_R),
    "Regressor of tau_passivity, for adaptive control: Y(q, qd, qd_r, qdd_r) p.",
    TORQUES,
)
MOMENTUM_REGRESSOR = _regressor(
    "momentum_regressor",
    (Q, QD),
    "Regressor of the momentum: M(q) qd = Y(q, qd) p, with zeros for friction and springs.",
    "momenta",
)
STANDARD_REGRESSOR = replace(
    REGRESSOR,
    name="standard_regressor",
    summary="Regressor in the standard parameters, ten a link and those of the drives, zero or "
    "not: tau = Y(q, qd, qdd) p.",
    algorithm="body regressors (Atkeson, An & Hollerbach)",
)
REGRESSORS = (REGRESSOR, PASSIVITY_REGRESSOR, MOMENTUM_REGRESSOR, STANDARD_REGRESSOR)

#: the functions that have a name
KNOWN = {**FUNCTIONS, **{function.name: function for function in REGRESSORS}}
