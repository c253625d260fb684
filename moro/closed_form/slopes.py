"""How the torques M qdd + C qd + G change with the state, at a point: what linear models are of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from moro.closed_form.dynamics import ClosedForm
from moro.scalars.trig import Trig


class Slopes:
    """M, C qd + G and the derivatives of M qdd + C qd + G, at a point.

    ``at`` puts in the positions, ``qd`` are the rates there: derivatives with respect to q are
    taken before, at these rates.
    """

    def __init__(self, form: ClosedForm, at: Callable[[Trig], Trig], qd: Sequence[Trig]):
        self._form, self._at, self._qd = form, at, qd
        self._zero: Trig = form.ring.zero
        self._moves = any(qd)

    def inertia_matrix(self) -> list[list[Trig]]:
        """M at the point."""
        return [[self._at(x) for x in row] for row in self._form.inertia_matrix]

    def forces(self) -> list[Trig]:
        """C qd + G at the point."""
        forces = [self._at(x) for x in self._form.gravity_vector]
        for i, row in enumerate(self.coriolis_matrix()):
            forces[i] += self._sum(x * rate for x, rate in zip(row, self._qd, strict=True))
        return forces

    def coriolis_matrix(self) -> list[list[Trig]]:
        """C at the point; d(C qd)/dqd is 2 C, for c_ijk = c_ikj."""
        if not self._moves:
            return [[self._zero] * self._form.n for _ in range(self._form.n)]
        return [[self._at(x) for x in row] for row in self._form.coriolis_matrix(self._qd)]

    def of_forces(self) -> list[list[Trig]]:
        """d(C qd + G)_i/dq_k at the point.

        With the momenta p = M qd and 2 K = p . qd, C qd is sum_j dp_i/dq_j qd_j - dK/dq_i.
        """
        diff, qs, n, rates = self._form.ring.diff, self._form.qs, range(self._form.n), self._qd
        forces = list(self._form.gravity_vector)
        if self._moves:
            M = self._form.inertia_matrix
            p = [self._sum(M[i][j] * rates[j] for j in n) for i in n]
            K = self._sum(p[i] * rates[i] for i in n) * self._form.ring.half
            for i in n:
                forces[i] -= diff(K, qs[i])
                forces[i] += self._sum(diff(p[i], qs[j]) * rates[j] for j in n if rates[j])
        return [[self._at(diff(x, q)) for q in qs] for x in forces]

    def of_inertia(self, qdd: Sequence[Trig]) -> list[list[Trig]]:
        """d(M qdd)_i/dq_k at the point."""
        n, dM = range(self._form.n), self._form.dM
        return [
            [self._sum(self._at(dM(i, j, k)) * qdd[j] for j in n if qdd[j]) for k in n] for i in n
        ]

    def _sum(self, scalars: Any) -> Trig:
        return sum(scalars, self._zero)
