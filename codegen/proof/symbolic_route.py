"""The symbolic route, evaluated: what a kernel's results must be at given states.

``moro.closed_form``: Jacobian sums, Christoffel symbols, the gradient of the potential energy. It
shares nothing with the recursive algorithms that kernels are made from.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from time import thread_time
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from moro.checks.constants import for_numpy
from moro.closed_form import ClosedForm
from moro.model import Drive, Frame, Model, as_model
from moro.scalars.dual import DualRing
from moro.scalars.trig import Trig, TrigRing
from moro_codegen.proof import at_states

Array: TypeAlias = NDArray[np.float64]

#: seconds that closed forms may take; the same formulas are evaluated as numbers otherwise
TIME_LIMIT = 5.0
#: seconds that the formulas at the states may take, and their derivatives: of more states, a part
STATES_LIMIT = 20.0
#: step of complex-step derivatives: Im f(x + ih) / h has no cancellation, so h may be tiny
STEP = 1e-30
#: states at which derivatives are evaluated, each of which takes n evaluations
DERIVATIVE_STATES = 8
#: M is singular where a scaled eigenvalue is below so many roundings a joint
SINGULAR = 10


class SymbolicRoute:
    """The dynamics of a model by the symbolic route: derived once, evaluated at any states.

    ``is_closed_form`` tells whether the closed forms were done within ``time_limit`` [s]; if not,
    the same formulas are evaluated as numbers that carry their derivatives.
    """

    def __init__(self, robot: Any, time_limit: float = TIME_LIMIT):
        self.model = as_model(robot)
        # no names: a parameter of the model's may have any
        self._velocities = [sp.Dummy(f"qd_{i}") for i in range(1, self.model.nv + 1)]
        self._closed: _Closed | None = None
        with suppress(TimeoutError):
            self._closed = _Closed.of(self.model, self._velocities, TrigRing(time_limit))

    @property
    def is_closed_form(self) -> bool:
        """Whether M, C and G are known in closed form."""
        return self._closed is not None

    @property
    def name(self) -> str:
        """What kernels are compared with, in words."""
        return "closed form" if self.is_closed_form else "formulas evaluated at the states"

    @property
    def terms(self) -> int | None:
        """Number of terms of the closed forms M, C and G; None without them."""
        return None if self._closed is None else self._closed.terms

    def tau(self, q: Array, qd: Array, qdd: Array, parameters: Mapping[Any, float]) -> Array:
        """Return M qdd + C qd + G + friction for states of shape (states, n)."""
        return ExpectedDynamics(self, q, qd, qdd, parameters).tau

    def matrices(
        self, q: NDArray[Any], qd: Array, parameters: Mapping[Any, float]
    ) -> tuple[Array, Array, Array]:
        """Return M, C (states, n, n) and G (states, n); q and qd, (states, n), may be complex."""
        size = at_states.block(self.model.nv)
        parts = []
        for k in range(0, len(q), size):
            values = {**dict(zip(self.model.qs, q[k : k + size].T, strict=True)), **parameters}
            rates = qd[k : k + size].T
            if self._closed is None:
                parts.append(at_states.matrices(self.model, values, rates))
            else:
                known = dict(zip(self._velocities, rates, strict=True))
                parts.append(self._closed.evaluate({**values, **known}))
        M, C, G = (np.concatenate(same, axis=-1) for same in zip(*parts, strict=True))
        return np.moveaxis(M, -1, 0), np.moveaxis(C, -1, 0), G.T

    def affordable(self, q: NDArray[Any], parameters: Mapping[Any, float], limit: float) -> int:
        """Return how many states like these, at least one, are evaluated within so many seconds.

        The first ones are evaluated to find out; in closed form any number is affordable.
        """
        if self.is_closed_form:
            return len(q)
        few = q[: at_states.block(self.model.nv)]
        start = thread_time()
        self.matrices(few, np.ones_like(few), parameters)
        return max(1, int(limit / (thread_time() - start) * len(few)))


@dataclass(frozen=True)
class _Closed:
    """M, C and G as polynomials of a ring."""

    ring: TrigRing
    M: list[list[Trig]]
    C: list[list[Trig]]
    G: list[Trig]

    @classmethod
    def of(cls, model: Model, velocities: Sequence[Any], ring: TrigRing) -> _Closed:
        """Return the closed forms. Raise TimeoutError when the ring does."""
        form = ClosedForm(model, ring)
        C = form.coriolis_matrix([ring.convert(v) for v in velocities])
        return cls(ring, form.inertia_matrix, C, form.gravity_vector)

    @property
    def terms(self) -> int:
        return sum(len(p) for row in (*self.M, *self.C, self.G) for p in row)

    def evaluate(self, values: Mapping[Any, Any]) -> tuple[Array, Array, Array]:
        """Return M, C (n, n, states) and G (n, states)."""

        def numbers(row: Sequence[Trig]) -> Array:
            return np.array([self.ring.evaluate(p, values) for p in row])

        M, C = (np.array([numbers(row) for row in matrix]) for matrix in (self.M, self.C))
        return M, C, numbers(self.G)


@dataclass
class ExpectedDynamics:
    """Every quantity of the dynamics at given states, computed when it is asked for.

    ``q``, ``qd`` and ``qdd`` are (states, n); so is everything else, states first.
    """

    route: SymbolicRoute
    q: Array
    qd: Array
    qdd: Array
    parameters: Mapping[Any, float]
    #: of the arithmetic that is judged
    rounding: float = float(np.finfo(float).eps)

    @property
    def model(self) -> Model:
        """The model."""
        return self.route.model

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
        """The potential energy, with that of springs."""
        form = self._form
        energy: Array = _values([*form.potential_energies, form.spring_energy]).sum(axis=0)
        return energy

    def T(self, frame: Frame) -> Array:
        """Return the pose of a frame in frame 0, (states, 4, 4)."""
        R, p = self._form.geometry.pose(frame)
        T = np.zeros((len(self.q), 4, 4))
        T[:, :3, :3] = np.moveaxis(_rows(R), -1, 0)
        T[:, :3, 3] = _values(p).T
        T[:, 3, 3] = 1
        return T

    def J(self, frame: Frame) -> Array:
        """Return the Jacobian of a frame, (states, 6, n), linear rows first."""
        zero = self._form.ring.zero
        columns = self._form.geometry.jacobian(frame, (zero, zero, zero))
        J: Array = _rows(columns).transpose(2, 1, 0)
        return J

    @cached_property
    def tau_slopes(self) -> tuple[Array, Array]:
        """Derivatives of tau by q and qd at ``few`` states.

        By q in complex steps. C qd is quadratic in qd with symmetric c_ijk, so by qd they are 2 C.
        """
        n, few = self.model.nv, self.few
        steps = 1j * STEP * np.eye(n)[:, np.newaxis, :]  # one for each variable
        q = (self.q[few] + steps).reshape(-1, n)
        qd, qdd = (np.tile(x[few], (n, 1)) for x in (self.qd, self.qdd))
        M, C, G = self.route.matrices(q, qd, self.parameters)
        tau = np.imag(_apply(M, qdd) + _apply(C, qd) + G) / STEP
        by_q = np.moveaxis(tau.reshape(n, -1, n), 0, -1)
        friction = np.imag(self._frictions(self.qd[few] + 1j * STEP)) / STEP
        return by_q, 2 * self.C[few] + friction[:, :, np.newaxis] * np.eye(n)

    @cached_property
    def few(self) -> NDArray[np.int_]:
        """The states for what takes long, by index."""
        complex_q = self.q[:DERIVATIVE_STATES] + 0j
        count = self.route.affordable(complex_q, self.parameters, STATES_LIMIT) // self.model.nv
        return spread(len(self.q), min(max(count, 1), DERIVATIVE_STATES))

    @cached_property
    def regular(self) -> NDArray[np.bool_]:
        """Tell for each state whether M can be inverted in arithmetic with ``rounding``.

        M is measured by each joint's greatest inertia in all the states: what matters is neither
        the units nor that a wrist is lighter than a shoulder.
        """
        felt = np.max(np.diagonal(self.M, axis1=1, axis2=2), axis=0)
        felt = np.sqrt(np.where(felt > 0, felt, 1.0))
        least = np.linalg.eigvalsh(self.M / felt / felt[:, np.newaxis])[:, 0]
        regular: NDArray[np.bool_] = least > SINGULAR * self.model.nv * self.rounding
        return regular

    @cached_property
    def _form(self) -> ClosedForm:
        """The formulas over numbers, for what is short anyway."""
        values = {**dict(zip(self.model.qs, self.q.T, strict=True)), **self.parameters}
        return ClosedForm(self.model, DualRing(self.model.qs, values))

    @cached_property
    def _friction(self) -> Array:
        """Return the friction of all drives (states, n)."""
        return self._frictions(self.qd)

    def _frictions(self, qd: NDArray[Any]) -> Array:
        """Return the friction at these rates, which may be complex (states, n)."""
        columns = []
        for d, rate in zip(self._drives, qd.T, strict=True):
            forwards, backwards = d.coulomb
            if d.static is not None:
                fading = np.exp(-((rate / d.stribeck_velocity) ** 2))
                forwards = forwards + (d.static[0] - forwards) * fading
                backwards = backwards + (d.static[1] - backwards) * fading
            if d.width is None:
                step = np.where(rate.real > 0, forwards, np.where(rate.real < 0, -backwards, 0))
            else:
                s = np.tanh(rate / d.width)
                step = (forwards + backwards) / 2 * s + (forwards - backwards) / 2 * s * s
            columns.append(d.viscous * rate + step)
        friction: Array = np.stack(columns, axis=1)
        return friction

    @cached_property
    def _drives(self) -> list[Drive]:
        """The drives, in numbers."""
        drives = [x.drive for x in self.model.coordinates]
        scalars = [x for drive in drives for x in drive.scalars]
        numbers = iter(evaluated(scalars, self.parameters, 1)[0])
        return [drive.map(lambda _: next(numbers)) for drive in drives]


def evaluated(expressions: Iterable[Any], values: Mapping[Any, Any], states: int) -> Array:
    """Return the values of SymPy expressions (states, expressions); symbols may have any name."""
    symbols = {symbol: sp.Dummy() for symbol in values}
    plain = [for_numpy(sp.sympify(x).xreplace(symbols)) for x in expressions]
    function = sp.lambdify(list(symbols.values()), plain, "numpy", cse=True)
    columns = [np.broadcast_to(x, states) for x in function(*values.values())]
    return np.stack(columns, axis=1).astype(float)


def spread(count: int, some: int) -> NDArray[np.int_]:
    """Return the indices of so many states of ``count``, from the first to the last."""
    return np.linspace(0, count - 1, min(some, count)).astype(int)


def _apply(matrices: Array, vectors: Array) -> Array:
    product: Array = np.einsum("sij,sj->si", matrices, vectors)
    return product


def _values(duals: Any) -> Array:
    return np.array([x.value for x in duals])


def _rows(matrix: Any) -> Array:
    return np.array([_values(row) for row in matrix])
