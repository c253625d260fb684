r"""Formulas as rows of boxes, which know their LaTeX, their MathML and about how wide they are.

A formula is a list of boxes. ``moro.printing.notation`` makes one of a SymPy expression,
``moro.printing.markup`` of text, ``r"\dot{q}_1"``. ``broken`` breaks a long one into lines of
bounded width, between terms, as far outside of brackets as it can. ``latex`` and ``mathml`` write a
line out.

Widths are in em of the text, those of Computer Modern or a little more.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["atom", "sign", "space", "open", "close"]


@dataclass(frozen=True)
class Box:
    """A piece of a formula that stays in one piece.

    Lines break before a "sign", a binary operator, or at a "space" between factors; "open" and
    "close" are brackets.
    """

    latex: str
    mathml: str
    #: [em]
    width: float
    kind: Kind = "atom"


Formula: TypeAlias = "list[Box]"


@dataclass(frozen=True)
class Line:
    """A line of a broken formula, and how far it is indented [em]."""

    boxes: Formula
    indent: float

    @property
    def width(self) -> float:
        """Estimated width with the indentation [em]."""
        return self.indent + width(self.boxes)


# -- out ------------------------------------------------------------------------------------------


def latex(formula: Formula) -> str:
    """Return a formula in LaTeX, for math mode."""
    return "".join(box.latex for box in formula)


def mathml(formula: Formula) -> str:
    """Return a formula in presentation MathML, without the element ``math``."""
    return "".join(box.mathml for box in formula)


def width(formula: Formula) -> float:
    """Return the estimated width of a formula [em]."""
    return sum(box.width for box in formula)


# -- breaking lines -------------------------------------------------------------------------------

#: continuation lines are indented, more within brackets
_INDENT, _INDENT_PER_BRACKET = 1.5, 0.5
#: what a break costs: each bracket around it, between factors, and a line that is left empty
_BRACKET_COST, _FACTOR_COST, _EMPTY_COST = 0.6, 2.0, 1.5


def broken(formula: Formula, limit: float) -> list[Line]:
    """Break a formula into lines no wider than ``limit`` [em], where boxes are not wider alone."""
    depths = _depths(formula)
    lines: list[Line] = []
    start, indent = 0, 0.0
    while start < len(formula):
        end = _best_break(formula, depths, start, limit - indent)
        lines.append(Line(_trimmed(formula[start:end], first=start == 0), indent))
        if end < len(formula):
            indent = _INDENT + _INDENT_PER_BRACKET * min(depths[end], 4)
        start = end
    return lines or [Line([], 0.0)]


def _best_break(formula: Formula, depths: Sequence[int], start: int, limit: float) -> int:
    """Return where the line from ``start`` on ends, by cost, or as soon as it can."""
    used, best, least = formula[start].width, None, float("inf")
    for position in range(start + 1, len(formula)):
        kind = formula[position].kind
        if kind in ("sign", "space"):
            if used > limit and best is not None:
                return best
            cost = _BRACKET_COST * depths[position] + _EMPTY_COST * (1 - used / limit)
            cost += _FACTOR_COST if kind == "space" else 0.0
            if cost <= least or used > limit:
                best, least = position, cost
        used += formula[position].width
    return len(formula) if used <= limit or best is None else best


def _depths(formula: Formula) -> list[int]:
    depths, depth = [], 0
    for box in formula:
        depths.append(depth)
        depth += (box.kind == "open") - (box.kind == "close")
    return depths


def _trimmed(boxes: Formula, first: bool) -> Formula:
    """Return a line as it starts: a sign keeps the space around it, a product shows that it is."""
    head = boxes[0]
    if not first and head.kind == "sign":
        infix = head.mathml.replace("<mo>", '<mo form="infix">')
        return [Box("{}" + head.latex, infix, head.width, "sign"), *boxes[1:]]
    if head.kind == "space":
        return [Box(r"{}\cdot ", '<mo form="infix">⋅</mo>', 0.8, "sign"), *boxes[1:]]
    return boxes


# -- boxes ----------------------------------------------------------------------------------------

SPACE = Box(r"\,", '<mspace width="0.17em"/>', 0.17, "space")
PLUS = Box("+", "<mo>+</mo>", 1.25, "sign")
MINUS = Box("-", "<mo>−</mo>", 1.25, "sign")
#: of one number or term
NEGATIVE = Box("-", "<mo>−</mo>", 0.8)
OPEN = Box("(", '<mo stretchy="false">(</mo>', 0.4, "open")
CLOSE = Box(")", '<mo stretchy="false">)</mo>', 0.4, "close")

_SMALL = 0.8
_WIDTHS = dict.fromkeys("ijlrtI.,;: ", 0.45) | {"w": 0.75, "m": 0.9, "M": 1.0, "W": 1.0}
_LATEX_SPECIALS = {c: "\\" + c for c in "#$%&_{}"} | {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
GREEK = {
    unicodedata.name(chr(code)).split()[-1].lower(): chr(code)
    for code in (*range(0x3B1, 0x3C2), *range(0x3C3, 0x3CA))
}
GREEK["lambda"] = GREEK.pop("lamda")
GREEK |= {name.capitalize(): letter.upper() for name, letter in GREEK.items()}
_GREEK_NAMES = {letter: name for name, letter in GREEK.items()}
#: Greek letters without a command of LaTeX look like Latin ones, mostly the first of their name
_LOOKALIKES = {"Eta": "H", "Rho": "P", "Chi": "X"}
_COMMANDS = {name for name in GREEK if name.islower()} - {"omicron"}
_COMMANDS |= {"Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi"}
_COMMANDS.add("Omega")


def letter(name: str) -> Box:
    """Return a letter, or the name of a Greek one, or a word, in italics."""
    name = _GREEK_NAMES.get(name, name)
    if name in GREEK:
        latin = _LOOKALIKES.get(name, name[0])
        command = rf"\{name} " if name in _COMMANDS else latin
        return Box(command, f"<mi>{GREEK[name]}</mi>", 0.85 if name[0].isupper() else 0.65)
    if not name.isascii() or not name.isalpha():
        return text(name)
    command = name if len(name) == 1 else rf"\mathit{{{name}}}"
    return Box(command, f"<mi>{name}</mi>", sum(map(_letter_width, name)))


def number(digits: str) -> Box:
    """Return digits, with a decimal point perhaps."""
    return Box(digits, f"<mn>{digits}</mn>", 0.5 * len(digits))


def text(words: str) -> Box:
    """Return upright words, any characters."""
    return Box(
        rf"\text{{{escaped_latex(words)}}}",
        f"<mtext>{escape(_composed(words))}</mtext>",
        sum(map(_letter_width, _printable(words))),
    )


def function(name: str) -> Box:
    """Return the name of a function, sin or sign."""
    command = rf"\{name} " if name in ("sin", "cos", "tan") else rf"\operatorname{{{name}}}"
    return Box(command, f'<mi mathvariant="normal">{name}</mi>', 0.5 * len(name))


def scripts(base: Box, below: Formula | None = None, above: Formula | None = None) -> Box:
    """Return a box with a subscript, an exponent, or both."""
    if below is None and above is None:
        return base
    wide = base.width + _SMALL * max(width(below or []), width(above or [])) + 0.05
    low, high = (f"<mrow>{mathml(x or [])}</mrow>" for x in (below, above))
    code = base.latex.strip()
    if below is None:
        return Box(f"{code}^{{{latex(above or [])}}}", f"<msup>{base.mathml}{high}</msup>", wide)
    code += f"_{{{latex(below)}}}"
    if above is None:
        return Box(code, f"<msub>{base.mathml}{low}</msub>", wide)
    return Box(f"{code}^{{{latex(above)}}}", f"<msubsup>{base.mathml}{low}{high}</msubsup>", wide)


def dotted(base: Box, dots: int) -> Box:
    """Return a letter with dots above, a derivative with respect to time."""
    accent = "˙¨"[dots - 1]
    return Box(
        rf"\{'d' * dots}ot{{{base.latex.strip()}}}",
        f'<mover accent="true">{base.mathml}<mo stretchy="false">{accent}</mo></mover>',
        base.width,
    )


def fraction(above: Formula, below: Formula) -> Box:
    """Return a small fraction."""
    return Box(
        rf"\tfrac{{{latex(above)}}}{{{latex(below)}}}",
        f"<mfrac><mrow>{mathml(above)}</mrow><mrow>{mathml(below)}</mrow></mfrac>",
        _SMALL * max(width(above), width(below)) + 0.3,
    )


def root(formula: Formula) -> Box:
    """Return a square root."""
    return Box(
        rf"\sqrt{{{latex(formula)}}}", f"<msqrt>{mathml(formula)}</msqrt>", width(formula) + 0.9
    )


def matrix(rows: Sequence[Sequence[Formula]]) -> Box:
    """Return a matrix in brackets."""
    columns = [max(map(width, column)) for column in zip(*rows, strict=True)]
    body = r" \\ ".join(" & ".join(latex(x) or "{}" for x in row) for row in rows)
    cells = ("".join(f"<mtd>{mathml(x)}</mtd>" for x in row) for row in rows)
    table = "".join(f"<mtr>{row}</mtr>" for row in cells)
    return Box(
        rf"\begin{{bmatrix}} {body} \end{{bmatrix}}",
        f"<mrow><mo>[</mo><mtable>{table}</mtable><mo>]</mo></mrow>",
        sum(columns) + len(columns) + 0.5,
    )


def escaped_latex(words: str) -> str:
    """Return text for LaTeX: special characters escaped, others than Latin ones by number."""
    return "".join(_LATEX_SPECIALS.get(c, c) for c in _printable(words))


def _composed(words: str) -> str:
    """Return text with accents on their letters, and without control characters."""
    composed = unicodedata.normalize("NFC", words)
    return "".join(c if unicodedata.category(c)[0] != "C" else " " for c in composed)


def _printable(words: str) -> str:
    """Return text in characters that LaTeX has: others than Latin ones by their number."""
    return "".join(c if ord(c) < 0x180 else f"[U+{ord(c):04X}]" for c in _composed(words))


def _letter_width(character: str) -> float:
    return _WIDTHS.get(character) or (0.82 if character.isupper() else 0.55)
