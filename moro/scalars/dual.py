"""Numbers that carry their derivatives: closed forms evaluated at states, without forming them.

A ``Dual`` is a value and its gradient with respect to the joint variables; both may be arrays over
many states. ``DualRing`` offers what ``TrigRing`` offers, so that the formulas of ``closed_form``
run on it unchanged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import sympy as sp

from moro.checks.constants import for_numpy

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

    ``values`` maps joint variables (and further symbols) to numbers or to arrays of one shape, real
    or complex.
    """

    half = 0.5

    def __init__(self, variables: Sequence[Any], values: Mapping[Any, Any]):
        self._variables = {variable: k for k, variable in enumerate(variables)}
        self._shape = np.broadcast_shapes(*(np.shape(v) for v in values.values()))
        self._type = np.result_type(float, *values.values())
        self._values = {
            symbol: np.broadcast_to(np.asarray(value, dtype=self._type), self._shape)
            for symbol, value in values.items()
        }
        self.zero = self.constant(0.0)
        self.one = self.constant(1.0)

    def constant(self, value: Any) -> Dual:
        """Return a number, or an array over the states, that no joint variable moves."""
        flat = np.broadcast_to(np.asarray(value, dtype=self._type), self._shape)
        none = np.zeros((), dtype=self._type)
        return Dual(flat, np.broadcast_to(none, (len(self._variables), *self._shape)))

    def declare_angles(self, angles: Any, groups: Any = None) -> None:
        """Nothing to prepare: numbers have no canonical form to choose."""

    def convert(self, expr: Any) -> Dual:
        """Return the value of a SymPy expression and its slopes: it may hold joint variables."""
        expr = sp.sympify(expr)
        if expr.is_number:
            return self.constant(float(expr))
        if expr in self._values:
            return self._known(expr)
        if expr.is_Add:
            return sum((self.convert(x) for x in expr.args[1:]), self.convert(expr.args[0]))
        if expr.is_Mul:
            return prod((self.convert(x) for x in expr.args[1:]), start=self.convert(expr.args[0]))
        return self._any(expr)

    def sincos(self, angle: Any) -> tuple[Dual, Dual]:
        """Return (sin, cos) of an angle that is a sum of joint variables and constants."""
        if sp.sympify(angle).is_number:  # exact zeros for exact quarter turns
            return self.constant(float(sp.sin(angle))), self.constant(float(sp.cos(angle)))
        x = self.convert(angle)
        s, c = np.sin(x.value), np.cos(x.value)
        return Dual(s, c * x.gradient), Dual(c, -s * x.gradient)

    def diff(self, x: Dual, variable: Any) -> Dual:
        """Return dx/dq_k as a number; its own slopes are not known, and NaN."""
        slope = x.gradient[self._variables[variable]]
        unknown = np.full((), np.nan, dtype=self._type)
        return Dual(slope, np.broadcast_to(unknown, x.gradient.shape))

    def _known(self, symbol: Any) -> Dual:
        """Return one of the values given."""
        number = self.constant(self._values[symbol])
        if symbol in self._variables:
            number.gradient = number.gradient.copy()
            number.gradient[self._variables[symbol]] = 1
        return number

    def _any(self, expr: Any) -> Dual:
        """Return the value of any expression, with its derivatives by the rules of SymPy."""
        number = self.constant(self._number(expr))
        for variable, k in self._variables.items():
            if expr.has(variable):
                if not number.gradient.flags.writeable:
                    number.gradient = number.gradient.copy()
                number.gradient[k] = self._number(sp.diff(expr, variable))
        return number

    def _number(self, expr: Any) -> Any:
        known = {s: sp.Dummy() for s in self._values if expr.has(s)}
        function = sp.lambdify(list(known.values()), for_numpy(expr.xreplace(known)), "numpy")
        return function(*(self._values[s] for s in known))
