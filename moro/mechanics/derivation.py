"""What quantities are derived with: the model, its closed form, how results are shown and kept."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from copy import copy
from typing import Any, TypeVar

import sympy as sp

from moro.abc import t
from moro.checks import values as checks
from moro.checks.callers import outside
from moro.closed_form import ClosedForm
from moro.formats.source import Source
from moro.identification.base_parameters import inertial_symbols
from moro.model import Model
from moro.printing.collect import Collector
from moro.printing.display import Display
from moro.printing.notation import Notation
from moro.scalars.trig import Trig, TrigRing
from moro.spatial.vectors import Vector

_T = TypeVar("_T")
#: what is forgotten
_DERIVED = ("_made", "_results")


class Derivation:
    """Derives from the model that a source makes. Results are kept until ``_forget``."""

    def __init__(self, source: Source):
        self._source = source
        self._forget()

    def __getstate__(self) -> dict[str, Any]:
        return {k: x for k, x in self.__dict__.items() if k not in _DERIVED}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Hold a source of its own; copies derive anew what they are asked for."""
        self.__dict__.update(state, _source=copy(state["_source"]))
        self._forget()

    def _forget(self, results: bool = True) -> None:
        """Drop the model, and what was derived from it, if something else is given now."""
        self._made: Model | None = None
        if results:
            self._results: dict[Any, Any] = {}

    @property
    def dof(self) -> int:
        """Number of generalized coordinates, n: of joints, where each has its own."""
        return self._source.dof

    @property
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""
        return self._source.qs

    # -- closed forms -----------------------------------------------------------------------------

    @property
    def _model(self) -> Model:
        if self._made is None:
            self._made = self._source.model()
        return self._made

    @property
    def _notation(self) -> Notation:
        return self._source.notation

    @property
    def _form(self) -> ClosedForm:
        return self._kept("closed form", lambda: self._form_over(TrigRing()))

    def _form_over(self, ring: TrigRing) -> ClosedForm:
        form = ClosedForm(self._model, ring)
        # one order of generators, whatever is asked for first: equal results are identical
        for symbol in (*self.qs, *self._velocities(), *self._model.defaults):
            ring.generator(symbol)
        return form

    @property
    def _ring(self) -> TrigRing:
        ring: TrigRing = self._form.ring
        return ring

    @property
    def _show(self) -> Display:
        def made() -> Display:
            inertial, rates = inertial_symbols(self._model), self._velocities()
            return Display(self._ring, inertial, rates, decimal=self._source.decimal)

        return self._kept("display", made)

    @property
    def _collector(self) -> Collector:
        def made() -> Collector:
            return Collector(self._form, self._show, self._notation, self._model.defaults)

        return self._kept("collector", made)

    def _kept(self, key: Any, made: Callable[[], _T]) -> _T:
        if key not in self._results:
            self._results[key] = made()
        kept: _T = self._results[key]
        return kept

    def _matrix(self, key: Any, entries: Callable[[], Sequence[Sequence[Trig]]]) -> sp.Matrix:
        def made() -> sp.ImmutableMatrix:
            return sp.ImmutableMatrix([[self._show(x) for x in row] for row in entries()])

        return sp.Matrix(self._kept(key, made))

    def _scalar(self, key: Any, value: Callable[[], Trig]) -> Any:
        return self._kept(key, lambda: self._show(value()))

    def _in_ring(self, v: Sequence[Any]) -> Vector:
        x, y, z = map(self._ring.convert, v)
        return x, y, z

    # -- rates ------------------------------------------------------------------------------------

    def _velocities(self) -> list[Any]:
        """Joint velocities and accelerations, but of joint variables that are plain symbols."""
        return [q.diff(t, k) for k in (1, 2) for q in self.qs if not q.is_Symbol]

    def _rates(self) -> list[Trig]:
        return [self._ring.convert(q.diff(t)) for q in self.qs]

    @property
    def _motion(self) -> tuple[list[Any], list[Any]]:
        """Symbols of the joint velocities and accelerations, also of joint variables at rest."""

        def order(k: int) -> list[Any]:
            return [q.diff(t, k) or sp.Dummy() for q in self.qs]

        return self._kept("motion", lambda: (order(1), order(2)))

    def _at_rest(self, polynomials: Sequence[Trig]) -> list[Trig]:
        """Put in zero for the velocities of joint variables that are plain symbols."""
        still = [x for order in self._motion for x in order if x.is_Symbol]
        still += [x for x in self._ring.generators if still and x.has(*still)]
        return [self._ring.coefficients(p, still).get(0, self._ring.zero) for p in polynomials]

    # -- what was asked for -----------------------------------------------------------------------

    def _needed(self, *names: str) -> None:
        """Raise ValueError that says how to set one of these quantities that is missing."""
        for name in names:
            if name in self._model.not_set:
                raise ValueError(f"{name} not set: {self._source.how_to_set(name)}")

    def _warn_if_static(self, method: str, variables: Sequence[Any] | None = None) -> None:
        static = [q for q in variables or self.qs if q.is_Symbol]
        if static:
            names = ", ".join(map(str, static))
            warnings.warn(
                f"{method}: velocities are zero, for {names} is no function of time; use q1 of "
                "moro.abc, or sympy.Function('q1')(t), as joint variable",
                UserWarning,
                stacklevel=outside(),
            )

    def _joint(self, i: int) -> int:
        return checks.index(i, 1, self.dof, "joint") - 1

    def _link(self, i: Any) -> int:
        return checks.index(i, 1, len(self._model.bodies), "link") - 1
