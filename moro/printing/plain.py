"""Expressions as plain text that a person reads: k_2 before k_10, one style of numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

#: fractions with larger denominators are printed as decimals
MAX_DENOMINATOR = 12


def plain(expr: Any) -> str:
    """Return an expression as text, its symbols in the order of their numbers."""
    symbols = sp.sympify(expr).free_symbols
    digits = [len(x) for s in symbols for x in re.findall(r"\d+", s.name)]
    if max(digits, default=0) < 2:
        return str(sp.sstr(expr, full_prec=False))
    padded = {s: sp.Symbol(_padded(s.name, max(digits))) for s in symbols}
    printer = _Printer({p: s.name for s, p in padded.items()})
    return str(printer.doprint(sp.sympify(expr).xreplace(padded)))


def natural(name: str) -> tuple[Any, ...]:
    """Return a sort key of a name: its numbers count as numbers."""
    pieces = re.split(r"(\d+)", name)
    return tuple((0, int(x), "") if x.isdigit() else (1, 0, x) for x in pieces if x)


def prefers_decimals(expressions: Iterable[Any]) -> bool:
    """Whether numbers are decimals in origin: one is a fifth, a tenth, or finer than a twelfth."""
    fractions = {x for expr in expressions for x in _apart(expr)[0].atoms(sp.Rational)}
    return any(x.q in (5, 10) or x.q > MAX_DENOMINATOR for x in fractions)


def ends(x: Any) -> bool:
    """Whether a fraction is a decimal that ends."""
    return all(p in (2, 5) for p in sp.primefactors(x.q))


def in_decimals(expr: Any, digits: int = 6) -> Any:
    """Return an expression with floats for the fractions that end or are finer than a twelfth."""
    expr, angles = _apart(expr)
    fractions = {x for x in expr.atoms(sp.Rational) if not x.is_Integer}
    fine = {x: sp.Float(x, digits) for x in fractions if ends(x) or x.q > MAX_DENOMINATOR}
    return expr.xreplace(fine).xreplace(angles)


def _apart(expr: Any) -> tuple[Any, dict[Any, Any]]:
    """Put symbols for the multiples of pi, which stay fractions; return what they stand for."""
    angles = {x: sp.Dummy() for x in expr.atoms(sp.Mul) if sp.pi in x.args}
    return expr.xreplace(angles), {symbol: x for x, symbol in angles.items()}


def _padded(name: str, digits: int) -> str:
    return re.sub(r"\d+", lambda number: number.group().zfill(digits), name)


class _Printer(StrPrinter):  # type: ignore[misc]
    """Prints symbols under other names than those by which they are sorted."""

    def __init__(self, names: dict[Any, str]):
        super().__init__({"full_prec": False})
        self._names = names

    def _print_Symbol(self, expr: Any) -> str:
        return self._names.get(expr, str(expr.name))
