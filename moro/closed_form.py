"""The dynamics of an arm by the formulas of the texts, over any scalar.

Two routes, independent of each other:

- Jacobians: M = sum of m Jv^T Jv + Jw^T R I R^T Jw, the Christoffel symbols of M, G = grad P;
- energies: K from the velocities of the links, P from their heights, then Euler-Lagrange.

Each link's terms are taken in the frame where they are shortest, its home segment (``chain``): dot
products do not depend on the frame. Over ``TrigRing`` the results are closed forms; over
``DualRing`` they are numbers. Joints and links are counted from 0 here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from moro.chain import Chain, Mat, Row, Scalar, Vec, cross, dot


@dataclass(frozen=True)
class Arm:
    """An arm as it is given: SymPy values throughout. What is not set is None."""

    rows: tuple[Row, ...]
    convention: str
    masses: tuple[Any, ...] | None = None
    #: r_Ci in frame i
    cm_positions: tuple[tuple[Any, ...], ...] | None = None
    #: I_Ci in the axes of frame i
    inertia_tensors: tuple[tuple[tuple[Any, ...], ...], ...] | None = None
    #: in frame 0
    gravity: tuple[Any, ...] | None = None
    rotor_inertias: tuple[Any, ...] | None = None


class ClosedForm:
    """M, Christoffel symbols, C, G, energies and Euler-Lagrange equations of an arm over a ring."""

    def __init__(self, arm: Arm, ring: Any):
        self.arm = arm
        self.ring = ring
        self.chain = Chain(arm.rows, arm.convention, ring)
        self.n = len(arm.rows)
        self.qs = [row.variable for row in arm.rows]

    # -- the Jacobian route -----------------------------------------------------------------------

    @cached_property
    def inertia_matrix(self) -> list[list[Scalar]]:
        """M = sum over links of m Jv^T Jv + Jw^T R I R^T Jw, rotor inertias on the diagonal."""
        M = [[self.ring.zero] * self.n for _ in range(self.n)]
        for i in range(self.n):
            self._add_link_inertia(M, i)
        for j in range(self.n):
            M[j][j] = M[j][j] + self._rotor_inertia(j)
            for k in range(j):
                M[k][j] = M[j][k]
        return M

    def _add_link_inertia(self, M: list[list[Scalar]], i: int) -> None:
        m, I = self._mass(i), self._inertia(i)
        for j, Jv, Jw in (columns := list(self._columns(i))):
            p = [m * x for x in Jv]
            L = [dot(row, Jw) for row in I]
            for k, Jv_k, Jw_k in columns:
                if k <= j:
                    M[j][k] = M[j][k] + dot(p, Jv_k) + dot(L, Jw_k)

    def _columns(self, i: int) -> Any:
        """Jacobian columns of centre of mass i: linear in the home segment, angular in the link."""
        for k, Jv, Jw in self.chain.jacobian_columns(i, self._cm(i)):
            yield k, Jv, self.chain.in_link(i, Jw)

    @cache  # noqa: B019 - lives as long as the arm's results are wanted
    def dM(self, i: int, j: int, k: int) -> Scalar:
        """dM_ij/dq_k; zero for k <= min(i, j) joints that only carry the arm as a whole."""
        if j > i:
            return self.dM(j, i, k)
        return self.ring.diff(self.inertia_matrix[i][j], self.qs[k])

    def christoffel(self, i: int, j: int, k: int) -> Scalar:
        """c_ijk = 1/2 (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i)."""
        if k > j:
            return self.christoffel(i, k, j)
        return self._christoffel(i, j, k)

    @cache  # noqa: B019
    def _christoffel(self, i: int, j: int, k: int) -> Scalar:
        total = self.dM(i, j, k) + self.dM(i, k, j) - self.dM(j, k, i)
        return total * self.ring.half

    def coriolis_matrix(self, qd: Sequence[Scalar]) -> list[list[Scalar]]:
        """C_ij = sum_k c_ijk qd_k."""
        return [
            [
                self._sum(self.christoffel(i, j, k) * qd[k] for k in range(self.n))
                for j in range(self.n)
            ]
            for i in range(self.n)
        ]

    @cached_property
    def gravity_vector(self) -> list[Scalar]:
        """G = grad P."""
        P = self._sum(self.potential_energies)
        return [self.ring.diff(P, q) for q in self.qs]

    # -- the energy route -------------------------------------------------------------------------

    @cached_property
    def potential_energies(self) -> list[Scalar]:
        """P_i = -m_i g . r_Ci."""
        energies = []
        for i, (height, g) in enumerate(self.chain.along(self._gravity)):
            energies.append(-(self._mass(i) * (height + dot(g, self._cm(i)))))
        return energies

    def kinetic_energies(self, qd: Sequence[Scalar]) -> list[Scalar]:
        """K_i = 1/2 m_i v_Ci . v_Ci + 1/2 w_i . (R I R^T) w_i."""
        energies = []
        for i, (v, w) in enumerate(self.chain.velocities(qd)):
            v = [x + y for x, y in zip(v, cross(w, self._cm(i)), strict=True)]
            w = self.chain.in_link(i, w)
            Iw = [dot(row, w) for row in self._inertia(i)]
            energies.append((self._mass(i) * dot(v, v) + dot(w, Iw)) * self.ring.half)
        return energies

    def rotor_energy(self, qd: Sequence[Scalar]) -> Scalar:
        """Sum of 1/2 I_ri qd_i^2."""
        return (
            self._sum(self._rotor_inertia(i) * qd[i] * qd[i] for i in range(self.n))
            * self.ring.half
        )

    def euler_lagrange(self, qd: Sequence[Any], qdd: Sequence[Any]) -> list[Scalar]:
        """d/dt dL/dqd_i - dL/dq_i with L = K - P; ``qd``, ``qdd`` are generators of the ring."""
        diff, rates = self.ring.diff, [self.ring.convert(v) for v in qd]
        accelerations = [self.ring.convert(a) for a in qdd]
        K = self._sum(self.kinetic_energies(rates)) + self.rotor_energy(rates)
        equations = []
        for i in range(self.n):
            momentum = diff(K, qd[i])
            rate = self._sum(
                diff(momentum, qd[j]) * accelerations[j] + diff(momentum, self.qs[j]) * rates[j]
                for j in range(self.n)
            )
            equations.append(rate - diff(K, self.qs[i]) + self.gravity_vector[i])
        return equations

    # -- what is given, as scalars of the ring ----------------------------------------------------

    def _mass(self, i: int) -> Scalar:
        return self.ring.convert(given(self.arm.masses)[i])

    def _cm(self, i: int) -> Vec:
        return self.chain.point(i, [self.ring.convert(x) for x in given(self.arm.cm_positions)[i]])

    def _inertia(self, i: int) -> Mat:
        tensor = given(self.arm.inertia_tensors)[i]
        return self.chain.tensor(i, [[self.ring.convert(x) for x in row] for row in tensor])

    @cached_property
    def _gravity(self) -> Vec:
        return [self.ring.convert(x) for x in given(self.arm.gravity)]

    def _rotor_inertia(self, i: int) -> Scalar:
        if self.arm.rotor_inertias is None:
            return self.ring.zero
        return self.ring.convert(self.arm.rotor_inertias[i])

    def _sum(self, scalars: Any) -> Scalar:
        return sum(scalars, self.ring.zero)


def given(values: Any) -> Any:
    """Return ``values``; Robot has told the user before if they are not set."""
    if values is None:
        raise ValueError("masses, centres of mass, inertia tensors and gravity must be set first")
    return values
