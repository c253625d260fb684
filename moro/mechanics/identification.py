"""Identification: what torques tell of the inertial parameters."""

from __future__ import annotations

from collections.abc import Sequence

from moro.identification.base_parameters import BaseParameters, base_parameters
from moro.identification.regressor import SymbolicRegressor, regressor_columns
from moro.identification.standard_parameters import Standard
from moro.mechanics.derivation import Derivation
from moro.scalars.trig import Trig


class Identification(Derivation):
    """Base parameters, and the torques as linear in them."""

    def base_parameters(self, zeros: bool | None = None) -> BaseParameters:
        """Return the minimal inertial parameters: those that the torques can tell apart.

        Each is a combination of the links' inertial parameters XX_1, .., MX_1, .., M_1 (tensor,
        first moments and mass about the origin of Khalil's frame: z along joint i, x along the
        common normal to joint i + 1) with lengths and twists, and has a value in the symbols of
        the model. XXR_2 is XX_2 with others that act alike. Rotor inertias (IA) and friction (FV
        viscous; FC and FD Coulomb, half the sum of both directions and half the difference) are
        parameters too, if they are set. No smaller set gives the same torques; theory and sources
        are in ``moro.identification.base_parameters``.

        Geometry and gravity decide which there are. A parameter whose value is zero is left out
        where zero is an assumption of the model (of a link given in symbols, of friction and
        rotors), and stands where it is a number among numbers, also if a payload is added to them;
        ``zeros`` True or False keeps or leaves out all of them.
        """
        self._needed("gravity")
        return self._all_base_parameters().counted(self._model, zeros)

    def regressor(self, zeros: bool | None = None) -> SymbolicRegressor:
        """Return (Y, p) with M qdd + C qd + G + friction = Y(q, qd, qdd) p identically.

        Y is n x b, p the b values of ``base_parameters(zeros)``, in that order. The columns of Y
        are linearly independent.
        """
        self._warn_if_static("regressor")
        parameters = self.base_parameters(zeros)
        leaders = tuple(x.leader for x in parameters)
        columns = self._matrix(("Y", leaders), lambda: self._regressor_columns(leaders)).T
        Y = columns.reshape(self.dof, len(leaders))
        return SymbolicRegressor(Y, parameters.values, self._notation)

    def _all_base_parameters(self) -> BaseParameters:
        def made() -> BaseParameters:
            rates, _ = self._motion
            return base_parameters(self._model, self._ring, rates, self._show)

        return self._kept("base parameters", made)

    def _regressor_columns(self, leaders: Sequence[Standard]) -> list[list[Trig]]:
        columns = regressor_columns(leaders, self._model, self._ring, *self._motion)
        return [self._at_rest(column) for column in columns]
