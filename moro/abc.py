"""The usual symbols, ready to import: ``from moro.abc import *``.

``t`` is time. ``q1``, ``q2``, ... are joint variables, functions of time printed as the texts print
them, q_1(t). Lengths ``l1``, ``lc1``, ``d1``, ``a1``, masses ``m1``, angles ``alpha1``, torques
``tau1`` are symbols; ``l``, ``lc``, ``d``, ``m``, ``a``, ``alpha``, ``g``, ``tau`` are the same
without an index. Names run from 1 to 12; ``joint_variable(i)`` and ``symbol("m", i)`` go beyond.
"""

from __future__ import annotations

from typing import Any

from sympy import Function, Symbol

__all__ = ["joint_variable", "symbol", "t"]

#: indices that have a ready-made name
_COUNT = 12

_LETTERS = ("l", "lc", "d", "m", "a", "alpha", "g", "tau")

t = Symbol("t")


def joint_variable(i: int) -> Any:
    """Return q_i(t), the joint variable with index i [rad or m]."""
    return Function(f"q_{i}")(t)


def symbol(letter: str, i: int | None = None) -> Symbol:
    """Return the symbol ``letter``, or ``letter_i``."""
    return Symbol(letter if i is None else f"{letter}_{i}")


def _names() -> dict[str, Any]:
    names: dict[str, Any] = {letter: symbol(letter) for letter in _LETTERS}
    for i in range(1, _COUNT + 1):
        names[f"q{i}"] = joint_variable(i)
        names |= {f"{letter}{i}": symbol(letter, i) for letter in _LETTERS}
    return names


globals().update(_names())
__all__ += list(_names())
