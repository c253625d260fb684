from __future__ import annotations

import ast
import math
import time
from fractions import Fraction

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import Rational, pi, sqrt

from moro.formats.yaml.expressions import MAX_DEPTH, MAX_LENGTH, ExpressionError, parse

a, b = sympy.symbols("a b")
NAMES = {"a": a, "b": b}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("0.4318", Rational(2159, 5000)),
        ("4e-05", Rational(1, 25000)),
        (".5", Rational(1, 2)),
        ("5.", 5),
        ("1E+2", 100),
        ("-3", -3),
        ("+3", 3),
        ("--3", 3),
        ("1/3", Rational(1, 3)),
        ("0.1 + 0.2 - 0.3", 0),
        ("pi/2", pi / 2),
        ("-pi/2", -pi / 2),
        ("30*pi/180", pi / 6),
        ("-2**2", -4),
        ("2**-1", Rational(1, 2)),
        ("2**3**2", 512),
        ("(2**3)**2", 64),
        ("4**0.5", 2),
        ("8/4/2", 1),
        ("7 - 2 - 1", 4),
        ("2*(3 + 4)", 14),
        ("  1\t+\n1 ", 2),
        ("sin(pi/6)", Rational(1, 2)),
        ("cos(pi/2)", 0),
        ("tan(pi/4)", 1),
        ("asin(1)", pi / 2),
        ("acos(1/2)", pi / 3),
        ("atan(1)", pi / 4),
        ("atan2(1, -1)", 3 * pi / 4),
        ("sqrt(2)", sqrt(2)),
        ("sqrt(2)**2", 2),
        ("exp(0)", 1),
        ("log(exp(2))", 2),
        ("abs(-3/4)", Rational(3, 4)),
        ("a", a),
        ("2*a - b/2 + pi", 2 * a - b / 2 + pi),
        ("sqrt(a**2 + b**2)", sqrt(a**2 + b**2)),
        ("atan2(a, b)", sympy.atan2(a, b)),
    ],
)
def test_values_are_exact(text, value):
    found = parse(text, NAMES)
    assert found == value
    assert not found.atoms(sympy.Float)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "empty"),
        ("1 +", "ends where"),
        ("* 2", "`*` is not expected"),
        ("1)", "`)` is not expected"),
        ("()", "`)` is not expected"),
        ("(1", "not closed"),
        ("[1]", "`[` is not understood"),
        ("7//2", "`/` is not expected"),
        ("5 % 3", "`%` is not understood"),
        ("a = 1", "`=` is not understood"),
        ("a if 1 else b", "`if` is not expected after `a`"),
        ("2^3", "a power is written `**`"),
        ("1,5", "decimals have a point: `1.5`"),
        ("1.2.3", "`.3` is not expected"),
        ("1_000", "without `_`"),
        ("0x10", "`x10` is not expected"),
        ("010", "no zeros in front"),
        ("1:30", "without `:`"),
        ("1e", "`e` is not expected"),
        ("2pi", "is an operator such as `*` missing?"),
        ("2(3)", "is an operator such as `*` missing?"),
        ("pi(2)", "an operator such as `*` is missing"),
        ("1.5 kg", "SI units"),
        ("pi/2 rad", "SI units, angles in radians"),
        ("90°", "90 degrees are `pi/2`"),
        ("π/2", "write `pi`"),
        ("−1", "type `-`"),
        ("np.pi", "write `pi`"),
        ("PI", "did you mean `pi`?"),
        ("c", "`c` is not a number, `pi` or a declared parameter"),
        ("q1", "joint variable"),
        ("q_2 + pi", "joint variable"),
        ("t", "time"),
        ("sine(1)", "did you mean `sin`?"),
        ("sin", "write `sin(...)`"),
        ("sin()", "takes 1 argument, found 0"),
        ("sin(1, 2)", "takes 1 argument, found 2"),
        ("atan2(1)", "takes 2 arguments, found 1"),
        ("atan2(1", "needs quotes"),
        ("'1'", "not text"),
        ("lambda: 1", "not understood"),
        ("__import__('os').system('true')", "not understood"),
        ("__import__(1)", "is not a function that may be used"),
        ("eval(1)", "is not a function that may be used"),
        ("a.free_symbols", "not understood"),
    ],
)
def test_other_text_is_refused(text, said):
    with pytest.raises(ExpressionError) as error:
        parse(text, NAMES)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1/0", "`1/0` divides by zero"),
        ("1/(a - a)", "divides by zero"),
        ("0**-1", "divides by zero"),
        ("1/(0.1 + 0.2 - 0.3)", "divides by zero"),
        ("1/(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6)))", "divides by zero"),
        ("2*sqrt(-1)", "`sqrt(-1)` is not a real number"),
        ("(-8)**(1/3)", "not a real number"),
        ("asin(2)", "not a real number"),
        ("log(-1)", "not a real number"),
        ("sqrt(-a**2)", "not a real number"),
        ("log(0)", "not a finite number"),
        ("tan(pi/2)", "not a finite number"),
        ("atan2(0, 0)", "not a finite number"),
        ("nan", "not a finite number"),
        (".nan", "not a finite number"),
        ("inf", "not a finite number"),
        ("-.inf", "not a finite number"),
        ("1e301", "beyond 1e-300..1e300"),
        ("1e999999999", "beyond"),
        ("1e99999999999999999999", "beyond"),
        ("9" * 302, "beyond"),
        ("1e300*1e300", "beyond"),
        ("1e-300*1e-300", "beyond"),
        ("a*1e300*1e300", "beyond"),
        ("exp(1000)", "beyond"),
        ("exp(exp(exp(exp(exp(10)))))", "beyond"),
        ("sin(1e200)", "at most 1000000 rad"),
        ("tan(2e6*pi)", "at most 1000000 rad"),
        ("9**9**9", "at most 32"),
        ("2**33", "at most 32"),
        ("2**(1/33)", "at most 32"),
        ("((a**32)**32)**32", "above 32"),
        ("(((1 + 1e-300)**32)**32)**32", "too many digits"),
        ("2**a", "constant rational number"),
        ("2**pi", "constant rational number"),
        ("1" * (MAX_LENGTH + 1), "at most 1000"),
        ("(" * (MAX_DEPTH + 1) + "1" + ")" * (MAX_DEPTH + 1), "deeper than 30"),
        ("-" * 999 + "1", "deeper than 30"),
        ("sin(" * 190 + "1" + ")" * 190, "deeper than 30"),
        ("2" + "**1" * 300, "deeper than 30"),
    ],
)
def test_values_that_are_not_real_finite_and_small_are_refused_at_once(text, said):
    start = time.thread_time()
    with pytest.raises(ExpressionError) as error:
        parse(text, NAMES)
    assert said in str(error.value)
    assert len(str(error.value)) < 300
    assert time.thread_time() - start < 5


def test_bounds_leave_room():
    deep = MAX_DEPTH - 1
    assert parse("(" * deep + "1" + ")" * deep) == 1
    assert parse("+".join(["a"] * 500), NAMES) == 500 * a
    assert parse("1e300") == 10**300
    assert parse("1e-300") == Rational(1, 10**300)
    assert parse("a**32", NAMES) == a**32


# --- against Python's own arithmetic on fractions ------------------------------------------------

decimals = st.decimals(min_value=0, max_value=1000, places=4).map(str)
integers = st.integers(min_value=0, max_value=10**6).map(str)
spaces = st.sampled_from(["", " ", "\t"])


def _compound(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(parts, spaces, st.sampled_from("+-*/"), spaces, parts).map("".join),
        parts.map("({})".format),
        st.tuples(st.sampled_from("+-"), parts).map("".join),
        st.tuples(parts, st.integers(-3, 3)).map(lambda p: f"({p[0]})**{p[1]}"),
    )


arithmetic = st.recursive(st.one_of(decimals, integers), _compound, max_leaves=12)


def _by_python(text: str) -> Fraction:
    """Evaluate with Python's grammar and precedence, every literal a Fraction."""
    tree = ast.parse(text.strip(), mode="eval")

    class Literals(ast.NodeTransformer):
        def visit_Constant(self, node: ast.Constant) -> ast.AST:
            source = ast.get_source_segment(text.strip(), node)
            return ast.Call(ast.Name("Fraction", ast.Load()), [ast.Constant(source)], [])

    code = compile(ast.fix_missing_locations(Literals().visit(tree)), "<test>", "eval")
    return eval(code, {"Fraction": Fraction})  # noqa: S307 - text of this test's own making


@settings(deadline=None, max_examples=200)
@given(arithmetic)
def test_arithmetic_is_that_of_fractions(text):
    try:
        expected = _by_python(text)
    except ZeroDivisionError:
        with pytest.raises(ExpressionError, match="divides by zero"):
            parse(text)
        return
    if expected and not 1e-300 < abs(expected) < 1e300:
        return
    try:
        found = parse(text)
    except ExpressionError as error:  # an intermediate result may be beyond the bounds
        assert "beyond" in str(error) or "too many digits" in str(error)  # noqa: PT017
        return
    assert Fraction(int(found.p), int(found.q)) == expected


@settings(deadline=None, max_examples=100)
@given(st.floats(min_value=1e-290, max_value=1e290))
def test_the_text_of_a_float_is_its_decimal_value(number):
    value = parse(repr(number))
    assert Fraction(int(value.p), int(value.q)) == Fraction(repr(number))
    assert float(value) == number


functions = st.sampled_from(["sin", "cos", "tan", "atan", "exp", "abs"])


def _calls(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(functions, parts).map(lambda p: f"{p[0]}({p[1]})"),
        st.tuples(parts, st.sampled_from("+-*"), parts).map("".join).map("({})".format),
    )


@settings(deadline=None, max_examples=60)
@given(st.recursive(st.sampled_from(["0.5", "1", "2", "pi", "0.3"]), _calls, max_leaves=5))
def test_functions_are_those_of_mathematics(text):
    names = {name: getattr(math, name) for name in ("sin", "cos", "tan", "atan", "exp", "pi")}
    try:
        expected = eval(text, {"abs": abs, **names})  # noqa: S307 - text of this test's own making
        found = float(parse(text))
    except (OverflowError, ExpressionError):
        return
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)


@settings(deadline=None, max_examples=300)
@given(st.text(alphabet="0123456789.eE+-*/(), abpisncotqr^_'\"[]{}:%", max_size=40))
def test_any_text_is_read_or_refused_quickly(text):
    start = time.thread_time()
    try:
        value = parse(text, NAMES)
    except ExpressionError:
        pass
    else:
        assert value.free_symbols <= {a, b}
        assert value.is_finite is not False
    assert time.thread_time() - start < 5
