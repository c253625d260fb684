"""M qdd + C qd + G = tau as one equation of matrices that prints as the texts write it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp


class InOrder(sp.MatAdd):  # type: ignore[misc]
    """A sum of matrices that prints in the order in which its terms were given.

    SymPy's printers sort the terms of a ``MatAdd``, but for the one that draws in characters.
    """

    def _sympystr(self, printer: Any) -> str:
        return " + ".join(map(printer._print, self.args))

    _latex = _sympystr


def matrix_form(
    terms: Sequence[tuple[sp.MatrixBase, Sequence[Any]]],
    rest: Sequence[sp.MatrixBase],
    right: Sequence[Any],
) -> Any:
    """Return the equation sum of A x + sum of b = right, of ``terms`` (A, x) and ``rest`` b."""
    products = [
        sp.MatMul(A.as_immutable(), sp.ImmutableMatrix(x), evaluate=False) for A, x in terms
    ]
    left = InOrder(*products, *(b.as_immutable() for b in rest), evaluate=False)
    return sp.Eq(left, sp.ImmutableMatrix(right), evaluate=False)
