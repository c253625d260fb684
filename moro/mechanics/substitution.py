"""Values for joint variables, their rates and parameters, put into results all at once.

One after the other, as ``subs`` with a list does, the derivative of a value would be taken:
Derivative(q_1(t), t) with 0.3 for q_1 is no velocity any more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.abc import t
from moro.checks import values as checks
from moro.identification.regressor import SymbolicRegressor
from moro.mechanics.derivation import Derivation
from moro.printing.collected import Collected
from moro.printing.notebook import Equations


class Substitution(Derivation):
    """Puts values into results."""

    def substitute(
        self,
        result: Any,
        q: Sequence[Any] | None = None,
        qd: Sequence[Any] | None = None,
        qdd: Sequence[Any] | None = None,
        parameters: Mapping[Any, Any] | None = None,
    ) -> Any:
        """Return a result with values for joint variables, velocities and accelerations.

        ``result`` is an expression, a matrix, an equation, a list of these, or what
        ``collect=True`` gives; it comes back as the same. ``q``, ``qd``, ``qdd`` have n values each
        [rad, m, s], None for those that stay; ``parameters`` maps symbols, or their names, to
        values. Values are numbers or expressions: exact ones stay exact, floats give numbers. Where
        ``q`` (or ``qd``) holds the time t, a trajectory, rates that are not given are its
        derivatives; else they stay symbols.
        """
        motion = [self._values_of(values, "q" + "d" * k) for k, values in enumerate((q, qd, qdd))]
        fixed = self._source.by_symbol(parameters or {}, "parameters")
        fixed = {s: _value(x, f"value of {s}") for s, x in fixed.items()}
        return self._put(result, motion, fixed)

    def _values_of(self, values: Sequence[Any] | None, name: str) -> list[Any]:
        if values is None:
            return [None] * self.dof
        found = checks.scalars(values, self.dof, name, of="joint")
        return [
            None if x is None else _value(x, f"{name} of joint {i}") for i, x in enumerate(found, 1)
        ]

    def _put(self, result: Any, motion: list[list[Any]], fixed: Mapping[Any, Any]) -> Any:
        def put(x: Any) -> Any:
            return self._put(x, motion, fixed)

        if isinstance(result, Collected):
            return replace(
                result,
                matrix=put(result.matrix),
                constants={k: put(x) for k, x in result.constants.items()},
                right=put(result.right),
                _expanded=lambda: put(result.expand()),
            )
        if isinstance(result, Equations):
            return Equations(map(put, result), self._notation)
        if isinstance(result, SymbolicRegressor):
            return SymbolicRegressor(put(result.Y), put(result.p), self._notation)
        if isinstance(result, (list, tuple)):
            return type(result)(map(put, result))
        if isinstance(result, sp.MatrixBase):
            return result.applyfunc(put)
        if isinstance(result, sp.Equality):
            return sp.Eq(put(result.lhs), put(result.rhs), evaluate=False)
        if not isinstance(result, (sp.Basic, int, float)):
            raise TypeError(
                f"substitute takes an expression, a matrix, equations, not {checks.brief(result)}"
            )
        return self._replaced(sp.sympify(result), motion, fixed)

    def _replaced(self, expr: Any, motion: list[list[Any]], fixed: Mapping[Any, Any]) -> Any:
        rules = {**fixed, **{x: x for x in expr.atoms(sp.Derivative)}}
        rules |= {q: x for q, x in zip(self.qs, motion[0], strict=True) if x is not None}
        moving = [any(x is not None and x.has(t) for x in values) for values in motion]
        for x in expr.atoms(sp.Derivative):
            if x.expr in self.qs and all(v == t for v in x.variables):
                values = [orders[self.qs.index(x.expr)] for orders in motion]
                rules[x] = _rate(x, len(x.variables), values, moving)
        return expr.xreplace(rules)


def _rate(derivative: Any, order: int, values: Sequence[Any], moving: Sequence[bool]) -> Any:
    """Return the value of a derivative of some order with respect to time, or itself.

    ``values`` are those of the variable, its first and second derivative, None where not given;
    ``moving`` tells which of the three are given as a trajectory.
    """
    known = [k for k, x in enumerate(values[: order + 1]) if x is not None]
    if known and (known[-1] == order or moving[known[-1]]):
        return values[known[-1]].diff(t, order - known[-1])
    return derivative


def _value(x: Any, what: str) -> Any:
    """Return a value that is real and finite: a float as it is, so that results are numbers."""
    exact = checks.scalar(x, what)
    return sp.sympify(x) if checks.has_float(x) else exact
