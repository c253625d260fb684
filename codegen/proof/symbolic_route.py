"""The symbolic route, evaluated: what a kernel's results must be at given states.

``moro.closed_form``: Jacobian sums, Christoffel symbols, the gradient of the potential energy. It
shares nothing with the recursive algorithms that kernels are made from.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from time import thread_time
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from moro.closed_form import ClosedForm
from moro.model import Model, as_model
from moro.scalars.trig import Trig, TrigRing
from moro_codegen.proof import at_states

Array: TypeAlias = NDArray[np.float64]

#: seconds that closed forms may take; the same formulas are evaluated as numbers otherwise
TIME_LIMIT = 5.0
#: seconds that the formulas at the states may take, and their derivatives: of more states, a part
STATES_LIMIT = 20.0


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
        known: dict[int, Any] = {}

        def numbers(row: Sequence[Trig]) -> Array:
            return np.array([self.ring.evaluate(p, values, known) for p in row])

        M, C = (np.array([numbers(row) for row in matrix]) for matrix in (self.M, self.C))
        return M, C, numbers(self.G)


def spread(count: int, some: int) -> NDArray[np.int_]:
    """Return the indices of so many states of ``count``, from the first to the last."""
    return np.linspace(0, count - 1, min(some, count)).astype(int)
