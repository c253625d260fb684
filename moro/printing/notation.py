r"""The notation of the texts: ``sin(q_2(t) + q_3(t))*Derivative(q_1(t), t)`` as s_{23} \dot q_1.

``Notation`` makes formulas (``moro.printing.typeset``) of SymPy expressions. Terms and factors get
the order of the texts: masses and lengths, then sines and cosines by joint, then velocities;
accelerations before velocities before what depends on neither.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from moro.printing.markup import markup
from moro.printing.plain import MAX_DENOMINATOR, ends, natural
from moro.printing.typeset import (
    CLOSE,
    GREEK,
    MINUS,
    NEGATIVE,
    OPEN,
    PLUS,
    SPACE,
    Box,
    Formula,
    dotted,
    fraction,
    function,
    latex,
    letter,
    matrix,
    number,
    root,
    scripts,
    text,
    width,
)

#: fractions of pi with larger denominators, 1 degree being pi/180, are printed as decimals
_MAX_IN_ANGLE = 360
#: a bracket wider than this goes to the end of its product [em]
_LONG_BRACKET = 36.0
#: a numerator wider than this stands behind its fraction [em]
_LONG_NUMERATOR = 12.0
#: what products begin with, and what sums end with
_FIRST, _LAST = "mM", "IJ"
_INERTIAS = 2
_NAME = re.compile(r"([^\W\d_]+)(?:_\{?|(?=\d))(.+?)\}?")


@dataclass(frozen=True)
class _Part:
    """A factor of a product, or a term of a sum, with its place in the order."""

    key: tuple[Any, ...]
    boxes: Formula
    negative: bool = False
    #: (-order, joint) of the derivatives in it
    motion: Sequence[tuple[int, int]] = ()


class Notation:
    """How the formulas of one robot are written.

    ``variables`` are the joint variables, in order; ``symbols`` all other symbols of the model.
    With ``short``, s_2 stands for sin(q_2), if the model has no such symbol itself; with
    ``decimals``, fractions are printed as decimals where those end. Decimals have up to ``digits``
    digits.
    """

    def __init__(
        self,
        variables: Sequence[Any] = (),
        symbols: Iterable[Any] = (),
        digits: int = 5,
        short: bool = True,
        decimals: bool = False,
    ):
        self.digits = digits
        self.short = short and not any(re.fullmatch(r"[sc]_?\{?\d+\}?", str(x)) for x in symbols)
        self._decimals = decimals
        #: whether a number has been rounded
        self.rounded = False
        self._joints = {q: i for i, q in enumerate(variables, 1)}
        self._factors: dict[Any, _Part] = {}

    def formula(self, expr: Any) -> Formula:
        """Return an expression, a matrix, or an equation of either, as a formula."""
        if isinstance(expr, sp.Eq):
            return [*self.formula(expr.lhs), *markup("="), *self.formula(expr.rhs)]
        if getattr(expr, "is_Matrix", False):
            return self._matrix(expr)
        terms = sorted(map(self._term, sp.Add.make_args(sp.sympify(expr))), key=_by_key)
        terms.insert(0, terms.pop(_first_to_write(terms)))
        formula: Formula = []
        for i, term in enumerate(terms):
            if i:
                formula.append(MINUS if term.negative else PLUS)
            elif term.negative:
                formula.append(NEGATIVE)
            formula += term.boxes
        return formula

    def latex(self, expr: Any) -> str:
        """Return an expression or a matrix in LaTeX, for math mode."""
        return latex(self.formula(expr))

    def _matrix(self, expr: Any) -> Formula:
        """Return a matrix in brackets, or a sum of products of such."""
        if isinstance(expr, sp.MatAdd):
            first, *others = map(self.formula, expr.args)
            return [*first, *(box for term in others for box in [PLUS, *term])]
        if isinstance(expr, sp.MatMul):
            return _joined(map(self.formula, expr.args))
        return [matrix([[self.formula(x) for x in row] for row in expr.tolist()])]

    # -- terms ------------------------------------------------------------------------------------

    def _term(self, term: Any) -> _Part:
        coefficient, rest = term.as_coeff_Mul()
        above, below = [], []
        for factor in sp.Mul.make_args(rest):
            base, exponent = factor.as_base_exp()
            if exponent.is_Rational and exponent < 0:
                below.append(sp.Pow(base, -exponent))
            elif factor != 1:
                above.append(factor)
        if coefficient < 0:
            coefficient, above = self._without_two_signs(coefficient, above)
        factors = sorted(map(self._factor, above), key=_by_key)
        finest = _MAX_IN_ANGLE if sp.pi in above else MAX_DENOMINATOR
        boxes = self._quotient(abs(coefficient), factors, below, finest)
        key = self._term_key(factors)
        return _Part(key, boxes, bool(coefficient < 0), key[0])

    def _without_two_signs(self, coefficient: Any, factors: list[Any]) -> tuple[Any, list[Any]]:
        """Return (number, factors) of the same product without -(-x - y), which is (x + y)."""
        for k, x in enumerate(factors):
            if x.is_Add and self.formula(x)[0] is NEGATIVE:
                negated = sp.Add(*(-term for term in x.args))
                return -coefficient, [*factors[:k], negated, *factors[k + 1 :]]
        return coefficient, factors

    def _quotient(
        self, c: Any, factors: Sequence[_Part], below: Sequence[Any], finest: int
    ) -> Formula:
        """Return c * factors / below, a fraction where it stays small."""
        above = _joined(factor.boxes for factor in factors)
        plain = all(factor.key[0] == 0 for factor in factors)
        if (below or (plain and above)) and _is_fraction(c, finest):
            below, c = [sp.Integer(c.q), *below], sp.Integer(c.p)
        if not below:
            return _joined([self._number(c), above]) if c != 1 or not above else above
        denominator = _joined(self._factor(x).boxes for x in below)
        if c != 1 or not above or width(above) > _LONG_NUMERATOR:
            return _joined([[fraction(self._number(c), denominator)], above])
        return [fraction(above, denominator)]

    def _term_key(self, parts: Sequence[_Part]) -> tuple[Any, ...]:
        """Order of terms: accelerations, velocities, the rest; then by names; then by sines."""
        rates = sorted(x for part in parts for x in part.motion)
        names = [part.key[1] for part in parts if part.key[0] == 1]
        inertial = any(name[0] == _INERTIAS for name in names)
        moving = [part.key[1:] for part in parts if part.key[0] >= 3]
        return (rates or [(1,)], inertial, bool(moving), names, len(moving), moving)

    def _motion(self, factor: Any) -> list[tuple[int, int]]:
        """Return (-order, joint) of the derivatives that occur in a factor."""
        derivatives = map(self._derivative, factor.atoms(sp.Derivative))
        return sorted((-order, joint) for order, joint in derivatives)

    # -- factors ----------------------------------------------------------------------------------

    def _factor(self, factor: Any) -> _Part:
        found = self._factors.get(factor)
        if found is None:
            found = replace(self._new_factor(factor), motion=self._motion(factor))
            self._factors[factor] = found
        return found

    def _new_factor(self, factor: Any) -> _Part:
        base, exponent = factor.as_base_exp()
        above = self.formula(exponent) if exponent != 1 else None
        if exponent == sp.Rational(1, 2):
            rank = self._rank(base)
            return _Part((2 if rank == 1 else rank, []), [root(self.formula(base))])
        parts = self._letter_and_index(base)
        if parts is not None:
            return _Part(self._key(base), [scripts(*parts, above)])
        if isinstance(base, sp.Function) and all(isinstance(x, sp.Expr) for x in base.args):
            name = scripts(function(base.func.__name__), None, above)
            return _Part(self._key(base), [name, *self._bracket(*base.args)])
        if base.is_Number:
            return _Part((0, []), _powered(self._number(base), above))
        if base.is_Add or base.is_Mul:
            boxes = _powered(self._bracket(base), above)
            late = width(boxes) > _LONG_BRACKET
            return _Part((9 if late else self._rank(base), []), boxes)
        return _Part((9, []), _powered([text(str(base))], above))

    def _bracket(self, *expressions: Any) -> Formula:
        boxes = [OPEN]
        for i, expr in enumerate(expressions):
            boxes += [*([Box(",", "<mo>,</mo>", 0.45)] if i else []), *self.formula(expr)]
        return [*boxes, CLOSE]

    def _letter_and_index(self, x: Any) -> tuple[Box, Formula | None] | None:
        """Return what an exponent goes beside: a letter and its subscript; None for others."""
        if x in (sp.pi, sp.E):
            return letter("pi" if x is sp.pi else "e"), None
        if x.is_Symbol:
            return symbol(x.name)
        if x.is_Derivative:
            base, index = symbol(_name(x.expr))
            order, _ = self._derivative(x)
            return (dotted(base, order), index) if order <= 2 else None
        if isinstance(x, (sp.sin, sp.cos)) and self.short:
            index = self._angle(x.args[0])
            if index:
                return letter("s" if isinstance(x, sp.sin) else "c"), index
        if isinstance(x, sp.core.function.AppliedUndef):
            return symbol(_name(x))
        return None

    def _key(self, x: Any) -> tuple[Any, ...]:
        rank = self._rank(x)
        if rank == 1:
            return (1, _natural(str(x)))
        angle = x.args[0] if isinstance(x, (sp.sin, sp.cos)) else x
        joints = sorted(self._joints.get(q, 0) for q in _variables(angle))
        return (rank, joints, type(x) is not sp.sin)

    def _rank(self, x: Any) -> int:
        """Place in a product: numbers, symbols, their sums, joints, sines, sums, rates, sums."""
        if x.is_number:
            return 0
        if x.is_Symbol and x not in self._joints:
            return 1
        if x.has(sp.Derivative):
            return 8 if x.is_Add else 7
        if not any(q in self._joints for q in _variables(x)):
            return 2
        if x in self._joints:
            return 3
        return 5 if x.is_Add else 4

    def _derivative(self, x: Any) -> tuple[int, int]:
        """Return (order, joint) of a derivative with respect to time."""
        return sum(int(count) for _, count in x.variable_count), self._joints.get(x.expr, 0)

    def _angle(self, angle: Any) -> Formula:
        """Return an angle as an index: 23 for q_2 + q_3, a symbol as it is; nothing for others."""
        terms = sp.Add.make_args(angle)
        if all(term in self._joints for term in terms):
            comma = "," if len(self._joints) > 9 and len(terms) > 1 else ""
            return markup(comma.join(str(i) for i in sorted(self._joints[x] for x in terms)))
        return self.formula(angle) if angle.is_Symbol else []

    # -- numbers ----------------------------------------------------------------------------------

    def _number(self, x: Any) -> Formula:
        """Return a positive number, or one in brackets."""
        if x < 0:
            return [OPEN, NEGATIVE, *self._number(-x), CLOSE]
        if x.is_Integer:
            return [number(str(x))]
        if _is_fraction(x, MAX_DENOMINATOR) and not (self._decimals and ends(x)):
            return [fraction([number(str(x.p))], [number(str(x.q))])]
        decimal = f"{float(x):.{self.digits}g}"
        self.rounded |= sp.Rational(decimal) != x
        mantissa, _, exponent = decimal.partition("e")
        if not exponent:
            return [number(mantissa)]
        power = [NEGATIVE] if exponent[0] == "-" else []
        power.append(number(exponent.lstrip("+-0")))
        return [number(mantissa), *markup(r"\cdot"), scripts(number("10"), None, power)]


def _by_key(part: _Part) -> tuple[Any, ...]:
    return part.key


def _first_to_write(terms: Sequence[_Part]) -> int:
    """Return which term comes first: a positive one, if it is not moved past other rates."""
    alike = (i for i, term in enumerate(terms) if term.motion == terms[0].motion)
    return next((i for i in alike if not terms[i].negative), 0)


def _is_fraction(x: Any, finest: int) -> bool:
    return bool(x.is_Rational and 1 < x.q <= finest)


def symbol(name: str) -> tuple[Box, Formula | None]:
    """Return the letter and the subscript of a symbol's name: ``I_{x_1x_1}``, ``lc_2``, ``J1``."""
    match = _NAME.fullmatch(name)
    if not match:
        return (letter(name), None) if name.isalpha() else (text(name), None)
    base, index = match.groups()
    if base == "lc":
        base, index = "l", f"c{index}"
    try:
        return letter(base), _subscript(index)
    except ValueError:
        return text(name), None


def _subscript(index: str) -> Formula:
    if not re.fullmatch(r"[A-Za-z0-9_{},]+", index):
        raise ValueError(index)
    words = index.split("_")
    if all(word.isalpha() and (len(word) > 3 or word in GREEK) for word in words[:1]):
        boxes = [letter(word) if word in GREEK else text(word) for word in words]
        return _joined([[box] for box in boxes])
    return markup(index)


def _joined(factors: Iterable[Formula]) -> Formula:
    """Return factors side by side, with a little space between."""
    joined: Formula = []
    for boxes in factors:
        if boxes:
            joined += [SPACE, *boxes] if joined else boxes
    return joined


def _powered(boxes: Formula, above: Formula | None) -> Formula:
    return [*boxes[:-1], scripts(boxes[-1], None, above)] if above else boxes


def _name(x: Any) -> str:
    return str(x.func.__name__ if isinstance(x, sp.Function) else x)


def _variables(x: Any) -> set[Any]:
    found: set[Any] = x.atoms(sp.core.function.AppliedUndef) | x.free_symbols
    return found


def _natural(name: str) -> tuple[Any, ...]:
    """Sort key of a symbol: masses first, inertias last, k_2 before k_10."""
    rank = 0 if name[0] in _FIRST else _INERTIAS if name[0] in _LAST else 1
    return (rank, *natural(name))
