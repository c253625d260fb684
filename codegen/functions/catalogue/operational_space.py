"""The equations of motion in operational space (Khatib 1987)."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.drives import spring_torques
from moro.algorithms.factorization import factorized, inverse_of_symmetric, solution
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import LAST, QD, Argument, Q
from moro_codegen.functions.catalogue.kinematics import jacobian_and_rate
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.singular import check_resisted
from moro_codegen.functions.system import System, dot, flat, parts, sum_of
from moro_codegen.graph.nodes import Node


def _operational_space(
    system: System, q: Sequence[Node], qd: Sequence[Node], damping: Sequence[Node]
) -> Outputs:
    n, still = system.model.nv, [0] * system.model.nv
    check_resisted(system.model, system.rotors)
    J, rate = jacobian_and_rate(system, q, qd)

    def dynamics(arm: Posture) -> Sequence[Scalar]:
        """Return X = M^-1 J^T, column after column, and C qd + G."""
        factors = factorized(joint_inertia(arm, system.rotors), arm)
        return [*flat(solution(factors, row) for row in J), *joint_torques(arm, qd, still)]

    found = system.dynamics(system.posture(q), dynamics)
    X, bias = parts(found[: 6 * n], 6), sum_of(found[6 * n :], spring_torques(system.model, q))
    mobility = [[dot(row, column) for column in X] for row in J]  # J M^-1 J^T
    for k in range(6):
        mobility[k][k] = mobility[k][k] + damping[0]
    inertia = inverse_of_symmetric(mobility)
    inverse = [[dot(row, column) for column in inertia] for row in zip(*X, strict=True)]
    forces = [dot(column, bias) for column in zip(*inverse, strict=True)]
    turned = [dot(row, rate) for row in inertia]
    mu = [x - y for x, y in zip(forces, turned, strict=True)]
    return [system.nodes(x) for x in (flat(inertia), mu, flat(inverse))]


FUNCTIONS = (
    Function(
        "operational_space",
        (
            Q,
            QD,
            Argument("damping", (), "SI", "added to the diagonal of J M^-1 J^T; 0 for none"),
        ),
        (
            Argument("Lambda", (6, 6), "kg, kg m, kg m^2", f"inertia that {LAST} has, symmetric"),
            Argument("mu", (6,), "N, N m", "force, moment for its acceleration 0; in frame 0"),
            Argument("J_bar", ("n", 6), "rad/m, 1", "dynamically consistent inverse of J"),
        ),
        f"Operational space of {LAST} (Khatib): F = Lambda (a, alpha) + mu and tau = J^T F with "
        "Lambda = 1/(J M^-1 J^T + damping 1), J_bar = M^-1 J^T Lambda and "
        "mu = J_bar^T (C qd + G) - Lambda dJ/dt qd; without friction. Where J is singular, as it "
        "always is for fewer than six joints, damping 0 gives no finite results.",
        _operational_space,
        "M = L^T D L solved for the rows of J, and the 6 x 6 matrix inverted by L D L^T",
        frame="",
    ),
)
