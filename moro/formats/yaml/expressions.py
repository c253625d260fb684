"""Text to an exact SymPy value, by a parser that knows arithmetic and nothing else.

    sum      ::=  product (("+" | "-") product)*
    product  ::=  sign (("*" | "/") sign)*
    sign     ::=  ("+" | "-") sign  |  power
    power    ::=  atom ["**" sign]
    atom     ::=  number  |  "pi"  |  parameter  |  function "(" sum ("," sum)* ")"  |  "(" sum ")"

The precedence is Python's: ``-2**2`` is -4, ``2**3**2`` is 2**9. Text is never evaluated as code.
Whatever is accepted is a real, finite number, or an expression of the parameters; a decimal is the
rational number that it says, 0.4318 = 2159/5000. The bounds below keep hostile text cheap.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, NoReturn, TypeAlias

import sympy

from moro.checks.constants import MAX_MAGNITUDE, RANGE, is_sane, is_zero, numeric
from moro.formats.errors import nearest

Expr: TypeAlias = Any

#: characters of an expression
MAX_LENGTH = 1000
#: parentheses, functions, signs and powers inside each other
MAX_DEPTH = 30
#: size of an exponent, and of its denominator
MAX_EXPONENT = 32
#: size of a constant angle in sin, cos and tan
MAX_ANGLE = 1_000_000
#: bits of the numerator and of the denominator of a rational number
MAX_BITS = 4096

#: name: (number of arguments, SymPy's function)
FUNCTIONS: dict[str, tuple[int, Callable[..., Expr]]] = {
    "sin": (1, sympy.sin),
    "cos": (1, sympy.cos),
    "tan": (1, sympy.tan),
    "asin": (1, sympy.asin),
    "acos": (1, sympy.acos),
    "atan": (1, sympy.atan),
    "atan2": (2, sympy.atan2),
    "sqrt": (1, sympy.sqrt),
    "exp": (1, sympy.exp),
    "log": (1, sympy.log),
    "abs": (1, sympy.Abs),
}

_PERIODIC = (sympy.sin, sympy.cos, sympy.tan)

#: names that no parameter may have: pi, the functions, time, the joint variables
RESERVED = frozenset({"pi", "t", *FUNCTIONS})
JOINT_VARIABLE = re.compile(r"q_?[0-9]*")


class ExpressionError(ValueError):
    """Text that is not an expression, or whose value is not a real, finite number."""


def parse(text: str, names: Mapping[str, sympy.Symbol] | None = None) -> Expr:
    """Return the exact value of ``text``, an expression over numbers, pi and ``names``.

    ``names`` stand for real numbers while the value is found. Raises ExpressionError, saying what
    was found and what was expected.
    """
    if len(text) > MAX_LENGTH:
        _refuse(f"an expression of {len(text)} characters; at most {MAX_LENGTH} are read")
    try:
        names = names or {}
        value = _Parser(text, names).value()
        return value.xreplace({real: names[real.name] for real in value.free_symbols})
    except ExpressionError:
        raise
    except (ArithmeticError, AttributeError, TypeError, ValueError) as error:
        # corners of SymPy, such as roots of sums with 200 digits
        raise ExpressionError(f"{quoted(text)} is too intricate to be evaluated") from error


def quoted(text: str) -> str:
    """Return ``text`` as messages show it: one line, in backticks, cut where it is long."""
    line = " ".join(text.split())
    return f"`{line}`" if len(line) <= 60 else f"`{line[:57]}...`"


def _refuse(message: str) -> NoReturn:
    raise ExpressionError(message)


# --- text to tokens ------------------------------------------------------------------------------


class _Token(NamedTuple):
    kind: str  # "number", "name", an operator as itself, or "end"
    text: str
    start: int


_TOKEN = re.compile(
    r"[ \t\r\n]*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<operator>\*\*|[-+*/(),])"
    r"|(?P<end>$))"
)

#: what people type that looks like mathematics, and what to type for it
_INSTEAD = {
    "^": "a power is written `**`",
    "−": "this is a typeset minus sign; type `-`",
    "–": "this is a dash; type `-`",
    "·": "a product is written `*`",
    "×": "a product is written `*`",
    "÷": "a quotient is written `/`",
    "π": "write `pi`",
    "°": "angles are in radians; 90 degrees are `pi/2`, 30 degrees `30*pi/180`",
    "'": "expected a number or an expression, not text",
    '"': "expected a number or an expression, not text",
    ":": "a value is one number, without `:`",
    "[": "use round brackets",
    "]": "use round brackets",
    ".": "write `pi` and function names without a module",
    "\N{NO-BREAK SPACE}": "this is a no-break space; type a plain one",
}

_UNITS = frozenset(
    ["m", "cm", "mm", "in", "kg", "g", "lb", "rad", "deg", "degrees", "N", "Nm", "s"]
)


def _tokens(text: str) -> list[_Token]:
    tokens = []
    at = 0
    while True:
        match = _TOKEN.match(text, at)
        if match is None:
            start = len(text) - len(text[at:].lstrip(" \t\r\n"))
            if re.match(r"\.(inf|nan)\b", text[start:], re.IGNORECASE):
                _refuse(f"{quoted(text)} is not a finite number")
            character = text[start]
            hint = _INSTEAD.get(character, "expected numbers, names and + - * / ** ( )")
            _refuse(f"{quoted(text)}: `{character}` is not understood; {hint}")
        kind = match.lastgroup or ""
        token = match[kind]
        tokens.append(_Token(token if kind == "operator" else kind, token, match.start(kind)))
        if kind == "end":
            return tokens
        at = match.end()


# --- tokens to a value ---------------------------------------------------------------------------


class _Parser:
    """One method per rule of the grammar; each returns the value of what it has read."""

    def __init__(self, text: str, names: Mapping[str, sympy.Symbol]) -> None:
        self.text = text
        self.names = names
        self.tokens = _tokens(text)
        self.at = 0
        self.depth = 0

    def value(self) -> Expr:
        if self.next.kind == "end":
            _refuse("is empty; expected a number or an expression")
        value = self.sum()
        if self.next.kind != "end":
            self.unexpected()
        return value

    def sum(self) -> Expr:
        start = self.next.start
        value = self.product()
        while self.next.kind in ("+", "-"):
            sign = 1 if self.take().kind == "+" else -1
            value = self.checked(value + sign * self.product(), start)
        return value

    def product(self) -> Expr:
        start = self.next.start
        value = self.sign()
        while self.next.kind in ("*", "/"):
            if self.take().kind == "*":
                value = self.checked(value * self.sign(), start)
                continue
            divisor = self.sign()
            if is_zero(divisor):
                _refuse(f"{self.since(start)} divides by zero")
            value = self.checked(value / divisor, start)
        return value

    def sign(self) -> Expr:
        if self.next.kind not in ("+", "-"):
            return self.power()
        sign = self.take().kind
        with self:
            value = self.sign()
        return value if sign == "+" else -value

    def power(self) -> Expr:
        start = self.next.start
        base = self.atom()
        if self.next.kind != "**":
            return base
        self.take()
        with self:
            exponent = self.sign()
        if not exponent.is_Rational:
            _refuse(f"{self.since(start)}: an exponent is a constant rational number, as 2 or 1/2")
        if abs(exponent) > MAX_EXPONENT or exponent.q > MAX_EXPONENT:
            _refuse(
                f"{self.since(start)}: an exponent is at most {MAX_EXPONENT} in size,"
                f" and so is its denominator"
            )
        if base.is_Rational and _bits(base) * abs(exponent) > 2 * MAX_BITS:
            _refuse(f"{self.since(start)} has too many digits")
        if exponent < 0 and is_zero(base):
            _refuse(f"{self.since(start)} divides by zero")
        return self.checked(base**exponent, start)

    def atom(self) -> Expr:
        token = self.take()
        if token.kind == "number":
            return self.number(token)
        if token.kind == "name":
            return self.call(token) if self.next.kind == "(" else self.name(token)
        if token.kind == "(":
            with self:
                value = self.sum()
            self.expect(")", token)
            return value
        self.at -= 1
        return self.unexpected()

    def number(self, token: _Token) -> Expr:
        mantissa, _, exponent = token.text.lower().partition("e")
        whole, _, decimals = mantissa.partition(".")
        if len(whole) > 1 and whole.startswith("0"):
            _refuse(f"{quoted(token.text)}: a number has no zeros in front of it")
        # checked before 10**exponent is made; the digits before the point are bounded by the length
        if len(exponent) > 5 or abs(int(exponent or 0)) > MAX_MAGNITUDE:
            _refuse(f"{quoted(token.text)} is beyond {RANGE} in size")
        shift = int(exponent or 0) - len(decimals)
        return self.checked(int(whole + decimals) * sympy.Integer(10) ** shift, token.start)

    def name(self, token: _Token) -> Expr:
        if token.text == "pi":
            return sympy.pi
        if token.text in self.names:
            return sympy.Symbol(token.text, real=True)
        if token.text in FUNCTIONS:
            _refuse(f"`{token.text}` is a function: write `{token.text}(...)`")
        if token.text.lower() in ("nan", "inf", "infinity"):
            _refuse(f"`{token.text}` is not a finite number")
        variables = [name for name in self.names if JOINT_VARIABLE.fullmatch(name)]
        if token.text == "t":
            _refuse("`t` stands for time; expected a constant")
        if JOINT_VARIABLE.fullmatch(token.text):
            _refuse(
                f"{quoted(token.text)} stands for a joint variable; there can be `q1` to"
                f" `q{len(variables) // 2}`, one for each joint"
                if variables
                else f"{quoted(token.text)} stands for a joint variable, which only `theta` of a"
                " joint that turns and `d` of one that slides may hold"
            )
        hint = nearest(token.text, ["pi", *(x for x in self.names if x not in variables)])
        hint = hint or f"; declare it, `parameters: {{{token.text}: 1}}`, where 1 is its default"
        return _refuse(f"{quoted(token.text)} is not a number, `pi` or a declared parameter{hint}")

    def call(self, token: _Token) -> Expr:
        if token.text not in FUNCTIONS:
            if token.text == "pi" or token.text in self.names:
                _refuse(f"`{token.text}(`: an operator such as `*` is missing before the bracket")
            hint = nearest(token.text, FUNCTIONS) or f"; known are {', '.join(FUNCTIONS)}"
            _refuse(f"{quoted(token.text)} is not a function that may be used{hint}")
        bracket = self.take()
        arguments = []
        with self:
            while self.next.kind != ")":
                arguments.append(self.sum())
                if self.next.kind != ",":
                    break
                self.take()
        self.expect(")", bracket)
        count, function = FUNCTIONS[token.text]
        if len(arguments) != count:
            plural = "s" if count > 1 else ""
            _refuse(
                f"{self.since(token.start)}: {token.text} takes {count} argument{plural},"
                f" found {len(arguments)}"
            )
        if function in _PERIODIC and _exceeds(arguments[0], MAX_ANGLE):
            _refuse(f"{self.since(token.start)}: an angle is at most {MAX_ANGLE} rad in size")
        if function is sympy.exp and arguments[0].has(sympy.log):
            # SymPy makes exp(r*log(x)) the power x**r, and r may be of any size
            _refuse(f"{self.since(token.start)} has a logarithm in exp; write it as a power, `**`")
        return self.checked(function(*arguments), token.start)

    # reading tokens

    @property
    def next(self) -> _Token:
        return self.tokens[self.at]

    def take(self) -> _Token:
        token = self.next
        self.at += 1
        return token

    def expect(self, kind: str, opening: _Token) -> None:
        if self.next.kind == "end":
            hint = ""
            if "," not in self.text:
                # [atan2(1, 2), 0] splits at the comma before it comes here
                hint = "; in a list, an expression with a comma needs quotes around it"
            _refuse(f"{quoted(self.text)}: `{opening.text}` is not closed{hint}")
        if self.next.kind != kind:
            self.unexpected()
        self.take()

    def since(self, start: int) -> str:
        """Quote what has been read since ``start``."""
        return quoted(self.text[start : self.next.start])

    def unexpected(self) -> NoReturn:
        token = self.next
        before = self.text[: token.start].strip()
        if token.kind == "end":
            _refuse(f"{quoted(self.text)} ends where a number or a name is expected")
        if not before or token.kind not in ("name", "number", ",", "("):
            _refuse(f"{quoted(self.text)}: `{token.text}` is not expected here")
        previous = self.tokens[self.at - 1]
        if token.kind == ",":
            hint = "a value is one number, and decimals have a point"
            if previous.kind == "number" and self.tokens[self.at + 1].kind == "number":
                hint += f": `{previous.text}.{self.tokens[self.at + 1].text}`"
        elif token.text in _UNITS:
            hint = "values are in SI units, angles in radians, and written without them"
        elif re.fullmatch(r"_[0-9_]+", token.text):
            hint = "digits are written without `_`"
        else:
            hint = "is an operator such as `*` missing?"
        found = f"{quoted(token.text)} is not expected after {quoted(before)}"
        _refuse(f"{quoted(self.text)}: {found}; {hint}")

    def __enter__(self) -> None:
        """Go one level deeper."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            _refuse(f"{quoted(self.text)} is nested deeper than {MAX_DEPTH} levels")

    def __exit__(self, *error: object) -> None:
        self.depth -= 1

    # judging values

    def checked(self, value: Expr, start: int) -> Expr:
        """Return ``value``, the text since ``start``, if it is real, finite and of a sane size."""
        if value.has(sympy.nan, sympy.zoo, sympy.oo, -sympy.oo):
            _refuse(f"{self.since(start)} is not a finite number")
        if any(_bits(number) > MAX_BITS for number in value.atoms(sympy.Rational)):
            _refuse(f"{self.since(start)} has too many digits")
        if value.has(sympy.I):
            _refuse(f"{self.since(start)} is not a real number")
        exponents = [power.exp for power in value.atoms(sympy.Pow)]
        if any(e.is_Rational and abs(e) > MAX_EXPONENT for e in exponents):
            _refuse(f"{self.since(start)} has an exponent above {MAX_EXPONENT}")
        if is_zero(value):
            return sympy.Integer(0)
        if value.is_number and not numeric(value).is_Number:
            _refuse(f"{self.since(start)} is not a real number")
        if not is_sane(value):
            _refuse(f"{self.since(start)} is beyond {RANGE} in size")
        return value


def _bits(number: Expr) -> int:
    return max(int(number.p).bit_length(), int(number.q).bit_length())


def _exceeds(value: Expr, bound: int) -> bool:
    return bool(value.is_number and abs(numeric(value)) > bound)
