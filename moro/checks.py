"""What a person may hand to a Robot, and what a wrong input is told.

Every function takes ``what``, the name of the thing in messages ("row 2", "masses"), and returns
exact SymPy values: a float counts as the decimal it prints as.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from difflib import get_close_matches
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from moro.abc import t

_NOT_A_NUMBER = (str, bytes, bool, np.bool_, sp.MatrixBase, sp.NDimArray)


def index(i: Any, low: int, high: int, what: str) -> int:
    """Return ``i`` as an int within low..high; TypeError or IndexError says what is wrong."""
    try:
        if isinstance(i, (bool, np.bool_)):
            raise TypeError
        number = operator.index(i)
    except TypeError:
        raise TypeError(f"{what} index must be a whole number, not {i!r}") from None
    if not low <= number <= high:
        raise IndexError(f"{what} index must be {low}..{high}, not {number}")
    return number


def name(text: Any, what: str) -> str:
    """Return a name, not empty."""
    if not isinstance(text, str):
        raise TypeError(f"{what} must be text, not {brief(text)}")
    if not text.strip():
        raise ValueError(f"{what} must not be empty")
    return text


# -- numbers and expressions ----------------------------------------------------------------------


def scalar(value: Any, what: str) -> Any:
    """Return a real number or an expression as an exact SymPy value."""
    expr = _expression(value, what)
    if expr.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.AccumBounds):
        raise ValueError(f"{what} must be finite, not {value}")
    if isinstance(value, (complex, np.complexfloating)) or expr.has(sp.I) or expr.is_real is False:
        raise ValueError(f"{what} must be real, not {value}")
    return exact(expr)


def _expression(value: Any, what: str) -> Any:
    expected = f"{what} must be a number or a SymPy expression, not"
    if isinstance(value, _NOT_A_NUMBER) or value is None:
        raise TypeError(f"{expected} {brief(value)}")
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value.item()
    if isinstance(value, np.floating) and not isinstance(value, float) and np.isfinite(value):
        value = sp.Rational(str(value))
    try:
        expr = sp.sympify(value)
    except (sp.SympifyError, TypeError, ValueError, AttributeError) as error:
        raise TypeError(f"{expected} {brief(value)}") from error
    if not isinstance(expr, sp.Expr) or not expr.is_commutative:
        raise TypeError(f"{expected} {brief(value)}")
    return expr


def number(value: Any, what: str) -> Any:
    """Return a real number as an exact SymPy value."""
    expr = scalar(value, what)
    if not expr.is_number:
        raise TypeError(f"{what} must be a number, not {expr}")
    return expr


def constant(value: Any, what: str, variables: Iterable[Any]) -> Any:
    """Return a scalar that depends neither on time nor on the joint variables."""
    expr = scalar(value, what)
    if moving(expr, variables):
        raise ValueError(f"{what} must be constant, not {expr}")
    return expr


def not_negative(value: Any, what: str, variables: Iterable[Any]) -> Any:
    """Return a constant that is not known to be negative."""
    expr = constant(value, what, variables)
    if expr.is_negative:
        raise ValueError(f"{what} must not be negative, not {expr}")
    return expr


def moving(expr: Any, variables: Iterable[Any] = ()) -> list[Any]:
    """Return what makes an expression change: time, functions, the joint variables."""
    held = expr.free_symbols | expr.atoms(AppliedUndef)
    return sorted(held & {t, *variables} | expr.atoms(AppliedUndef), key=str)


def exact(expr: Any) -> Any:
    """Return ``expr`` with each float as the decimal it prints as."""
    floats = expr.atoms(sp.Float)
    return expr.xreplace({x: _decimal(x) for x in floats}) if floats else expr


def _decimal(number: Any) -> Any:
    return sp.Rational(repr(float(number)) if number._prec == _DOUBLE else str(number))


_DOUBLE = 53


def angle(value: Any, what: str) -> Any:
    """Return an angle as an exact SymPy value; the float next to k pi/12 is k pi/12."""
    expr = scalar(value, what)
    if isinstance(value, np.ndarray):
        value = value.item()
    nearest = {
        x: sp.pi * k / 12
        for x in sp.sympify(value).atoms(sp.Float)
        if (k := round(float(x) * 12 / _PI))
        and abs(float(x) - k * _PI / 12) <= 4e-16 * abs(float(x))
    }
    return exact(sp.sympify(value).xreplace(nearest)) if nearest else expr


_PI = float(sp.pi)


# -- lists ----------------------------------------------------------------------------------------


def scalars(values: Any, n: int, what: str, of: str = "link") -> list[Any]:
    """Return n values, one for each link (or joint), from a list or from a row or column."""
    return _counted(_row_or_column(values, what), n, what, of)


def pairs(values: Any, n: int, what: str) -> list[Any]:
    """Return n values or pairs of values, one for each joint, unchecked."""
    if getattr(values, "shape", ()) in ((n, 1), (1, n)):
        return scalars(values, n, what, of="joint")
    return groups(values, n, what, of="joint")


def groups(values: Any, n: int, what: str, of: str = "link") -> list[Any]:
    """Return n vectors, tensors or pairs, one for each link (or joint), unchecked.

    They come from a list, or from the rows of a matrix.
    """
    return _counted(values.tolist() if _is_matrix(values) else values, n, what, of)


def _counted(values: Any, n: int, what: str, of: str) -> list[Any]:
    items = sequence(values, what)
    if len(items) != n:
        raise ValueError(f"{what} must have {n} values, one for each {of}, not {len(items)}")
    return items


def sequence(values: Any, what: str) -> list[Any]:
    """Return a list, tuple, SymPy row or column, or NumPy array as a list."""
    if _is_matrix(values):
        values = _row_or_column(values, what)
    if not isinstance(values, (str, bytes, Mapping, Set)):
        try:
            return list(values)
        except TypeError:
            pass
    raise TypeError(f"{what} must be a list of values, not {brief(values)}")


def _row_or_column(values: Any, what: str) -> Any:
    """Return a matrix or array of one row or column as a list, other things as they are."""
    shape: tuple[int, ...] = getattr(values, "shape", ())
    if len(shape) < 2:
        return values
    if len(shape) > 2 or 1 not in shape:
        raise ValueError(f"{what} must be one row or column, not {brief(values)}")
    return [values[i, j] for i in range(shape[0]) for j in range(shape[1])]


def vector(values: Any, what: str, variables: Iterable[Any] = ()) -> tuple[Any, ...]:
    """Return three components as exact SymPy values."""
    items = sequence(_row_or_column(values, what), what)
    if len(items) != 3:
        raise ValueError(f"{what} must have 3 components, not {len(items)}")
    return tuple(constant(x, f"component {i} of {what}", variables) for i, x in enumerate(items, 1))


def tensor(values: Any, what: str, variables: Iterable[Any] = ()) -> tuple[tuple[Any, ...], ...]:
    """Return a symmetric 3 x 3 tensor as exact SymPy values."""
    rows = _three(values.tolist() if hasattr(values, "tolist") else values)
    rows = rows and [_three(row) for row in rows]
    if not rows or not all(rows):
        raise ValueError(f"{what} must be a 3 x 3 matrix, not {brief(values)}")
    I = [
        [constant(x, f"entry {i},{j} of {what}", variables) for j, x in enumerate(row, 1)]
        for i, row in enumerate(rows, 1)
    ]
    for i in range(3):
        for j in range(i):
            if not _equal(I[i][j], I[j][i]):
                raise ValueError(
                    f"{what} must be symmetric: entry {j + 1},{i + 1} is {I[j][i]}, "
                    f"entry {i + 1},{j + 1} is {I[i][j]}"
                )
            I[i][j] = I[j][i]
    return tuple(tuple(row) for row in I)


def matrix(values: Any, what: str) -> Any:
    """Return a matrix of expressions from a matrix, an array or a list of rows."""
    try:
        return sp.Matrix(values if hasattr(values, "shape") else sequence(values, what))
    except (TypeError, ValueError) as error:
        raise TypeError(f"{what} must be a matrix, not {brief(values)}") from error


def limits(pair: Any, what: str) -> tuple[Any, Any]:
    """Return (lower, upper), two numbers in order."""
    items = sequence(pair, what)
    if len(items) != 2:
        raise ValueError(f"{what} must be (lower, upper), not {brief(pair)}")
    lower, upper = (number(x, what) for x in items)
    if lower > upper:
        raise ValueError(f"{what} must be (lower, upper), but {lower} > {upper}")
    return lower, upper


def both_directions(value: Any, what: str, variables: Iterable[Any]) -> tuple[Any, Any]:
    """Return (forward, backward) from such a pair or from one value for both."""
    many = isinstance(value, (Iterable, sp.MatrixBase)) and not isinstance(value, (str, bytes))
    pair = sequence(value, what) if many and getattr(value, "shape", None) != () else [value] * 2
    if len(pair) != 2:
        raise ValueError(f"{what} must be one value or (forward, backward), not {brief(value)}")
    forward, backward = (not_negative(x, what, variables) for x in pair)
    return forward, backward


def _three(values: Any) -> list[Any] | None:
    try:
        items = sequence(values, "")
    except (TypeError, ValueError):
        return None
    return items if len(items) == 3 else None


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
    if isinstance(value, (float, np.floating)):
        return True
    if isinstance(value, np.ndarray) and value.dtype != object:
        return bool(value.dtype.kind == "f")
    if isinstance(value, (sp.MatrixBase, Sequence, np.ndarray)):
        return not isinstance(value, (str, bytes)) and any(map(has_float, value))
    return False


def distinct_names(symbols: Iterable[Any]) -> None:
    """Raise ValueError if two different symbols have one name."""
    for name, count in Counter(map(str, symbols)).items():
        if count > 1:
            raise ValueError(
                f"two different symbols are called {name}: Symbol({name!r}) and one with "
                "assumptions, real=True say; use one of them throughout"
            )


# -- words for messages ---------------------------------------------------------------------------


def brief(value: Any) -> str:
    """Return a value as a message shows it: in one line, not too long, or by its shape."""
    if _is_matrix(value) or (isinstance(value, np.ndarray) and value.ndim):
        return f"{_ARTICLES[_is_matrix(value)]} of shape {' x '.join(map(str, value.shape))}"
    text = " ".join(repr(value).split())
    return text if len(text) <= _LONG else text[: _LONG - 3] + "..."


_ARTICLES = {True: "a matrix", False: "an array"}
_LONG = 80


def suggestion(word: Any, known: Iterable[str]) -> str:
    """Return '; did you mean "..."?' for the nearest known word, or nothing."""
    by_lower = {name.lower(): name for name in known}
    near = get_close_matches(word.lower(), by_lower, n=1) if isinstance(word, str) else ()
    return f'; did you mean "{by_lower[near[0]]}"?' if near else ""


def _is_matrix(value: Any) -> bool:
    return isinstance(value, (sp.MatrixBase, sp.MatrixExpr))
