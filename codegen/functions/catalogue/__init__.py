"""What can be generated: for each function its name, arguments, meaning and algorithm."""

from __future__ import annotations

from moro_codegen.functions.arguments import QD, QDD, Argument, Q
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


#: what is known of it without a robot (``base_regressor``); b is the number of base parameters
REGRESSOR = Function(
    "regressor",
    (Q, QD, QDD),
    (
        Argument("Y", ("n", "b"), "SI", "torques (forces) per unit of each base parameter"),
        Argument("p", ("b",), "SI", "base parameters, with the values of the model"),
    ),
    "Regressor: tau = Y(q, qd, qdd) p, friction and rotor inertia included.",
    _of_no_robot,
    "body regressors (Atkeson, An & Hollerbach), columns of base parameters",
)

#: the functions that have a name
KNOWN = {**FUNCTIONS, REGRESSOR.name: REGRESSOR}
