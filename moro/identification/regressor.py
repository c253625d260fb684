"""The regressor of an arm: the torques are linear in its base parameters, tau = Y(q, qd, qdd) p."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import sympy as sp

from moro.algorithms.drives import Functions
from moro.identification.base_parameters import terms_of_drive
from moro.identification.standard_parameters import BODY, Energies, Standard
from moro.model import Model
from moro.printing.equations import Equation, in_brackets
from moro.printing.notation import Notation
from moro.printing.notebook import WIDTH, Shown
from moro.scalars.trig import Trig, TrigRing


class _Pair(NamedTuple):
    Y: sp.Matrix
    p: sp.Matrix


class SymbolicRegressor(_Pair, Shown):
    """tau = Y p: unpacks as ``Y, p = robot.regressor()``, and shows as formulas.

    ``Y``, n x b, is in q, qd, qdd, lengths and gravity; ``p``, b x 1, holds the values of the base
    parameters, in the order of ``robot.base_parameters()``. ``notation`` writes them.
    """

    _notation: Notation

    def __new__(
        cls, Y: sp.Matrix, p: sp.Matrix, notation: Notation | None = None
    ) -> SymbolicRegressor:
        """Join Y and p."""
        self = super().__new__(cls, Y, p)
        self._notation = notation or Notation()
        return self

    def formulas(self) -> list[Equation]:
        """Return Y and p as matrices if they fit on a line, else the entries that are not zero."""
        write = self._notation.formula
        return [*in_brackets("Y", self.Y, write, WIDTH), *in_brackets("p", self.p, write, WIDTH)]


def regressor_columns(
    parameters: Sequence[Standard],
    model: Model,
    ring: TrigRing,
    rates: Sequence[Any],
    accelerations: Sequence[Any],
) -> list[list[Trig]]:
    """Return a column of Y for each parameter, by Euler and Lagrange from K_k and P_k.

    Column k is d/dt dK_k/dqd_i - dK_k/dq_i + dP_k/dq_i; ``rates`` and ``accelerations`` are symbols
    of qd and qdd. Friction adds qd_i, sign(qd_i) and sign(qd_i)^2.
    """
    columns = _Columns(model, ring, rates, accelerations)
    return [columns.of(x) for x in parameters]


class _Columns:
    def __init__(
        self, model: Model, ring: TrigRing, rates: Sequence[Any], accelerations: Sequence[Any]
    ):
        self.ring = ring
        self._model = model
        self._qs = model.qs
        self._rates = rates
        self._qd = [ring.convert(x) for x in rates]
        self._qdd = [ring.convert(x) for x in accelerations]
        self._energies = Energies(model, ring, self._qd)

    def of(self, parameter: Standard) -> list[Trig]:
        i, name = parameter
        column = [self.ring.zero] * len(self._qs)
        if name in (*BODY, "IA"):
            K, P = self._energies.of(parameter)
            moving = [i] if name == "IA" else self._model.moving(i)
            for j in moving:
                column[j] = self._torque(K, P, j, moving)
        else:
            drive = self._model.coordinates[i].drive
            functions = Functions(sp.sign, sp.tanh, sp.exp)
            terms = terms_of_drive(drive, self._qs[i], self._rates[i], functions)
            column[i] = self.ring.convert(terms[name])
        return column

    def _torque(self, K: Trig, P: Trig, j: int, moving: Sequence[int]) -> Trig:
        """Return the torque at coordinate j; ``moving`` are those that move the link."""
        diff, q = self.ring.diff, self._qs[j]
        momentum = diff(K, self._rates[j])
        torque: Trig = diff(P, q) - diff(K, q)
        for k in moving:
            torque += diff(momentum, self._rates[k]) * self._qdd[k]
            torque += diff(momentum, self._qs[k]) * self._qd[k]
        return torque
