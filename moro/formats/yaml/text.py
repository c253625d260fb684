"""Values and mappings as text of a robot file, as a person would type them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.str import StrPrinter

from moro.checks.constants import is_zero
from moro.formats import names
from moro.formats.yaml.expressions import (
    JOINT_VARIABLE,
    MAX_LENGTH,
    RESERVED,
    ExpressionError,
    parse,
)

#: columns of a line, where what is in it can be broken
WIDTH = 100
#: digits of a decimal; a fraction with more is written as one
_DIGITS = 40
#: zeros after the point above which a decimal is written with an exponent, as 1e-6
_ZEROS = 4
#: words that YAML takes for something else
_WORDS = {"y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf"}


class Values:
    """Writes exact values, with names for symbols that can stand in a file."""

    def __init__(self, symbols: Iterable[Any]):
        self.symbols: dict[Any, sp.Symbol] = {}
        for symbol in symbols:
            taken = {x.name for x in self.symbols.values()}
            self.symbols[symbol] = sp.Symbol(_free_name(str(symbol), taken))

    @property
    def renamed(self) -> dict[str, str]:
        """The symbols whose names cannot stand in a file, by their names there."""
        return {own.name: str(x) for x, own in self.symbols.items() if own.name != str(x)}

    def __call__(self, value: Any) -> str:
        """Return a value as an expression that is read as the same value. ValueError for none."""
        value = sp.sympify(value)
        if value.is_Rational:
            return _rational(value)
        variables = {q: sp.Symbol(_variable(q)) for q in value.atoms(AppliedUndef)}
        value = value.xreplace({**self.symbols, **variables})
        known = {x.name: x for x in (*self.symbols.values(), *variables.values())}
        for text in (_printed(value), str(value)):
            if len(text) <= MAX_LENGTH and _is_read_as(text.replace("Abs(", "abs("), value, known):
                return text.replace("Abs(", "abs(")
        raise ValueError(f"{value} cannot be written in a robot file: it is no expression of one")


def _free_name(name: str, taken: set[str]) -> str:
    if names.fault(name) or name in RESERVED or JOINT_VARIABLE.fullmatch(name):
        name = names.identifier(name, prefix="p")
        if name in RESERVED or JOINT_VARIABLE.fullmatch(name):
            name = f"p_{name}"
    free, i = name, 1
    while free in taken:
        i += 1
        free = f"{name}_{i}"
    return free


def _variable(q: Any) -> str:
    return f"q{q.func.__name__.removeprefix('q_')}"


def _is_read_as(text: str, value: Any, known: Mapping[str, Any]) -> bool:
    try:
        found = parse(text, known)
    except ExpressionError:
        return False
    return bool(found == value) or is_zero(sp.expand(found - value))


def _rational(x: Any) -> str:
    """Return a fraction as a decimal, if it is one."""
    digits = _decimals(x)
    if digits is None:
        return str(x)
    sign, whole = "-" if x < 0 else "", str(abs(int(x * 10**digits)))
    if len(whole) > _DIGITS:
        return str(x)
    if not digits:
        bare = whole.rstrip("0")
        short = len(whole) - len(bare) <= 2 * _ZEROS
        return sign + whole if short or not bare else f"{sign}{bare}e{len(whole) - len(bare)}"
    if digits - len(whole) >= _ZEROS:
        point = f".{whole[1:]}" if whole[1:] else ""
        return f"{sign}{whole[0]}{point}e-{digits - len(whole) + 1}"
    whole = whole.rjust(digits + 1, "0")
    return f"{sign}{whole[:-digits]}.{whole[-digits:]}"


def _decimals(x: Any) -> int | None:
    """Return how many digits after the point a fraction has; None if they do not end."""
    q, twos, fives = int(x.q), 0, 0
    while q % 2 == 0:
        q, twos = q // 2, twos + 1
    while q % 5 == 0:
        q, fives = q // 5, fives + 1
    return max(twos, fives) if q == 1 else None


class _Printer(StrPrinter):  # type: ignore[misc]
    """Prints floats, which stand for fractions, as the decimals that these are."""

    def _print_Float(self, x: Any) -> str:
        return _rational(sp.Rational(str(x)))


def _printed(value: Any) -> str:
    return str(_Printer().doprint(_with_decimals(value)))


def _with_decimals(value: Any) -> Any:
    """Return an expression with floats for the fractions beside symbols that are decimals."""
    if value.is_Rational and not value.is_Integer and _decimals(value) is not None:
        return sp.Float(_rational(value), 2 * _DIGITS)
    if value.is_Add or (value.is_Mul and value.free_symbols):
        return value.func(*map(_with_decimals, value.args))
    if value.is_Function and value.free_symbols:
        return value.func(*map(_with_decimals, value.args), evaluate=False)
    if value.is_Pow and value.free_symbols:
        return sp.Pow(_with_decimals(value.base), value.exp)
    return value


# -- layout ---------------------------------------------------------------------------------------


def word(text: str) -> str:
    """Return a name, in quotes where YAML would take it for something else."""
    plain = re.fullmatch(r"[A-Za-z_][\w./-]*", text, re.ASCII) and text.lower() not in _WORDS
    return text if plain else "'" + text.replace("'", "''") + "'"


def document(fields: Mapping[str, Any]) -> str:
    """Return a mapping as a file: a line for each field that fits in one."""
    return "\n".join(_lines(fields, "")) + "\n"


def _lines(fields: Mapping[str, Any], indent: str) -> Iterator[str]:
    for name, value in fields.items():
        line = f"{indent}{name}: {_flow(value)}"
        if _is_plain(value) or (len(line) <= WIDTH and name not in ("links", "bodies")):
            yield line
        elif not value:
            yield f"{indent}{name}: []"
        elif isinstance(value, Mapping):
            yield f"{indent}{name}:"
            yield from _lines(value, indent + "  ")
        elif all(isinstance(x, Mapping) for x in value):
            yield f"{indent}{name}:"
            for entry in value:
                first, *others = _lines(entry, indent + "    ")
                yield f"{indent}  - {first.lstrip()}"
                yield from others
        else:
            yield from _broken(name, value, indent)


def _broken(name: str, values: Iterable[Any], indent: str) -> Iterator[str]:
    """Yield a list with a line for each of its values."""
    yield f"{indent}{name}:"
    yield from (f"{indent}  - {_flow(value)}" for value in values)


def _is_plain(value: Any) -> bool:
    return isinstance(value, str)


def _flow(value: Any) -> str:
    """Return text, lists and mappings in one line."""
    if isinstance(value, str):
        return value
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name}: {_inside(x)}" for name, x in value.items()) + "}"
    return "[" + ", ".join(map(_inside, value)) + "]"


def _inside(value: Any) -> str:
    """Return a value that stands in brackets: an expression with a comma needs quotes."""
    comma = isinstance(value, str) and "," in value and not value.startswith("'")
    return f'"{value}"' if comma else _flow(value)
