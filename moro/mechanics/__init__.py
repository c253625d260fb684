"""Every symbolic quantity of the mechanics of a model.

derivation       the model, its closed forms, how they are shown; results are kept
kinematics       joints, frames, Jacobians, velocities
dynamics         energies, M, C, G, equations of motion
identification   base parameters, regressor
substitution     values put into results
state_space      accelerations, x' = f(x, u)
linearization    A and B at a point
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from moro.mechanics.identification import Identification
from moro.mechanics.kinematics import Kinematics
from moro.mechanics.linearization import Linearization


class Mechanics(Kinematics, Linearization, Identification):
    """What follows from the model that a source makes.

    Joints and links are counted from 1, frames from 0 (the base). Frame i is the model's frame
    called i, as those of DH rows are, or else that of joint i; any other is known by its name.
    """

    def simplify(self, expr: Any) -> Any:
        """Return an expression (or matrix) in the joint variables in canonical, shortest form.

        Exact: two expressions that are equal as trigonometric polynomials, or as quotients of
        them, become identical, and zero becomes 0: m1/(m1 + m2) + m2/(m1 + m2) is 1.
        """
        if isinstance(expr, sp.MatrixBase):
            return expr.applyfunc(self.simplify)
        return self._show(self._ring.convert(expr))

    def latex(self, expr: Any) -> str:
        r"""Return an expression, matrix or equation in LaTeX as texts do: s_{23}, \dot{q}_1."""
        return self._notation.latex(expr)
