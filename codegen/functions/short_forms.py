"""Closed forms of a model that are short enough to compete with the recursions.

What the formulas of the texts give (``moro.closed_form``), constants folded to a number for each
product of sines, cosines and velocities, as nodes of a graph. How far they are followed is bounded
by counts, not by a clock, so that the same is generated on any machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from operator import attrgetter
from typing import Any

import sympy as sp

from moro.closed_form import ClosedForm, Geometry
from moro.model import Drive, Model
from moro.printing.display import Display
from moro.scalars.trig import Trig, TrigRing
from moro_codegen.graph.from_sympy import Converter
from moro_codegen.graph.from_trig import polynomial
from moro_codegen.graph.nodes import Graph, Node
from moro_codegen.passes.share import Polynomial, nodes_of

#: products of two terms that M, and what follows from it, may each take: in all 0.1 s
MOST_PRODUCTS = 5_000
#: pairs of terms of a closed form: looking for what they share takes half a second
MOST_PAIRS = 12_000
#: torques of arms with more joints are far longer than the recursion
MOST_JOINTS = 4


class ShortForms:
    """The closed forms of a model in SymPy: of its rigid bodies, and in M and K of the rotors.

    Its methods raise TimeoutError for what is too long.
    """

    def __init__(self, model: Model, rigid: bool = False):
        self.model = replace(
            model,
            coordinates=tuple(replace(x, drive=_rotor(x.drive, rigid)) for x in model.coordinates),
        )
        self._rates = [[sp.Dummy(f"{d}_{i}") for i in range(model.nv)] for d in ("qd", "qdd")]
        self._found: dict[str, Any] = {}

    def of(self, model: Model) -> ShortForms:
        """Return those of the same arm with other frames, sharing what has been made."""
        other = copy(self)
        other.model = replace(model, coordinates=self.model.coordinates)
        return other

    def nodes(
        self,
        formula: str,
        graph: Graph,
        parameters: Mapping[Any, Node],
        motion: Sequence[Sequence[Node]],
        most: int,
    ) -> Iterator[list[Node]]:
        """Yield the closed form that a method gives as nodes, in ways to write it.

        None if it is too long, or has more than ``most`` pairs of terms. ``motion`` are q, qd and
        qdd, or what it depends on of these.
        """
        try:
            entries: Sequence[Trig] = getattr(self, formula)()
        except TimeoutError:
            return
        known = dict(parameters)
        for symbols, given in zip((self.model.qs, *self._rates), motion, strict=False):
            known.update(zip(symbols, given, strict=True))
        convert = Converter(graph, known)
        written: list[list[Polynomial]] = []
        for terms in (attrgetter("terms"), Display(self._ring).shortened):
            found: list[Polynomial] = [polynomial(terms(p), self._ring, convert) for p in entries]
            if found not in written:
                written.append(found)
        for polynomials in written:
            nodes = nodes_of(polynomials, graph, min(most, MOST_PAIRS))
            if nodes is not None:
                yield nodes

    # -- formulas ---------------------------------------------------------------------------------

    def potential_energy(self) -> list[Trig]:
        """P, without springs."""
        return [self._potential]

    def gravity_vector(self) -> list[Trig]:
        """G = grad P, without springs."""
        return [self._ring.diff(self._potential, q) for q in self.model.qs]

    def inertia_matrix(self) -> list[Trig]:
        """M, row by row, rotors on its diagonal unless ``rigid``."""
        return [x for row in self._inertia for x in row]

    def coriolis_matrix(self) -> list[Trig]:
        """C of the Christoffel symbols, row by row."""
        return [x for row in self._coriolis for x in row]

    def kinetic_energy(self) -> list[Trig]:
        """K = 1/2 qd^T M qd, with that of the rotors."""
        qd, n = self._qd, range(self.model.nv)
        M = self._inertia
        return [self._sum(M[i][j] * qd[i] * qd[j] for i in n for j in n) * self._ring.half]

    def bias(self) -> list[Trig]:
        """C qd + G."""
        if self.model.nv > MOST_JOINTS:
            raise TimeoutError
        rows = zip(self._coriolis, self.gravity_vector(), strict=True)
        return [self._sum(map(_product, row, self._qd)) + g for row, g in rows]

    def tau(self) -> list[Trig]:
        """M qdd + C qd + G of the rigid bodies, without rotors."""
        bias, qdd = self.bias(), [self._ring.convert(x) for x in self._rates[1]]
        rotors = [self._ring.convert(x.drive.rotor_inertia) for x in self.model.coordinates]
        rows = zip(self._inertia, bias, rotors, qdd, strict=True)
        return [self._sum(map(_product, row, qdd)) - I * a + b for row, b, I, a in rows]

    def pose(self) -> list[Trig]:
        """T of the last frame, row by row."""
        geometry = self._geometry
        self._ring.allow(MOST_PRODUCTS)
        R, p = geometry.pose(self.model.tip)
        zero, one = self._ring.zero, self._ring.one
        return [*(x for row, y in zip(R, p, strict=True) for x in (*row, y)), *(zero,) * 3, one]

    def jacobian(self) -> list[Trig]:
        """J of the last frame, row by row."""
        geometry, zero = self._geometry, self._ring.zero
        self._ring.allow(MOST_PRODUCTS)
        columns = geometry.jacobian(self.model.tip, (zero, zero, zero))
        return [x for row in zip(*columns, strict=True) for x in row]

    # -- elements, each with a bound of its own ---------------------------------------------------

    @property
    def _form(self) -> ClosedForm:
        if "form" not in self._found:
            self._found["form"] = ClosedForm(self.model, TrigRing())
        form: ClosedForm = self._found["form"]
        return form

    @property
    def _ring(self) -> TrigRing:
        ring: TrigRing = self._form.ring
        return ring

    @property
    def _potential(self) -> Trig:
        found: Trig = self._bounded("P", lambda: self._sum(self._form.potential_energies))
        return found

    @property
    def _inertia(self) -> list[list[Trig]]:
        found: list[list[Trig]] = self._bounded("M", lambda: self._form.inertia_matrix)
        return found

    @property
    def _coriolis(self) -> list[list[Trig]]:
        assert self._inertia  # noqa: S101 - which has its own bound
        found: list[list[Trig]] = self._bounded("C", lambda: self._form.coriolis_matrix(self._qd))
        return found

    @property
    def _geometry(self) -> Geometry:
        geometry = self._form.geometry
        self._bounded("axes", lambda: (geometry.axes, geometry.anchors))
        return geometry

    @property
    def _qd(self) -> list[Trig]:
        return [self._ring.convert(x) for x in self._rates[0]]

    def _bounded(self, name: str, element: Callable[[], Any]) -> Any:
        """Return an element, made at most once, whether or not it is too long."""
        if name not in self._found:
            self._ring.allow(MOST_PRODUCTS)
            try:
                self._found[name] = element()
            except TimeoutError as error:
                self._found[name] = error
        if isinstance(self._found[name], TimeoutError):
            raise TimeoutError
        return self._found[name]

    def _sum(self, scalars: Any) -> Trig:
        total: Trig = sum(scalars, self._ring.zero)
        return total


def _product(a: Trig, b: Trig) -> Trig:
    return a * b


def _rotor(drive: Drive, rigid: bool) -> Drive:
    """Return what of a drive is in M."""
    return Drive() if rigid else Drive(rotor_inertia=drive.rotor_inertia)
