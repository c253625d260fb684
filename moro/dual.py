"""Numbers that carry their derivatives: closed forms evaluated at states, without forming them.

A ``Dual`` is a value and its gradient with respect to the joint variables; both may be arrays over
many states. ``DualRing`` offers what ``TrigRing`` offers, so that the formulas of ``closed_form``
run on it unchanged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import sympy as sp

Array: TypeAlias = npt.NDArray[np.float64]


class Dual:
    """``value + gradient . dq``, with the product rule: d(x y) = dx y + x dy."""

    __slots__ = ("gradient", "value")

    def __init__(self, value: Array, gradient: Array):
        self.value = value
        self.gradient = gradient

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.value + other.value, self.gradient + other.gradient)

    def __sub__(self, other: Dual) -> Dual:
        return Dual(self.value - other.value, self.gradient - other.gradient)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.gradient)

    def __mul__(self, other: Dual | float) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value * other, self.gradient * other)
        return Dual(
            self.value * other.value,
            self.gradient * other.value + self.value * other.gradient,
        )

    __rmul__ = __mul__


class DualRing:
    """The scalars of an arm at given states.

    ``values`` maps joint variables (and further symbols) to numbers or to arrays of one shape.
    """

    half = 0.5

    def __init__(self, variables: Sequence[Any], values: Mapping[Any, Any]):
        self._variables = list(variables)
        self._shape = np.broadcast_shapes(*(np.shape(v) for v in values.values()))
        self._values = {
            symbol: np.broadcast_to(np.asarray(value, dtype=float), self._shape)
            for symbol, value in values.items()
        }
        self.zero = self.constant(0.0)
        self.one = self.constant(1.0)

    def constant(self, value: Any) -> Dual:
        """Return a number, or an array over the states, that no joint variable moves."""
        flat = np.broadcast_to(np.asarray(value, dtype=float), self._shape)
        return Dual(flat, np.zeros((len(self._variables), *self._shape)))

    def declare_angles(self, group: Any) -> None:
        """Nothing to prepare: numbers have no canonical form to choose."""

    def convert(self, expr: Any) -> Dual:
        """Return the value of a SymPy expression and its slopes: it may hold joint variables."""
        expr = sp.sympify(expr)
        value = self.constant(self._number(expr))
        for k, q in enumerate(self._variables):
            if expr.has(q):
                value.gradient[k] = self._number(sp.diff(expr, q))
        return value

    def sincos(self, angle: Any) -> tuple[Dual, Dual]:
        """Return (sin, cos) of an angle that is a sum of joint variables and constants."""
        x = self.convert(angle)
        s, c = np.sin(x.value), np.cos(x.value)
        if not sp.sympify(angle).free_symbols:  # exact zeros for exact quarter turns
            s, c = (self._number(f(angle)) for f in (sp.sin, sp.cos))
        return Dual(s, c * x.gradient), Dual(c, -s * x.gradient)

    def diff(self, x: Dual, variable: Any) -> Dual:
        """Return dx/dq_k as a number; its own slopes are not known, and NaN."""
        slope = x.gradient[self._variables.index(variable)]
        return Dual(slope, np.full_like(x.gradient, np.nan))

    def _number(self, expr: Any) -> Any:
        if expr.is_number:
            return np.full(self._shape, float(expr))
        known = [s for s in self._values if expr.has(s)]
        return sp.lambdify(known, expr, "numpy")(*(self._values[s] for s in known))
