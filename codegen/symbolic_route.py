"""The symbolic route, evaluated: what a kernel's results must be at given states.

``moro.closed_form``: Jacobian sums, Christoffel symbols, the gradient of the potential energy. It
shares nothing with the recursive algorithms that kernels are made from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import sympy as sp

from moro import Robot
from moro.abc import t
from moro.closed_form import ClosedForm
from moro.dual import DualRing
from moro.trig import TrigRing

Array: TypeAlias = npt.NDArray[np.float64]

#: seconds that closed forms may take; the same formulas are evaluated as numbers otherwise
TIME_LIMIT = 5.0
#: step of complex-step derivatives: Im f(x + ih) / h has no cancellation, so h may be tiny
STEP = 1e-30
#: states at which derivatives are evaluated, each of which takes 2 n evaluations
DERIVATIVE_STATES = 8


class SymbolicRoute:
    """The dynamics of a robot by the symbolic route: derived once, evaluated at any states.

    ``is_closed_form`` tells whether the closed forms were done within ``time_limit`` [s]; if not,
    the same formulas are evaluated as numbers that carry their derivatives.
    """

    def __init__(self, robot: Robot, time_limit: float = TIME_LIMIT):
        self.robot = robot
        self._velocities = [sp.Symbol(f"qd_{i}") for i in range(1, robot.dof + 1)]
        try:
            self._derive(TrigRing(time_limit))
            self.is_closed_form = True
        except TimeoutError:
            self.is_closed_form = False

    def _derive(self, ring: TrigRing) -> None:
        form = ClosedForm(self.robot.arm, ring)
        self._ring = ring
        self._M = form.inertia_matrix
        self._C = form.coriolis_matrix([ring.convert(v) for v in self._velocities])
        self._G = form.gravity_vector

    @property
    def name(self) -> str:
        """What kernels are compared with, in words."""
        return "closed form" if self.is_closed_form else "formulas evaluated at the states"

    @property
    def terms(self) -> int:
        """Number of terms of the closed forms M, C and G."""
        return sum(len(p) for row in (*self._M, *self._C, self._G) for p in row)

    def tau(self, q: Array, qd: Array, qdd: Array, parameters: Mapping[Any, float]) -> Array:
        """Return M qdd + C qd + G + friction for states of shape (states, n)."""
        return Dynamics(self, q, qd, qdd, parameters).tau

    def matrices(
        self, q: Array, qd: Array, parameters: Mapping[Any, float]
    ) -> tuple[Array, Array, Array]:
        """Return M, C (states, n, n) and G (states, n); q and qd may be complex in closed form."""
        values = {**dict(zip(self.robot.qs, q.T, strict=True)), **parameters}
        evaluate = self._by_closed_form if self.is_closed_form else self._by_formulas
        M, C, G = evaluate(values, qd)
        return np.moveaxis(M, -1, 0), np.moveaxis(C, -1, 0), G.T

    def _by_closed_form(self, values: Mapping[Any, Any], qd: Array) -> tuple[Array, Array, Array]:
        values = {**values, **dict(zip(self._velocities, qd.T, strict=True))}

        def numbers(row: Any) -> Array:
            return np.array([self._ring.evaluate(p, values) for p in row])

        M, C = (np.array([numbers(row) for row in matrix]) for matrix in (self._M, self._C))
        return M, C, numbers(self._G)

    def _by_formulas(self, values: Mapping[Any, Any], qd: Array) -> tuple[Array, Array, Array]:
        ring = DualRing(self.robot.qs, values)
        form = ClosedForm(self.robot.arm, ring)
        rates = [ring.constant(v) for v in qd.T]
        return (
            _rows(form.inertia_matrix),
            _rows(form.coriolis_matrix(rates)),
            _values(form.gravity_vector),
        )


@dataclass
class Dynamics:
    """Every quantity of the dynamics at given states, computed when it is asked for.

    ``q``, ``qd`` and ``qdd`` are (states, n); so is everything else, states first.
    """

    route: SymbolicRoute
    q: Array
    qd: Array
    qdd: Array
    parameters: Mapping[Any, float]

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.route.robot

    @cached_property
    def _matrices(self) -> tuple[Array, Array, Array]:
        return self.route.matrices(self.q, self.qd, self.parameters)

    @property
    def M(self) -> Array:
        """The inertia matrix."""
        return self._matrices[0]

    @property
    def C(self) -> Array:
        """The Coriolis matrix of the Christoffel symbols."""
        return self._matrices[1]

    @property
    def G(self) -> Array:
        """The gravity vector."""
        return self._matrices[2]

    @cached_property
    def bias(self) -> Array:
        """C qd + G + friction."""
        bias: Array = _apply(self.C, self.qd) + self.G + self._friction
        return bias

    @cached_property
    def tau(self) -> Array:
        """M qdd + C qd + G + friction."""
        tau: Array = _apply(self.M, self.qdd) + self.bias
        return tau

    @cached_property
    def K(self) -> Array:
        """The kinetic energy, 1/2 qd^T M qd."""
        energy: Array = 0.5 * np.sum(self.qd * _apply(self.M, self.qd), axis=-1)
        return energy

    @cached_property
    def P(self) -> Array:
        """The potential energy."""
        energy: Array = _values(self._form.potential_energies).sum(axis=0)
        return energy

    @cached_property
    def T(self) -> Array:
        """The pose of frame n in frame 0, (states, 4, 4)."""
        n = self.robot.dof
        T = np.zeros((len(self.q), 4, 4))
        T[:, :3, :3] = np.moveaxis(_rows(self._form.chain.R(n - 1)), -1, 0)
        T[:, :3, 3] = _values(self._form.chain.origins[n - 1]).T
        T[:, 3, 3] = 1
        return T

    @cached_property
    def J(self) -> Array:
        """The Jacobian of frame n, (states, 6, n), linear rows first."""
        chain, zero = self._form.chain, self._form.ring.zero
        columns = chain.jacobian_in_base(self.robot.dof - 1, [zero] * 3)
        J: Array = _rows(columns).transpose(2, 1, 0)
        return J

    @cached_property
    def tau_slopes(self) -> tuple[Array, Array]:
        """Derivatives of tau by q and qd at ``few`` states: complex steps in the closed form."""
        n, few = self.robot.dof, self.few
        steps = 1j * STEP * np.eye(2 * n)[:, np.newaxis, :]  # one for each variable
        q = (self.q[few] + steps[..., :n]).reshape(-1, n)
        qd = (self.qd[few] + steps[..., n:]).reshape(-1, n)
        qdd = np.tile(self.qdd[few], (2 * n, 1))
        M, C, G = self.route.matrices(q, qd, self.parameters)
        tau = np.imag(_apply(M, qdd) + _apply(C, qd) + G) / STEP
        slopes = np.moveaxis(tau.reshape(2 * n, -1, n), 0, -1)
        viscous = [
            float(sp.sympify(x).subs(dict(self.parameters)))
            for x in self.robot.viscous_friction or [0] * n
        ]
        return slopes[..., :n], slopes[..., n:] + np.diag(viscous)

    @property
    def few(self) -> slice:
        """The states for what takes long."""
        return slice(None, None, max(1, len(self.q) // DERIVATIVE_STATES))

    @cached_property
    def _form(self) -> ClosedForm:
        """The formulas over numbers, for what is short anyway."""
        values = {**dict(zip(self.robot.qs, self.q.T, strict=True)), **self.parameters}
        return ClosedForm(self.robot.arm, DualRing(self.robot.qs, values))

    @cached_property
    def _friction(self) -> Array:
        rates = [q.diff(t) for q in self.robot.qs]
        symbols = [sp.Dummy() for _ in rates]
        vector = self.robot.friction_vector().xreplace(dict(zip(rates, symbols, strict=True)))
        torque = sp.lambdify([*symbols, *self.parameters], list(vector), "numpy")
        columns = torque(*self.qd.T, *self.parameters.values())
        friction: Array = np.stack([np.broadcast_to(x, len(self.qd)) for x in columns], axis=1)
        return friction.astype(float)


def _apply(matrices: Array, vectors: Array) -> Array:
    product: Array = np.einsum("sij,sj->si", matrices, vectors)
    return product


def _values(duals: Any) -> Array:
    return np.array([x.value for x in duals])


def _rows(matrix: Any) -> Array:
    return np.array([_values(row) for row in matrix])
