"""What a person may hand to a Robot, and what a wrong input is told.

Every function takes ``what``, the name of the thing in messages ("row 2", "masses"), and returns
exact SymPy values: a float counts as the decimal it prints as.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from moro.abc import t
from moro.checks import constants
from moro.checks.meant import meant
from moro.checks.tensors import ENTRIES, FORMS, Rows, entry_name, listed, rows_of

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
    if isinstance(value, sp.Rational) and constants.is_sane(value):
        return value  # as most of a robot's thousands are
    expr = _expression(value, what)
    if _is_infinite(expr):
        raise ValueError(f"{what} must be finite, not {_cut(str(value))}")
    if isinstance(value, (complex, np.complexfloating)) or expr.has(sp.I) or expr.is_real is False:
        raise ValueError(f"{what} must be real, not {_cut(str(value))}")
    expr = constants.settled(exact(expr))
    if _is_infinite(expr):
        raise ValueError(f"{what} must be finite, not {_cut(str(value))}")
    if expr.is_number and not constants.numeric(expr).is_Number:
        raise ValueError(
            f"{what} must be a real number that can be evaluated, not {_cut(str(value))}"
        )
    if not constants.is_sane(expr):
        raise ValueError(f"{what} must be 0 or within {constants.RANGE} in size, {_found(expr)}")
    return expr


def _is_infinite(expr: Any) -> bool:
    return bool(expr.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.AccumBounds))


def _found(expr: Any) -> str:
    """Say how large a number is that is too long to be written out."""
    if not expr.is_number:
        return f"not {_cut(str(expr))}"
    size = constants.numeric(abs(expr))
    return f"not about 1e{int(sp.floor(sp.log(size, 10).evalf()))}"


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


def constant(value: Any, what: str, variables: Iterable[Any] = ()) -> Any:
    """Return a scalar that depends neither on time nor on the joint variables."""
    expr = scalar(value, what)
    if not expr.is_Rational and moving(expr, variables):
        raise ValueError(f"{what} must be constant, not {expr}")
    return expr


def not_negative(value: Any, what: str, variables: Iterable[Any] = ()) -> Any:
    """Return a constant that is not known to be negative."""
    expr = constant(value, what, variables)
    if constants.is_negative(expr):
        raise ValueError(f"{what} must not be negative, not {shown(expr)}")
    return expr


def not_zero(value: Any, what: str) -> Any:
    """Return a constant that is not 0."""
    expr = constant(value, what)
    if expr == 0:
        raise ValueError(f"{what} must not be 0")
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
    items = _counted(values.tolist() if _is_matrix(values) else values, n, what, of)
    return [list(x) if isinstance(x, Iterator) else x for x in items]


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


def components(values: Any, what: str) -> list[Any]:
    """Return three components, unchecked, from a list or from a row or column."""
    items = sequence(_row_or_column(values, what), what)
    if len(items) != 3:
        raise ValueError(f"{what} must have 3 components, not {len(items)}")
    return items


def vector(values: Any, what: str, variables: Iterable[Any] = ()) -> tuple[Any, ...]:
    """Return three components as exact SymPy values."""
    items = components(values, what)
    return tuple(constant(x, f"component {i} of {what}", variables) for i, x in enumerate(items, 1))


def direction(values: Any, what: str) -> tuple[Any, ...]:
    """Return three numbers, of any length but 0."""
    items = tuple(number(x, what) for x in components(values, what))
    if not any(items):
        raise ValueError(f"{what} must be a direction, not the zero vector")
    return items


#: by which a matrix may miss being a rotation: decimals are rounded
_ROUNDED = sp.Rational(1, 10**4)


def rotation(values: Any, what: str) -> Rows:
    """Return a rotation matrix, to rounding where it is given in numbers."""
    rows = tuple(vector(row, what) for row in components(values, what))
    R = sp.Matrix(rows)
    missed = (R * R.T - sp.eye(3)).applyfunc(sp.simplify)
    if any(not x.is_number or abs(x.evalf()) > _ROUNDED for x in missed):
        raise ValueError(f"{what} must be a rotation matrix: its rows are not orthogonal units")
    turned = sp.simplify(R.det())
    if not turned.is_number or turned.evalf() < 0:
        raise ValueError(f"{what} must be a rotation matrix, and this one reflects")
    return rows


def tensor(values: Any, what: str, variables: Iterable[Any] = ()) -> Rows:
    """Return a symmetric 3 x 3 tensor, in any form of ``moro.checks.tensors``, as exact values."""
    if isinstance(values, Mapping):
        return _named_tensor(values, what, variables)
    items = values.tolist() if hasattr(values, "tolist") else values
    if entries := _flat_entries(items):
        names = ENTRIES[: len(entries)]
        return listed(
            [
                constant(x, f"I{name} of {what}", variables)
                for name, x in zip(names, entries, strict=True)
            ]
        )
    rows = _three(items)
    rows = rows and [_three(row) for row in rows]
    if not rows or not all(rows):
        raise ValueError(f"{what} must be a 3 x 3 matrix, or {FORMS}, not {brief(values)}")
    I = [
        [constant(x, f"entry {i},{j} of {what}", variables) for j, x in enumerate(row, 1)]
        for i, row in enumerate(rows, 1)
    ]
    if found := asymmetry(I):
        raise ValueError(f"{what} must be symmetric: {found}")
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = I
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def _named_tensor(values: Mapping[Any, Any], what: str, variables: Iterable[Any]) -> Rows:
    """Return the tensor of {"xx": .., "yy": .., ..}."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        name = entry_name(str(key))
        if name not in ENTRIES:
            known = ", ".join(ENTRIES)
            raise ValueError(f"{what} has an entry {key}; its entries are {known}")
        if name in found:
            raise ValueError(f"{what} gives {name} twice")
        found[name] = constant(value, f"I{name} of {what}", variables)
    if missing := [name for name in ENTRIES[:3] if name not in found]:
        raise ValueError(f"{what} has no {' and no '.join(missing)}")
    return rows_of({name: found.get(name, sp.Integer(0)) for name in ENTRIES})


def _flat_entries(values: Any) -> list[Any] | None:
    """Return three or six scalars; None for anything else, rows say."""
    try:
        items = sequence(values, "")
    except (TypeError, ValueError):
        return None
    if len(items) not in (3, 6) or any(isinstance(x, _MANY) for x in items):
        return None
    return items


_MANY = (Sequence, np.ndarray, sp.MatrixBase, sp.NDimArray, sp.Tuple, Mapping, Set)


def asymmetry(rows: Sequence[Sequence[Any]]) -> str | None:
    """Say where a 3 x 3 matrix is not symmetric, to rounding."""
    for i, j in ((0, 1), (0, 2), (1, 2)):
        upper, lower = rows[i][j], rows[j][i]
        if not _equal(upper, lower):
            return (
                f"entry {i + 1},{j + 1} is {shown(upper)}, entry {j + 1},{i + 1} is {shown(lower)}"
            )
    return None


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
        found = f"{shown(lower)} > {shown(upper)}"
        raise ValueError(f"{what} must be (lower, upper), but {found}")
    return lower, upper


def directions(value: Any, what: str) -> list[Any]:
    """Return [forward, backward], unchecked, from such a pair or from one value for both."""
    many = isinstance(value, (Iterable, sp.MatrixBase)) and not isinstance(value, (str, bytes))
    pair = sequence(value, what) if many and getattr(value, "shape", None) != () else [value] * 2
    if len(pair) != 2:
        raise ValueError(f"{what} must be one value or (forward, backward), not {brief(value)}")
    return pair


def both_directions(value: Any, what: str, variables: Iterable[Any]) -> tuple[Any, Any]:
    """Return (forward, backward) from such a pair or from one value for both."""
    pair = directions(value, what)
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
    if x.is_number and y.is_number:
        apart, size = (abs(constants.numeric(v)) for v in (x - y, x))
        return bool(apart <= sp.Rational("1e-12") * size) or constants.is_zero(x - y)
    difference = sp.expand(x - y)
    return bool(difference == 0 or (not difference.is_number and sp.simplify(difference) == 0))


def has_float(value: Any) -> bool:
    """Whether a float stands anywhere in nested lists, arrays and expressions."""
    if isinstance(value, sp.Basic):
        return bool(value.has(sp.Float))
    if isinstance(value, (float, np.floating)):
        return True
    if isinstance(value, np.ndarray) and value.dtype != object:
        return bool(value.dtype.kind == "f")
    if isinstance(value, Mapping):
        return has_float(tuple(value.values()))
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


def shown(value: Any) -> str:
    """Return a number as a message shows it: a decimal if it came as one."""
    return repr(float(value)).removesuffix(".0") if value.is_Rational else str(value)


def brief(value: Any) -> str:
    """Return a value as a message shows it: in one line, not too long, or by its shape."""
    if _is_matrix(value) or (isinstance(value, np.ndarray) and value.ndim):
        return f"{_ARTICLES[_is_matrix(value)]} of shape {' x '.join(map(str, value.shape))}"
    return _cut(" ".join(repr(value).split()))


def _cut(text: str) -> str:
    return text if len(text) <= _LONG else text[: _LONG - 3] + "..."


_ARTICLES = {True: "a matrix", False: "an array"}
_LONG = 80


def suggestion(word: Any, known: Iterable[str]) -> str:
    """Return '; did you mean "..."?' for the known word that is meant, or nothing."""
    name = meant(word, known) if isinstance(word, str) else None
    return f'; did you mean "{name}"?' if name else ""


def _is_matrix(value: Any) -> bool:
    return isinstance(value, (sp.MatrixBase, sp.MatrixExpr))
