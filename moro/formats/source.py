"""Where a robot's model comes from: what is given of it, by DH rows or as a ``Model``."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeVar

import sympy as sp

from moro.abc import t
from moro.checks import values as checks
from moro.model import JointType, Model
from moro.printing.notation import Notation
from moro.printing.plain import in_decimals, natural, prefers_decimals
from moro.printing.tables import Table

_Self = TypeVar("_Self", bound="Source")

#: what can be given of a robot beside its joints, and how it is set
QUANTITIES = {
    "masses": "robot.masses = [m1, ...], or None for symbols m_1, m_2, ...",
    "cm_positions": "robot.cm_positions = [[x, y, z], ...], in frame i",
    "inertia_tensors": "robot.inertia_tensors = [3 x 3 matrix, ...], or None for diagonal symbols",
    "gravity": "robot.gravity = [x, y, z], in frame 0",
    "rotor_inertias": "none; robot.rotor_inertias = [value, ...]",
    "viscous_friction": "none; robot.viscous_friction = [value, ...]",
    "coulomb_friction": "none; robot.coulomb_friction = [value or (forward, backward), ...]",
    "joint_limits": "robot.joint_limits = [(lower, upper), ...]",
}


class Source(ABC):
    """What is given of a robot, of which it makes a model.

    Values are never changed in place: a shallow copy is a copy.
    """

    def __init__(self, name: Any) -> None:
        self.name = name
        self._defaults: dict[Any, Any] = {}
        self._declared: frozenset[Any] = frozenset()

    @property
    def name(self) -> str:
        """Name of the robot, a text."""
        return self._name

    @name.setter
    def name(self, text: Any) -> None:
        self._name = checks.name(text, "name")

    @property
    @abstractmethod
    def convention(self) -> str:
        """Convention of the rows: "dh" (standard) or "mdh" (modified); "" where there are none."""

    @property
    @abstractmethod
    def types(self) -> Sequence[JointType]:
        """The type of each joint."""

    @property
    @abstractmethod
    def qs(self) -> list[Any]:
        """Joint variables q_1..q_n [rad or m]."""

    @property
    @abstractmethod
    def decimal(self) -> bool:
        """Whether a float was given: results are printed in decimals then."""

    @property
    @abstractmethod
    def assumed(self) -> frozenset[str]:
        """Those of ``QUANTITIES`` that stand for what was not given."""

    @property
    @abstractmethod
    def table(self) -> Table:
        """The joints."""

    @abstractmethod
    def model(self) -> Model:
        """Return the robot as all algorithms read it (``moro.model``)."""

    @abstractmethod
    def given(self, name: str) -> Any:
        """Return one of ``QUANTITIES`` as it was given; None if it is not set."""

    @abstractmethod
    def how_to_set(self, name: str) -> str:
        """Say how one of ``QUANTITIES`` is set."""

    @abstractmethod
    def _constants(self) -> Iterable[Any]:
        """Return all values that the model is made of."""

    @abstractmethod
    def _headline(self) -> tuple[str, str, str]:
        """Return the first row of the summary: what the joints are given by."""

    @abstractmethod
    def _substituted(self: _Self, values: Mapping[Any, Any]) -> _Self:
        """Return the same with values put in for symbols."""

    @property
    def dof(self) -> int:
        """Number of joints, n."""
        return len(self.types)

    @property
    def notation(self) -> Notation:
        """How formulas of the robot are written."""
        return Notation(self.qs, self.parameters, decimals=prefers_decimals(self._constants()))

    @property
    def parameters(self) -> dict[Any, Any]:
        """The symbols left free in the model, with their default values (None: no default).

        Kernels take those that they need at run time, in this order. Set a dictionary of symbols,
        or their names, to give defaults; ValueError for one that the model does not hold. What a
        ``moro_codegen.Function`` has besides, it brings itself.
        """
        free = set().union(*(x.free_symbols for x in self._constants())) - {t, *self.qs}
        free |= self._declared
        checks.distinct_names(free)
        ordered = [s for s in self._defaults if s in free]
        ordered += sorted(free - set(ordered), key=lambda s: natural(s.name))
        return {s: self._defaults.get(s) for s in ordered}

    @parameters.setter
    def parameters(self, defaults: Mapping[Any, Any]) -> None:
        for key, _ in _items(defaults, "parameters"):
            _symbol(key)  # is one, or a name
        self._defaults = {
            symbol: _default(symbol, value)
            for symbol, value in self.by_symbol(defaults, "parameters").items()
        }

    def declare(self, defaults: Mapping[Any, Any]) -> None:
        """Add parameters, with their defaults, that the model need not hold.

        Functions of one's own may use them; kernels that do not, do not ask for them. Those that a
        robot.yaml declares are among them.
        """
        new = {_symbol(key): _default(key, x) for key, x in _items(defaults, "parameters")}
        self._defaults = {**self._defaults, **new}
        self._declared |= set(new)

    def with_parameters(self: _Self, values: Mapping[Any, Any]) -> _Self:
        """Return the same with values put in for symbols, or for what has their names.

        Raises ValueError for a symbol that the model does not hold.
        """
        new = self.by_symbol(values, "values")
        for symbol, value in new.items():
            checks.constant(value, f"value of {symbol}", self.qs)
        source = self._substituted({symbol: sp.sympify(value) for symbol, value in new.items()})
        source._defaults = {s: x for s, x in self._defaults.items() if s not in new}
        source._declared = self._declared - set(new)
        return source

    def summary(self) -> Table:
        """Return what is given, what was assumed by default, and what is not set."""
        rows = [self._headline()]
        for name in QUANTITIES:
            value, state = self.given(name), "assumed" if name in self.assumed else "given"
            if value is None:
                rows.append((name, "not set", self.how_to_set(name)))
            else:
                rows.append((name, state, self._brief(value)))
        return Table(("quantity", "state", "value"), rows)

    def _brief(self, value: Any) -> str:
        text = str([self._shown(x) for x in value])
        return text if len(text) <= 60 else text[:57] + "..."

    def _shown(self, x: Any) -> Any:
        if isinstance(x, sp.MatrixBase):
            x = list(x) if x.cols == 1 else x.tolist()
        if isinstance(x, (list, tuple)):
            return type(x)(map(self._shown, x))
        return in_decimals(x) if self.decimal else x

    def by_symbol(self, values: Any, what: str) -> dict[Any, Any]:
        """Return {symbol: value} for symbols of the model, or their names.

        Raises ValueError, with the nearest symbol, for one that it does not hold.
        """
        known = {str(s): s for s in self.parameters}
        found: dict[Any, Any] = {}
        for key, value in _items(values, what):
            symbol = known.get(str(key))
            if symbol is None:
                names = ", ".join(known) or "none"
                near = checks.suggestion(str(key), known)
                raise ValueError(
                    f"{key} is not a symbol of the model; its symbols are {names}{near}"
                )
            if symbol in found:
                raise ValueError(f"{key} is given two values")
            found[symbol] = value
        return found


def _items(values: Any, what: str) -> Iterable[tuple[Any, Any]]:
    if not isinstance(values, Mapping):
        raise TypeError(
            f"{what} must be a dictionary {{symbol: value}}, not {checks.brief(values)}"
        )
    return values.items()


def _symbol(key: Any) -> Any:
    if not isinstance(key, (str, sp.Symbol)):
        raise TypeError(f"a parameter must be a symbol or its name, not {checks.brief(key)}")
    return sp.Symbol(key) if isinstance(key, str) else key


def _default(symbol: Any, value: Any) -> Any:
    return None if value is None else checks.number(value, f"default of {symbol}")
