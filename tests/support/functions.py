"""Which functions of the catalogue a test asks for."""

import moro_codegen as mc

#: those that every robot has; by run-time parameters there is nothing to differentiate without one
COMMON = tuple(name for name in mc.FUNCTIONS if not name.endswith("parameter_derivatives"))
LONG = {"tau_second_derivatives", "tau_hessian", "forward_dynamics_hessian", "step_rk4"}
#: those that are short enough for long arms, and to be compiled again and again
SHORT = tuple(name for name in COMMON if name not in LONG)
