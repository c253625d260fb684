"""The dynamics of a model by the formulas of the texts, over any scalar.

Two routes, independent of each other:

- Jacobians: M = sum of m Jv^T Jv + Jw^T R I R^T Jw, the Christoffel symbols of M, G = grad P;
- energies: K from the velocities of the links, P from their heights, then Euler-Lagrange.

Each link's terms are taken in the axes where they are shortest, its home segment's (``geometry``):
dot products do not depend on the axes. Over ``TrigRing`` the results are closed forms; over
``DualRing`` they are numbers. Joints and links are counted from 0 here.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property
from typing import Any

from moro.closed_form.geometry import Geometry
from moro.model import Model
from moro.scalars.ring import DifferentialRing
from moro.spatial.vectors import Matrix, Scalar, Vector, add, cross, dot, scaled, times


class ClosedForm:
    """M, Christoffel symbols, C, G, energies, Euler-Lagrange equations of a model over a ring."""

    def __init__(self, model: Model, ring: DifferentialRing):
        self.model = model
        self.ring: Any = ring  # which of them, is known where results are used
        self.geometry = Geometry(model, ring)
        ring.declare_angles(*self.geometry.angles)
        self.n = model.nv
        self.qs = model.qs

    # -- the Jacobian route -----------------------------------------------------------------------

    @cached_property
    def inertia_matrix(self) -> list[list[Scalar]]:
        """M = sum of Jv^T (m Jv + Jw x h) + Jw^T (J Jw + h x Jv), rotors on its diagonal.

        Jv is of the origin of the link's frame, about which h is the first moment and J the tensor.
        """
        M = [[self.ring.zero] * self.n for _ in range(self.n)]
        for i in range(len(self.model.bodies)):
            self._add_link_inertia(M, i)
        for j in range(self.n):
            M[j][j] = M[j][j] + self._rotor_inertia(j)
            for k in range(j):
                M[k][j] = M[j][k]
        return M

    def _add_link_inertia(self, M: list[list[Scalar]], i: int) -> None:
        m, h, J = self._mass(i), self._first_moment(i), self._inertia(i)
        columns = [(k, v, w, self.geometry.in_link(i, w)) for k, v, w in self.geometry.columns(i)]
        for j, v, w, w_link in columns:
            p, L, L_link = add(scaled(m, v), cross(w, h)), cross(h, v), times(J, w_link)
            for k, v_k, w_k, w_link_k in columns:
                if k <= j:
                    M[j][k] = M[j][k] + dot(p, v_k) + dot(L, w_k) + dot(L_link, w_link_k)

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
        """G = grad P, springs included."""
        P = self._sum(self.potential_energies) + self.spring_energy
        return [self.ring.diff(P, q) for q in self.qs]

    @cached_property
    def spring_energy(self) -> Scalar:
        """Sum of 1/2 k_j (q_j - rest_j)^2."""
        energy = self.ring.zero
        for q, x in zip(self.qs, self.model.coordinates, strict=True):
            if x.drive.stiffness != 0:
                stretched = self.ring.convert(q - x.drive.rest)
                stiffness = self.ring.convert(x.drive.stiffness)
                energy = energy + stiffness * stretched * stretched * self.ring.half
        return energy

    # -- the energy route -------------------------------------------------------------------------

    @cached_property
    def potential_energies(self) -> list[Scalar]:
        """P_i = -g . (m_i r_i + h_i), which is -m_i g . r_Ci."""
        heights = self.geometry.along(self._gravity)
        return [
            -(self._mass(i) * height + dot(g, self._first_moment(i)))
            for i, (height, g) in enumerate(heights)
        ]

    def kinetic_energies(self, qd: Sequence[Scalar]) -> list[Scalar]:
        """K_i = 1/2 m_i v_i . v_i + h_i . (v_i x w_i) + 1/2 w_i . J_i w_i."""
        energies = []
        for i, (v, w) in enumerate(self.geometry.velocities(qd)):
            mixed = dot(self._first_moment(i), cross(v, w))
            w = self.geometry.in_link(i, w)
            squares = self._mass(i) * dot(v, v) + dot(w, times(self._inertia(i), w))
            energies.append(squares * self.ring.half + mixed)
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
        return self.ring.convert(self.model.bodies[i].mass)

    def _first_moment(self, i: int) -> Vector:
        """Return the first moment of link i, in the axes of its home segment."""
        return self.geometry.in_home(i, self._vector(self.model.bodies[i].first_moment))

    def _inertia(self, i: int) -> Matrix:
        x, y, z = map(self._vector, self.model.bodies[i].inertia)
        return x, y, z

    @cached_property
    def _gravity(self) -> Vector:
        return self._vector(self.model.gravity)

    def _rotor_inertia(self, i: int) -> Scalar:
        return self.ring.convert(self.model.coordinates[i].drive.rotor_inertia)

    def _vector(self, v: Vector) -> Vector:
        x, y, z = map(self.ring.convert, v)
        return x, y, z

    def _sum(self, scalars: Any) -> Scalar:
        return sum(scalars, self.ring.zero)
