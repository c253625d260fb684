"""The symbolic route: the geometry and the dynamics of a model by the formulas of the texts.

geometry   frames, joint axes, Jacobians, velocities
dynamics   M, Christoffel symbols, C, G; energies, Euler-Lagrange
slopes     how M qdd + C qd + G changes with the state
inverse    the inverse of M, by cofactors
"""

from moro.closed_form.dynamics import ClosedForm
from moro.closed_form.geometry import Geometry

__all__ = ["ClosedForm", "Geometry"]
