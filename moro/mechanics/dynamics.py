"""Dynamics: energies, M, C, G, friction, equations of motion."""

from __future__ import annotations

from typing import Any

import sympy as sp

from moro.abc import t
from moro.algorithms.drives import Functions
from moro.checks import values as checks
from moro.identification.base_parameters import drive_coefficients, terms_of_drive
from moro.mechanics.derivation import Derivation
from moro.printing.matrix_form import matrix_form
from moro.printing.notebook import Equations
from moro.scalars.trig import Trig


class Dynamics(Derivation):
    """By Jacobians (M, C, G) and by energies (Euler-Lagrange)."""

    # -- energies ---------------------------------------------------------------------------------

    def link_kinetic_energy(self, i: int) -> Any:
        """K_i = 1/2 m_i v_Ci . v_Ci + 1/2 w_i . (R I R^T) w_i [J]."""
        self._warn_if_static("link_kinetic_energy")
        link = self._link(i)
        self._needed("masses", "cm_positions", "inertia_tensors")
        return self._scalar(("K", i), lambda: self._kinetic_energies()[link])

    def link_potential_energy(self, i: int) -> Any:
        """P_i = -m_i g . r_Ci, zero at the origin of frame 0 [J]."""
        link = self._link(i)
        self._needed("masses", "cm_positions", "gravity")
        return self._scalar(("P", i), lambda: self._form.potential_energies[link])

    def kinetic_energy(self) -> Any:
        """K, the sum of all K_i, and 1/2 I_r qd^2 of the rotors if they are set [J]."""
        self._warn_if_static("kinetic_energy")
        self._needed("masses", "cm_positions", "inertia_tensors")
        return self._scalar("K", self._total_kinetic_energy)

    def potential_energy(self) -> Any:
        """P, the sum of all P_i, and of 1/2 k (q - rest)^2 of springs [J]."""
        self._needed("masses", "cm_positions", "gravity")
        return self._scalar("P", self._total_potential_energy)

    def lagrangian(self) -> Any:
        """L = K - P [J]."""
        self._warn_if_static("lagrangian")
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")
        return self._scalar(
            "L", lambda: self._total_kinetic_energy() - self._total_potential_energy()
        )

    def dissipation(self) -> Any:
        """Rayleigh's function D = sum of 1/2 viscous qd^2 [W]: viscous torques are dD/dqd.

        With it d/dt dL/dqd + dD/dqd - dL/dq = tau, but for Coulomb friction.
        """
        self._warn_if_static("dissipation")

        def total() -> Trig:
            viscous = (self._ring.convert(x.drive.viscous) for x in self._model.coordinates)
            pairs = zip(viscous, self._rates(), strict=True)
            return sum((b * rate * rate for b, rate in pairs), self._ring.zero) * self._ring.half

        return self._scalar("D", total)

    # -- equations of motion ----------------------------------------------------------------------

    def inertia_matrix(self, collect: bool = False) -> Any:
        """M = sum of m Jv^T Jv + Jw^T R I R^T Jw, rotor inertias on the diagonal (n x n).

        By Jacobians, as in Spong, Hutchinson & Vidyasagar, Robot Modeling and Control, section 7.2,
        and Siciliano et al., Robotics, section 7.1. ``collect=True`` names the combinations of
        masses, lengths and inertias in it and returns a ``Collected``.
        """
        self._needed("masses", "cm_positions", "inertia_tensors")
        if collect:
            return self._collector.inertia_matrix()
        return self._matrix("M", lambda: self._form.inertia_matrix)

    def christoffel_symbols(self, i: int, j: int, k: int, M: Any) -> Any:
        """c_ijk = 1/2 (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i), for any n x n matrix M.

        Christoffel symbols of the first kind: Spong et al., section 7.3.
        """
        i, j, k = (self._joint(x) for x in (i, j, k))
        M = checks.matrix(M, "M")
        if M.shape != (self.dof, self.dof):
            raise ValueError(f"M must be {self.dof} x {self.dof}, not {M.shape[0]} x {M.shape[1]}")
        entry, diff, qs = self._ring.convert, self._ring.diff, self.qs
        total = (
            diff(entry(M[i, j]), qs[k]) + diff(entry(M[i, k]), qs[j]) - diff(entry(M[j, k]), qs[i])
        )
        return self._show(total * self._ring.half)

    def coriolis_matrix(self, collect: bool = False) -> Any:
        """C with C_ij = sum_k c_ijk qd_k (n x n): dM/dt - 2 C is skew-symmetric.

        ``collect=True`` writes it in the constants that it has in common with M.
        """
        self._warn_if_static("coriolis_matrix")
        self._needed("masses", "cm_positions", "inertia_tensors")
        if collect:
            return self._collector.coriolis_matrix()
        return self._coriolis_matrix()

    def gravity_vector(self, collect: bool = False) -> Any:
        """G = grad P (n x 1), springs included; ``collect=True`` names its constants."""
        self._needed("masses", "cm_positions", "gravity")
        if collect:
            return self._collector.gravity_vector()
        return self._matrix("G", lambda: [[x] for x in self._form.gravity_vector])

    def friction_vector(self) -> sp.Matrix:
        """Friction torques (n x 1), viscous * qd + Coulomb; zero where neither is set.

        Coulomb friction is (p - n)/2 sign(qd)^2 + (p + n)/2 sign(qd), that is p for qd > 0, -n for
        qd < 0 and 0 at rest; ``moro.model.Drive`` has the smooth kind, and Stribeck's.
        """
        self._warn_if_static("friction_vector")
        return sp.Matrix([self._friction(i) for i in range(self.dof)])

    def dynamic_model(self, collect: bool = False) -> Any:
        """Euler-Lagrange equations d/dt dL/dqd_i - dL/dq_i = tau_i, friction on the left if set.

        ``collect=True`` writes them in the constants of M and G: ``Collected.equations``.
        """
        self._warn_if_static("dynamic_model")
        self._needed("masses", "cm_positions", "inertia_tensors", "gravity")
        if collect:
            friction = [self._friction(i) for i in range(self.dof)]
            return self._collector.equations(friction, self._taus())
        left = self._matrix("EL", lambda: [[x] for x in self._euler_lagrange()])
        friction = [self._friction(i) for i in range(self.dof)]
        rows = zip(left, friction, self._taus(), strict=True)
        return Equations((sp.Eq(x + f, tau, evaluate=False) for x, f, tau in rows), self._notation)

    #: the same, by the name that says what they are
    euler_lagrange_equations = dynamic_model

    def dynamic_model_matrix_form(self) -> Any:
        """M qdd + C qd + G = tau as an ``Eq`` of unevaluated blocks, friction beside G if set."""
        self._warn_if_static("dynamic_model_matrix_form")
        qd, qdd = ([q.diff(t, k) for q in self.qs] for k in (1, 2))
        terms = [(self.inertia_matrix(), qdd), (self._coriolis_matrix(), qd)]
        rest = [self.gravity_vector()]
        if not {"viscous_friction", "coulomb_friction"} <= self._model.not_set:
            rest.append(sp.Matrix([self._friction(i) for i in range(self.dof)]))
        return matrix_form(terms, rest, self._taus())

    # -- elements ---------------------------------------------------------------------------------

    def _coriolis_matrix(self) -> sp.Matrix:
        return self._matrix("C", lambda: self._form.coriolis_matrix(self._rates()))

    def _kinetic_energies(self) -> list[Trig]:
        return self._kept("K_i", lambda: self._form.kinetic_energies(self._rates()))

    def _total_kinetic_energy(self) -> Trig:
        links = sum(self._kinetic_energies(), self._ring.zero)
        rotors: Trig = self._form.rotor_energy(self._rates())
        return links + rotors

    def _total_potential_energy(self) -> Trig:
        springs: Trig = self._form.spring_energy
        return sum(self._form.potential_energies, springs)

    def _euler_lagrange(self) -> list[Trig]:
        return self._at_rest(self._form.euler_lagrange(*self._motion))

    def _friction(self, i: int, rate: Any = None) -> Any:
        """Return the friction of a coordinate, at its own rate by default."""
        q, drive = self.qs[i], self._model.coordinates[i].drive
        rate = q.diff(t) if rate is None else rate
        terms = terms_of_drive(drive, q, rate, Functions(sp.sign, sp.tanh, sp.exp))
        found = drive_coefficients(self._model, i)
        friction = (x * terms[name] for name, x in found.items() if name.startswith("F"))
        return sum(friction, sp.Integer(0))

    def _taus(self) -> list[Any]:
        return [sp.Symbol(f"tau_{i}") for i in range(1, self.dof + 1)]
