"""What a person may hand to a Robot, and what a wrong input is told.

Every function takes ``what``, the name of the thing in messages ("row 2", "masses"), and returns
exact SymPy values: a float counts as the decimal it prints as.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

import sympy as sp


def index(i: Any, low: int, high: int, what: str) -> int:
    """Return ``i`` as an int within low..high; TypeError or IndexError says what is wrong."""
    try:
        if isinstance(i, bool):
            raise TypeError
        number = operator.index(i)
    except TypeError:
        raise TypeError(f"{what} index must be a whole number, not {i!r}") from None
    if not low <= number <= high:
        raise IndexError(f"{what} index must be {low}..{high}, not {number}")
    return number


def scalar(value: Any, what: str) -> Any:
    """Return a real number or an expression as an exact SymPy value."""
    if isinstance(value, (str, bytes, bool)) or value is None:
        raise TypeError(f"{what} must be a number or a SymPy expression, not {value!r}")
    try:
        expr = sp.sympify(value)
    except (sp.SympifyError, TypeError, ValueError) as error:
        raise TypeError(f"{what} must be a number or a SymPy expression, not {value!r}") from error
    if not isinstance(expr, sp.Expr):
        raise TypeError(f"{what} must be a number or a SymPy expression, not {value!r}")
    if expr.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ValueError(f"{what} must be finite, not {value}")
    if expr.is_number and expr.is_real is False:
        raise ValueError(f"{what} must be real, not {value}")
    return exact(expr)


def exact(expr: Any) -> Any:
    """Return ``expr`` with each float as the decimal it prints as."""
    floats = expr.atoms(sp.Float)
    return expr.xreplace({x: _decimal(x) for x in floats}) if floats else expr


def _decimal(number: Any) -> Any:
    return sp.Rational(repr(float(number))) if number._prec <= 53 else sp.Rational(str(number))


def angle(value: Any, what: str) -> Any:
    """Return an angle as an exact SymPy value; the float next to k pi/12 is k pi/12."""
    expr = scalar(value, what)
    nearest = {
        x: sp.pi * k / 12
        for x in sp.sympify(value).atoms(sp.Float)
        if (k := round(float(x) * 12 / _PI))
        and abs(float(x) - k * _PI / 12) <= 4e-16 * abs(float(x))
    }
    return exact(sp.sympify(value).xreplace(nearest)) if nearest else expr


_PI = float(sp.pi)


def per_joint(values: Any, n: int, what: str) -> list[Any]:
    """Return ``values`` as a list of n items, one a joint (or link)."""
    items = sequence(values, what)
    if len(items) != n:
        raise ValueError(f"{what} must have {n} values, one for each link, not {len(items)}")
    return items


def sequence(values: Any, what: str) -> list[Any]:
    """Return a list, tuple, SymPy row or column, or NumPy array as a list."""
    if isinstance(values, (str, bytes, dict, set)):
        raise TypeError(f"{what} must be a list of values, not {values!r}")
    if isinstance(values, sp.MatrixBase):
        if 1 not in values.shape and len(values):
            raise ValueError(f"{what} must be one row or column, not a {_shape(values)} matrix")
        return list(values)
    try:
        return list(values)
    except TypeError:
        raise TypeError(f"{what} must be a list of values, not {values!r}") from None


def vector(values: Any, what: str) -> tuple[Any, ...]:
    """Return three components as exact SymPy values."""
    shape = getattr(values, "shape", None)
    if shape is not None and len(shape) == 2 and 1 in shape:
        values = [values[i, j] for i in range(shape[0]) for j in range(shape[1])]
    items = sequence(values, what)
    if len(items) != 3:
        raise ValueError(f"{what} must have 3 components, not {len(items)}")
    return tuple(scalar(x, f"{what}, component {i + 1},") for i, x in enumerate(items))


def tensor(values: Any, what: str) -> tuple[tuple[Any, ...], ...]:
    """Return a symmetric 3 x 3 tensor as exact SymPy values."""
    rows = values.tolist() if hasattr(values, "tolist") else sequence(values, what)
    if not isinstance(rows, list) or len(rows) != 3:
        raise ValueError(f"{what} must be a 3 x 3 matrix, not {values!r}")
    rows = [sequence(row, f"{what}, row {i + 1},") for i, row in enumerate(rows)]
    if any(len(row) != 3 for row in rows):
        raise ValueError(f"{what} must be a 3 x 3 matrix, not {values!r}")
    I = [[scalar(x, f"an entry of {what}") for x in row] for row in rows]
    for i in range(3):
        for j in range(i):
            if not _equal(I[i][j], I[j][i]):
                raise ValueError(
                    f"{what} must be symmetric: entry {j + 1},{i + 1} is {I[j][i]}, "
                    f"entry {i + 1},{j + 1} is {I[i][j]}"
                )
            I[i][j] = I[j][i]
    return tuple(tuple(row) for row in I)


def _equal(x: Any, y: Any) -> bool:
    """Equal as expressions; as numbers, to rounding."""
    difference = sp.expand(x - y)
    if difference == 0:
        return True
    if difference.is_number:
        return bool(abs(difference) <= 1e-12 * max(abs(x), abs(y)))
    return bool(sp.simplify(difference) == 0)


def has_float(value: Any) -> bool:
    """Whether a float stands anywhere in nested lists, arrays and expressions."""
    if isinstance(value, sp.Basic):
        return bool(value.has(sp.Float))
    if isinstance(value, sp.MatrixBase):
        return any(has_float(x) for x in value)
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return any(has_float(x) for x in value)
    if hasattr(value, "dtype"):
        return bool(value.dtype.kind == "f") or any(has_float(x) for x in value.flat)
    return isinstance(value, float)


def _shape(matrix: Any) -> str:
    return " x ".join(map(str, matrix.shape))
