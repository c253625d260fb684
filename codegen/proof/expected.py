"""Every quantity of the dynamics at given states, by the symbolic route."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any
from zlib import crc32

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from moro.checks.constants import for_numpy
from moro.closed_form import ClosedForm
from moro.identification.base_parameters import base_parameters_of
from moro.model import Drive, Frame, Model, Placement
from moro.scalars.dual import DualRing
from moro.spatial.vectors import Scalar, Vector, add, scaled, times
from moro_codegen.functions.arguments import Argument
from moro_codegen.functions.catalogue import KNOWN
from moro_codegen.functions.regressors import standard_parameters, standard_values
from moro_codegen.proof.symbolic_route import STATES_LIMIT, Array, SymbolicRoute, spread

#: step of complex-step derivatives: Im f(x + ih) / h has no cancellation, so h may be tiny
STEP = 1e-30
#: states at which derivatives are evaluated, each of which takes n evaluations; and second ones
DERIVATIVE_STATES, SECOND_STATES = 8, 2
#: M is singular where a scaled eigenvalue is below so many roundings a joint
SINGULAR = 10
#: central differences of order 6: weights at h, 2 h, 3 h, and what h is of the scale of f
WEIGHTS, DIFFERENCE = (3 / 4, -3 / 20, 1 / 60), 1e-2
#: components of a state that are all smaller than this part of those of all states have no digits
FLOOR = 1e-3

#: on the link of the frame, in functions that take one; the same in single and double precision
WRENCH: Array = np.array([3.0, -5.0, 7.0, 1.125, 1.25, -1.75])
#: of what functions are given besides states
CHOSEN: dict[str, Any] = {"wrench": WRENCH, "dt": 1 / 64, "damping": 1 / 8}


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
    #: what functions are given besides, by name, states first
    others: dict[str, Array] = field(default_factory=dict)
    #: whether derivatives are evaluated at all states, however long it takes
    everywhere: bool = False
    _parts: dict[bytes, ExpectedDynamics] = field(default_factory=dict, repr=False)

    def given(self, argument: Argument) -> Array:
        """Return the values of an input, states first: of those that are not states, some."""
        states = {"q": self.q, "qd": self.qd, "qdd": self.qdd}
        name = own_name(argument.name)
        if name in states:
            return states[name]
        if name not in self.others:
            values = self.tau if name == "tau" else _some(name, argument.sizes, len(self.q))
            self.others[name] = values
        return self.others[name]

    def at(self, states: NDArray[np.int_]) -> ExpectedDynamics:
        """Return the same at some of the states, by index."""
        if len(states) == len(self.q):
            return self
        key = states.tobytes()
        if key not in self._parts:
            q, qd, qdd = self.q[states], self.qd[states], self.qdd[states]
            self._parts[key] = self.moved(q=q, qd=qd, qdd=qdd)
        part = self._parts[key]
        part.others.update((name, values[states]) for name, values in self.others.items())
        return part

    def moved(self, **changes: Any) -> ExpectedDynamics:
        """Return the same at other states: of q, qd, qdd and parameters."""
        there = replace(self, **changes, others={}, everywhere=True, _parts={})
        if "parameters" not in changes:
            there.drives = self.drives
        return there

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
        bias: Array = applied(self.C, self.qd) + self.G + self.friction
        return bias

    @cached_property
    def tau(self) -> Array:
        """M qdd + C qd + G + friction."""
        tau: Array = applied(self.M, self.qdd) + self.bias
        return tau

    @cached_property
    def K(self) -> Array:
        """The kinetic energy, 1/2 qd^T M qd."""
        energy: Array = 0.5 * np.sum(self.qd * applied(self.M, self.qd), axis=-1)
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

    def J_rate(self, frame: Frame) -> Array:
        """Return dJ/dt of a frame, (states, 6, n)."""
        rate: Array = np.einsum("skjl,sl->skj", self.J_slopes(frame), self.qd)
        return rate

    def J_slopes(self, frame: Frame) -> Array:
        """Return the derivatives of J by q, (states, 6, n, n), the last axis for those of q."""
        zero = self._form.ring.zero
        columns = self._form.geometry.jacobian(frame, (zero, zero, zero))
        slopes = np.array([[x.gradient for x in column] for column in columns])
        return np.moveaxis(slopes, (3, 1, 0, 2), (0, 1, 2, 3))

    @cached_property
    def center_of_mass(self) -> tuple[Array, Array]:
        """The centre of mass (states, 3), and its derivatives by q (states, 3, n)."""
        form = self._form
        convert, zero = form.ring.convert, form.ring.zero
        first: Vector = (zero, zero, zero)
        total: Scalar = zero
        for i, body in enumerate(self.model.bodies):
            R, p = form.geometry.pose(Frame("", i, Placement()))
            x, y, z = map(convert, body.first_moment)
            m = convert(body.mass)
            first, total = add(first, add(scaled(m, p), times(R, (x, y, z)))), total + m
        mass = total.value[:, np.newaxis]
        J = np.array([x.gradient for x in first]).transpose(2, 0, 1)
        return _values(first).T / mass, J / mass[:, np.newaxis]

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
        tau = np.imag(applied(M, qdd) + applied(C, qd) + G) / STEP
        by_q = np.moveaxis(tau.reshape(n, -1, n), 0, -1)
        friction = self.friction_slopes[few, :, np.newaxis] * np.eye(n)
        return by_q, 2 * self.C[few] + friction

    @cached_property
    def second_slopes(self) -> tuple[Array, Array, Array, Array]:
        """Second derivatives of tau by (q, q), (q, qd), (qd, qd) and (qdd, q), (states, n, n, n).

        Differences of the first ones; by qd twice, those of the rigid bodies are Christoffel's.
        """
        slopes = self._differences(lambda x: np.stack([*x.tau_slopes, x.M], axis=1))
        by_q_q, by_qd_q, by_qdd_q = np.moveaxis(slopes, 1, 0)
        units = np.eye(self.model.nv)
        rates = (self.moved(qd=np.broadcast_to(e, self.qd.shape)) for e in units)
        by_qd_qd = np.stack([2 * x.C for x in rates], axis=-1)
        n = np.arange(self.model.nv)
        by_qd_qd[:, n, n, n] += self._friction_curvature
        return by_q_q, by_qd_q.swapaxes(2, 3), by_qd_qd, by_qdd_q

    @property
    def parameter_slopes(self) -> Array:
        """Derivatives of tau by the parameters of the model, (states, n, p)."""
        columns = []
        for symbol in self.model.defaults:
            value = self.parameters[symbol]

            def tau(way: float, symbol: Any = symbol, value: float = value) -> Array:
                return self.moved(parameters={**self.parameters, symbol: value + way}).tau

            columns.append(_difference(tau, DIFFERENCE * (abs(value) or 1)))
        return np.stack(columns, axis=-1)

    def _differences(self, f: Callable[[ExpectedDynamics], Array]) -> Array:
        """Return the derivatives of f by q, on a further axis; f is asked once, for all of them."""
        ways = np.array([k * way for k in range(1, len(WEIGHTS) + 1) for way in (1, -1)])
        steps = DIFFERENCE * ways[:, np.newaxis, np.newaxis] * np.eye(self.model.nv)
        q = self.q + steps[:, :, np.newaxis]  # (steps, n, states, n)
        rest = (np.broadcast_to(x, q.shape).reshape(-1, x.shape[1]) for x in (self.qd, self.qdd))
        qd, qdd = rest
        found = f(self.moved(q=q.reshape(qd.shape), qd=qd, qdd=qdd))
        found = found.reshape(*q.shape[:3], *found.shape[1:])
        weights = np.repeat(WEIGHTS, 2) * np.sign(ways) / DIFFERENCE
        return np.moveaxis(np.tensordot(weights, found, 1), 0, -1)

    @property
    def _friction_curvature(self) -> Array:
        """Second derivatives of the friction by qd, (states, n)."""
        scales = [
            min(1.0, *(float(x) for x in (d.width, d.stribeck_velocity, 1) if x))
            for d in self.drives
        ]
        h = DIFFERENCE * np.array(scales)
        return _difference(lambda way: self.moved(qd=self.qd + way * h).friction_slopes, 1) / h

    @cached_property
    def few(self) -> NDArray[np.int_]:
        """The states for what takes long, by index."""
        if self.everywhere:
            return self.every
        complex_q = self.q[:DERIVATIVE_STATES] + 0j
        count = self.route.affordable(complex_q, self.parameters, STATES_LIMIT) // self.model.nv
        return spread(len(self.q), min(max(count, 1), DERIVATIVE_STATES))

    @property
    def every(self) -> NDArray[np.int_]:
        """All states, by index."""
        return np.arange(len(self.q))

    @property
    def moving(self) -> NDArray[np.int_]:
        """The states at which no joint with dry friction is at rest, by index."""
        dry = [i for i, drive in enumerate(self.drives) if is_dry(drive)]
        return np.flatnonzero(np.all(self.qd[:, dry] != 0, axis=1))

    @property
    def fewest(self) -> NDArray[np.int_]:
        """The states for what takes longest, by index."""
        return self.few if self.everywhere else self.few[:SECOND_STATES]

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

    def inertial_parameters(self, count: int) -> Array:
        """Return the base parameters of the model, or its standard ones, whichever are so many."""
        standard = standard_parameters(self.model)
        known = standard_values(self.model) if len(standard) == count else {}
        values = [known[x] for x in standard] if known else []
        for zeros in (None, False, True):
            if not values and len(base := base_parameters_of(self.model, zeros)) == count:
                values = list(base.values)
        found: Array = evaluated(values, self.parameters, 1)[0]
        return found

    def lost(self, values: Array) -> Array:
        """Return what errors of values that M was inverted for are relative to, (states).

        The last digits of a solution are lost by the condition number of M, measured with each
        joint's own inertia as its unit, and those of accelerations by what the torques cancel to.
        """
        units = np.sqrt(np.diagonal(self.M, axis1=1, axis2=2))
        condition = np.linalg.cond(self.M / units[:, :, np.newaxis] / units[:, np.newaxis, :])
        sizes = scales(values)
        if values.shape[1] == self.model.nv:
            rows = np.abs(values).reshape(*units.shape, -1) * units[:, :, np.newaxis]
            sizes = np.max(rows, axis=(1, 2))
            if values.ndim == 2:
                sizes = np.maximum(sizes, np.max(np.abs(self.tau) / units, axis=1))
            sizes = sizes / units.min(axis=1)
        lost: Array = self.model.nv * condition * sizes
        return lost

    @cached_property
    def _form(self) -> ClosedForm:
        """The formulas over numbers, for what is short anyway."""
        values = {**dict(zip(self.model.qs, self.q.T, strict=True)), **self.parameters}
        return ClosedForm(self.model, DualRing(self.model.qs, values))

    @cached_property
    def friction(self) -> Array:
        """Return the friction of all drives (states, n)."""
        return self._frictions(self.qd)

    @property
    def friction_slopes(self) -> Array:
        """Derivatives of the friction by qd, (states, n)."""
        slopes: Array = np.imag(self._frictions(self.qd + 1j * STEP)) / STEP
        return slopes

    def _frictions(self, qd: NDArray[Any]) -> Array:
        """Return the friction at these rates, which may be complex (states, n)."""
        columns = []
        for d, rate in zip(self.drives, qd.T, strict=True):
            forwards, backwards = self.magnitudes(d, rate)
            if d.width is None:
                step = np.where(rate.real > 0, forwards, np.where(rate.real < 0, -backwards, 0))
            else:
                s = np.tanh(rate / d.width)
                step = (forwards + backwards) / 2 * s + (forwards - backwards) / 2 * s * s
            columns.append(d.viscous * rate + step)
        friction: Array = np.stack(columns, axis=1)
        return friction

    @staticmethod
    def magnitudes(d: Drive, rate: NDArray[Any]) -> tuple[Any, Any]:
        """Return the magnitudes of Coulomb's and Stribeck's friction, forwards and backwards."""
        forwards, backwards = d.coulomb
        if d.static is not None:
            fading = np.exp(-((rate / d.stribeck_velocity) ** 2))
            forwards = forwards + (d.static[0] - forwards) * fading
            backwards = backwards + (d.static[1] - backwards) * fading
        return forwards, backwards

    @cached_property
    def drives(self) -> list[Drive]:
        """The drives, in numbers."""
        drives = [x.drive for x in self.model.coordinates]
        scalars = [x for drive in drives for x in drive.scalars]
        numbers = iter(evaluated(scalars, self.parameters, 1)[0])
        return [drive.map(lambda _: next(numbers)) for drive in drives]


#: names of what the functions of the catalogue are given, long ones first
_INPUTS = sorted({a.name for f in KNOWN.values() for a in f.inputs}, key=len, reverse=True)


def own_name(name: str) -> str:
    """Return what a function of the catalogue calls an input of it and others together."""
    return next((x for x in _INPUTS if name == x or name.endswith(f"_{x}")), name)


def _some(name: str, shape: Sequence[int], states: int) -> Array:
    """Return values of an input, exact in single precision, the same every time."""
    if name in CHOSEN:
        return np.broadcast_to(CHOSEN[name], (states, *shape))
    rng = np.random.default_rng(crc32(name.encode()))
    return rng.integers(-192, 192, (states, *shape)) / 64


def scales(expected: Array) -> Array:
    """Return for each state what errors of its results are relative to: the largest component."""
    largest = np.max(np.abs(expected), axis=tuple(range(1, expected.ndim)))
    # where everything must be zero, errors are absolute
    scale: Array = np.maximum(largest, FLOOR * float(np.max(largest, initial=0)) or 1.0)
    return scale


def is_dry(drive: Drive) -> bool:
    """Return whether a drive, in numbers, has friction that jumps."""
    return drive.width is None and any(x != 0 for x in (*drive.coulomb, *(drive.static or ())))


def solved(M: Array, b: Array) -> Array:
    """Return M^-1 b for vectors b, (states, n)."""
    solution: NDArray[Any] = np.linalg.solve(M, b[..., np.newaxis])[..., 0]
    return solution


def applied(matrices: Array, vectors: Array) -> Array:
    """Return A b, (states, m)."""
    product: Array = np.einsum("sij,sj->si", matrices, vectors)
    return product


def weighted(weights: Array, matrices: Array) -> Array:
    """Return w^T A, (states, n)."""
    product: Array = np.einsum("si,sij->sj", weights, matrices)
    return product


def _difference(f: Callable[[float], Array], h: float) -> Array:
    """Return df(0) by central differences, exact for polynomials of degree 6."""
    slopes = [w / h * (f(k * h) - f(-k * h)) for k, w in enumerate(WEIGHTS, 1)]
    slope: Array = np.sum(slopes, axis=0)
    return slope


def evaluated(expressions: Iterable[Any], values: Mapping[Any, Any], states: int) -> Array:
    """Return the values of SymPy expressions (states, expressions); symbols may have any name."""
    symbols = {symbol: sp.Dummy() for symbol in values}
    plain = [for_numpy(sp.sympify(x).xreplace(symbols)) for x in expressions]
    function = sp.lambdify(list(symbols.values()), plain, "numpy", cse=True)
    columns = [np.broadcast_to(x, states) for x in function(*values.values())]
    return np.stack(columns, axis=1).astype(float)


def _values(duals: Any) -> Array:
    return np.array([x.value for x in duals])


def _rows(matrix: Any) -> Array:
    return np.array([_values(row) for row in matrix])
