"""Which functions of an arm's parameters depend on others: exact linear algebra over its geometry.

At a random point of a prime field (``random_point``) independent functions show themselves by a
rank, and there is no doubt about it: functions independent at one point are independent. Those that
look dependent there are solved for, by Cramer's rule over trigonometric polynomials, and the
solution is proven by putting it in.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, TypeAlias

import sympy as sp

from moro.identification.standard_parameters import Energies, Standard
from moro.model import Model
from moro.scalars.random_point import RandomPoint, dependences
from moro.scalars.trig import Trig, TrigRing

#: factors of a function's monomials in positions and velocities: (0 for K or 1 for P, monomial)
Coefficients: TypeAlias = "dict[tuple[int, int], Trig]"


class Independence:
    """The linear dependences of the parameters' functions (K_k, P_k but for a constant)."""

    def __init__(self, model: Model, ring: TrigRing, rates: Sequence[Any]):
        self.model = model
        self.ring = ring
        self.rates = rates
        self._qs = model.qs
        self._energies = Energies(model, ring, [ring.convert(x) for x in rates])

    def dependences(self, parameters: Sequence[Standard]) -> dict[Standard, dict[Standard, Trig]]:
        """Return {dependent parameter: {independent one before it: factor}}.

        A parameter without effect on the torques depends on none. The others are independent. (A
        point where independent functions look dependent has a chance of about 1e-7; the proof fails
        then, and another point is tried.)
        """
        for seed in itertools.count():
            point = self._point(len(parameters), seed)
            dependent = dependences(self._rows_at(point, parameters), point.prime)
            found = {
                parameters[k]: self._factors(parameters[k], [parameters[j] for j in others], point)
                for k, others in dependent.items()
            }
            proven = {k: factors for k, factors in found.items() if factors is not None}
            if len(proven) == len(found):
                return proven
        raise AssertionError  # pragma: no cover

    def _point(self, count: int, seed: int) -> RandomPoint:
        return RandomPoint(self.ring, [*self._qs, *self.rates], states=count + 4, seed=seed)

    def _rows_at(self, point: RandomPoint, parameters: Sequence[Standard]) -> list[list[int]]:
        """Return a row for each parameter: K at the states, and P less its value at the first."""
        energies = Energies(self.model, point, [point.convert(x) for x in self.rates])
        rows = []
        for parameter in parameters:
            K, P = energies.of(parameter)
            rows.append([int(x) % point.prime for x in [*K, *(P[1:] - P[0])]])
        return rows

    def _factors(
        self, parameter: Standard, others: Sequence[Standard], point: RandomPoint
    ) -> dict[Standard, Trig] | None:
        """Return the factors with which a parameter's functions follow from others', or None."""
        zero = self.ring.zero
        right, left = self._coefficients(parameter), [self._coefficients(x) for x in others]
        equations = [
            ([x.get(key, zero) for x in left], right.get(key, zero))
            for key in sorted({*right, *itertools.chain(*left)})
        ]
        equations.sort(key=lambda equation: sum(map(len, [*equation[0], equation[1]])))
        square = self._independent(equations, point)
        if len(square) < len(others):
            return None
        divisor = self._determinant([row for row, _ in square])
        scaled = [self._determinant(_with_side(square, j)) for j in range(len(others))]
        for row, side in equations:
            if sum((a * x for a, x in zip(row, scaled, strict=True)), zero) != side * divisor:
                return None
        return {x: self._quotient(y, divisor) for x, y in zip(others, scaled, strict=True)}

    def _coefficients(self, parameter: Standard) -> Coefficients:
        K, P = self._energies.of(parameter)
        moving = [x for x in self.ring.generators if x in self.rates or x.has(*self._qs)]
        in_K, in_P = (self.ring.coefficients(x, moving) for x in (K, P))
        in_P.pop(0, None)  # a constant in P moves nothing
        return {(k, m): x for k, part in enumerate((in_K, in_P)) for m, x in part.items()}

    def _independent(self, equations: Sequence[Any], point: RandomPoint) -> list[Any]:
        """Return the first equations that are independent, as many as there are unknowns."""
        rows = [[int(point.evaluate(x)[0]) for x in row] for row, _ in equations]
        dependent = dependences(rows, point.prime)
        return [x for i, x in enumerate(equations) if i not in dependent]

    def _determinant(self, A: Sequence[Sequence[Trig]]) -> Trig:
        """Return det A by expanding along the first row: there are three unknowns or so."""
        if not A:
            return self.ring.one
        total = self.ring.zero
        for j, x in enumerate(A[0]):
            if x:
                minor = [[*row[:j], *row[j + 1 :]] for row in A[1:]]
                total = total + x * self._determinant(minor) * (-1) ** j
        return total

    def _quotient(self, x: Trig, divisor: Trig) -> Trig:
        expanded = self.ring.expanded
        return self.ring.convert(sp.cancel(expanded(x) / expanded(divisor)))


def _with_side(equations: Sequence[Any], j: int) -> list[list[Trig]]:
    """Return the matrix with the right side in column j."""
    return [[*row[:j], side, *row[j + 1 :]] for row, side in equations]
