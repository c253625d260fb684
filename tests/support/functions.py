"""Which functions of the catalogue a test asks for."""

import moro_codegen as mc

#: those that every robot has; by run-time parameters there is nothing to differentiate without one
COMMON = tuple(name for name in mc.FUNCTIONS if not name.endswith("parameter_derivatives"))
LONG = {"tau_second_derivatives", "tau_hessian", "forward_dynamics_hessian", "step_rk4"}
#: those that are short enough for long arms, and to be compiled again and again
SHORT = tuple(name for name in COMMON if name not in LONG)
#: one of each kind, for sweeps: by every algorithm, with every shape of inputs and results
KINDS = (
    *("tau", "tau_with_wrench", "bias", "gravity_vector", "inertia_matrix", "coriolis_matrix"),
    *("forward_dynamics", "tau_derivatives", "forward_dynamics_derivatives", "tau_vjp"),
    *("forward_kinematics", "jacobian", "jacobian_position_hessian", "frame_acceleration"),
    *("kinetic_energy", "potential_energy", "momentum_bias", "tau_passivity", "center_of_mass"),
    *("operational_space", "step_semi_implicit", "regressor"),
)
