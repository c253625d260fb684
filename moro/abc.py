"""The usual symbols, ready to import: ``from moro.abc import *``.

``t`` is time. ``q1``, ``q2``, ... are joint variables, functions of time printed as the texts print
them, q_1(t); ``qd1`` and ``qdd1`` are their first and second derivatives. Lengths ``l1``, ``lc1``,
``d1``, ``a1``, masses ``m1``, angles ``alpha1``, ``theta1``, torques ``tau1`` are symbols; ``l``,
``lc``, ``d``, ``m``, ``a``, ``g`` and the Greek letters are symbols without an index (``lambda`` is
a word of Python, and pi a number, SymPy's). Names run from 1 to 12; ``joint_variable(i)`` and
``symbol("m", i)`` go beyond.
"""

from __future__ import annotations

from typing import Any

from sympy import Function, Symbol

__all__ = ["joint_variable", "symbol", "t"]

#: indices that have a ready-made name
_COUNT = 12

_INDEXED = ("l", "lc", "d", "m", "a", "alpha", "theta", "g", "tau")
_GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "mu"),
    *("nu", "xi", "omicron", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
)

t = Symbol("t")


def joint_variable(i: int) -> Any:
    """Return q_i(t), the joint variable with index i [rad or m]."""
    return Function(f"q_{i}")(t)


def symbol(letter: str, i: int | None = None) -> Symbol:
    """Return the symbol ``letter``, or ``letter_i``; "lc" is l_c, l_ci, a length to a centre."""
    index = "" if i is None else str(i)
    if letter == "lc":
        return Symbol(f"l_c{index}")
    return Symbol(f"{letter}_{index}" if index else letter)


def _names() -> dict[str, Any]:
    names: dict[str, Any] = {letter: symbol(letter) for letter in (*_INDEXED, *_GREEK)}
    for i in range(1, _COUNT + 1):
        q = joint_variable(i)
        names |= {f"q{i}": q, f"qd{i}": q.diff(t), f"qdd{i}": q.diff(t, 2)}
        names |= {f"{letter}{i}": symbol(letter, i) for letter in _INDEXED}
    return names


globals().update(_names())
__all__ += list(_names())
