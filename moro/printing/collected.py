"""A matrix written in few names, as ``collect=True`` returns it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import sympy as sp

from moro.printing.equations import Equation
from moro.printing.markup import markup
from moro.printing.notation import Notation
from moro.printing.notebook import Equations, Shown
from moro.printing.plain import plain
from moro.printing.typeset import scripts


@dataclass(frozen=True)
class Collected(Shown):
    """A matrix whose entries are written in named constants.

    The names are the same in all results of one robot: k_1, k_2, ... for M, C and the energies,
    gamma_1, gamma_2, ... for G; longer ones if the model has such symbols itself. Numbers and
    single symbols have no names.

    >>> from moro import Robot
    >>> from moro.abc import *
    >>> robot = Robot((l1, 0, 0, q1), (l2, 0, 0, q2))
    >>> robot.masses, robot.cm_positions = None, [[0, 0, 0]] * 2
    >>> robot.inertia_tensors = [[[0] * 3] * 3] * 2
    >>> M = robot.inertia_matrix(collect=True)
    >>> M.matrix[0, 1]
    k_2*cos(q_2(t)) + k_3
    >>> dict(M.constants)
    {k_1: l_1**2*m_1 + m_2*(l_1**2 + l_2**2), k_2: l_1*l_2*m_2, k_3: l_2**2*m_2}
    """

    #: of the quantity, as texts call it: "M"
    name: str
    #: in names
    matrix: Any
    #: {name: what it stands for}, in the order of their numbers; only those that occur
    constants: Mapping[Any, Any]
    #: right-hand sides, if the rows of the matrix are left-hand sides of equations
    right: tuple[Any, ...] = ()
    _expanded: Callable[[], Any] = field(repr=False, compare=False, kw_only=True)
    _notation: Notation = field(repr=False, compare=False, kw_only=True)

    def expand(self) -> Any:
        """Return the matrix without names, as it is without ``collect``."""
        return self._expanded()

    @property
    def equations(self) -> Equations:
        """Rows of the matrix as equations, where they have right-hand sides."""
        sides = zip(self.matrix, self.right, strict=False)
        return Equations((sp.Eq(*both, evaluate=False) for both in sides), self._notation)

    def entries(self) -> Iterator[tuple[tuple[int, ...], Any]]:
        """Yield (indices from 1, entry), of a symmetric matrix those on and above the diagonal."""
        rows, columns = self.matrix.shape
        symmetric = rows > 1 and self.matrix == self.matrix.T
        for i, j in product(range(rows), range(columns)):
            if j >= i or not symmetric:
                indices = (i + 1, j + 1) if columns > 1 else (i + 1,) if rows > 1 else ()
                yield indices, self.matrix[i, j]

    def __getitem__(self, key: Any) -> Any:
        return self.matrix[key]

    def __str__(self) -> str:
        places = (str(list(indices)) if indices else "" for indices, _ in self.entries())
        lines = [
            f"{self.name}{at} = {plain(x)}"
            for at, (_, x) in zip(places, self.entries(), strict=True)
        ]
        if self.constants:
            lines += ["where", *(f"{name} = {plain(x)}" for name, x in self.constants.items())]
        return "\n".join(lines)

    __repr__ = __str__

    def formulas(self) -> list[Equation]:
        """Return the entries as equations to print, and after them what the names stand for."""
        write = self._notation.formula
        definitions = [Equation(write(name), write(x)) for name, x in self.constants.items()]
        return [*self._entry_formulas(), *definitions]

    def _entry_formulas(self) -> Iterator[Equation]:
        comma = "," if max(self.matrix.shape) > 9 else ""
        name = self._notation.formula(sp.Symbol(self.name))[0]
        for indices, x in self.entries():
            index = markup(comma.join(map(str, indices))) if indices else None
            yield Equation([scripts(name, index)], self._notation.formula(x))
