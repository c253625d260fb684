"""Formulas: the notation of the texts, in LaTeX and MathML, and lines of bounded width."""

import random
import re
from xml.etree import ElementTree

import pytest
import sympy as sp
from robots import planar

from moro.abc import alpha1, l1, lc1, m1, q1, q2, q3, t
from moro.printing.markup import markup
from moro.printing.notation import Notation
from moro.printing.typeset import broken, latex, letter, mathml, matrix, text, width

QS = [q1, q2, q3]
qd1, qd2 = q1.diff(t), q2.diff(t)
half = sp.Rational(1, 2)


def written(expr, **options):
    return latex(Notation(QS, **options).formula(expr)).replace(r"\,", " ")


def xml(formula):
    return ElementTree.fromstring(f"<math>{mathml(formula)}</math>")  # noqa: S314 - our own


@pytest.mark.parametrize(
    ("expr", "code"),
    [
        (sp.sin(q2 + q3), "s_{23}"),
        (sp.cos(q1) ** 2, "c_{1}^{2}"),
        (sp.sin(q1 - q2), r"\sin (q_{1}-q_{2})"),
        (sp.cos(q1 + 1), r"\cos (1+q_{1})"),
        (sp.cos(alpha1) ** 2, r"c_{\alpha_{1}}^{2}"),
        (sp.cos(2 * alpha1) ** 2, r"\cos^{2}(2 \alpha_{1})"),
        (qd1**2, r"\dot{q}_{1}^{2}"),
        (q1.diff(t, 2), r"\ddot{q}_{1}"),
        (sp.sign(qd1), r"\operatorname{sign}(\dot{q}_{1})"),
        (half * m1 * lc1**2 * qd1**2, r"\tfrac{1}{2} m_{1} l_{c1}^{2} \dot{q}_{1}^{2}"),
        (-l1 * sp.sin(q1), "-l_{1} s_{1}"),
        ((qd1 + qd2) * sp.sin(q2) * l1, r"l_{1} s_{2} (\dot{q}_{1}+\dot{q}_{2})"),
        (sp.pi / 2, r"\tfrac{\pi }{2}"),
        (-170 * sp.pi / 180, r"-\tfrac{17}{18} \pi "),
        (q1 + sp.pi / 180, r"\tfrac{\pi }{180}+q_{1}"),
        (-sp.sqrt(3) / 2, r"-\tfrac{\sqrt{3}}{2}"),
        (m1 / l1, r"\tfrac{m_{1}}{l_{1}}"),
        (1 / q1**2, r"\tfrac{1}{q_{1}^{2}}"),
        (sp.sqrt(l1) * m1, r"m_{1} \sqrt{l_{1}}"),
        (sp.exp(q1), "e^{q_{1}}"),
        ((q1 + 1) ** 2, "(1+q_{1})^{2}"),
        (sp.Integer(0), "0"),
        (sp.Integer(-3), "-3"),
        (sp.Symbol("x") ** -half, r"\tfrac{1}{\sqrt{x}}"),
        (sp.atan2(q1, l1), r"\operatorname{atan2}(q_{1},l_{1})"),
    ],
)
def test_writes_as_the_texts_do(expr, code):
    assert written(expr) == code
    xml(Notation(QS).formula(expr))


@pytest.mark.parametrize(
    ("number", "code", "rounded"),
    [
        ("0.4318", "0.4318", False),
        ("17.4", "17.4", False),
        ("0.5", "0.5", False),
        ("0.0000431", r"4.31\cdot 10^{-5}", False),
        ("1234567.25", r"1.2346\cdot 10^{6}", True),
        ("1/3", r"\tfrac{1}{3}", False),
        ("1/7919", "0.00012628", True),
    ],
)
def test_decimals(number, code, rounded):
    notation = Notation(decimals=True)
    assert latex(notation.formula(sp.Rational(number))) == code
    assert notation.rounded == rounded


def test_fractions_without_decimals():
    assert written(sp.Rational(7, 5) * l1) == r"\tfrac{7}{5} l_{1}"
    assert written(sp.Rational(1, 100)) == "0.01"


def test_terms_have_the_order_of_the_texts():
    I1, I2, k2, k10 = sp.symbols("I_1 I_2 k_2 k_10")
    assert written(I1 + I2 + m1 * lc1**2) == "m_{1} l_{c1}^{2}+I_{1}+I_{2}"
    assert written(k10 * sp.sin(q1) + k2 * sp.cos(q2) + k10) == "k_{10}+k_{2} c_{2}+k_{10} s_{1}"
    equation = l1 + qd2 * qd1 + m1 * q2.diff(t, 2) + m1 * q1.diff(t, 2)
    assert written(equation) == (
        r"m_{1} \ddot{q}_{1}+m_{1} \ddot{q}_{2}+\dot{q}_{1} \dot{q}_{2}+l_{1}"
    )


def test_sums_start_with_a_positive_term():
    assert written(sp.sin(q2) - sp.cos(q1)) == "s_{2}-c_{1}"
    assert written(l1 * (sp.sin(q2) - sp.cos(q1))) == "l_{1} (s_{2}-c_{1})"
    assert written(-sp.sin(q2) - sp.cos(q1)) == "-c_{1}-s_{2}"


def test_sines_are_written_out_where_the_model_has_such_symbols():
    assert written(sp.sin(q1 + q2), symbols=[sp.Symbol("s_1")]) == r"\sin (q_{1}+q_{2})"
    assert written(sp.cos(q2), symbols=[sp.Symbol("c2")]) == r"\cos (q_{2})"
    assert written(sp.cos(q2), symbols=[sp.Symbol("c")]) == "c_{2}"


def test_indices_beyond_nine_stand_apart():
    qs = [sp.Function(f"q_{i}")(t) for i in range(1, 12)]
    assert latex(Notation(qs).formula(sp.sin(qs[9] + qs[10]))) == "s_{10,11}"


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("I_{x_1x_1}", "I_{x_{1}x_{1}}"),
        ("I_xx6", "I_{xx6}"),
        ("J1", "J_{1}"),
        ("lc_12", "l_{c12}"),
        ("l_c12", "l_{c12}"),
        ("theta_1", r"\theta_{1}"),
        ("θ_1", r"\theta_{1}"),
        ("Alpha", "A"),
        ("payload", r"\mathit{payload}"),
        ("payload_mass", r"\mathit{payload}_{\text{mass}}"),
        ("100%_{", r"\text{100\%\_\{}"),
        ("a$b\n\\end{document}", r"\text{a\$b \textbackslash{}end\{document\}}"),
        ("質量", r"\text{[U+8CEA][U+91CF]}"),
        ("<script>", r"\text{<script>}"),
    ],
)
def test_names_of_symbols(name, code):
    formula = Notation().formula(sp.Symbol(name))
    assert latex(formula).strip() == code
    assert "<script>" not in mathml(formula)
    xml(formula)


def test_what_has_no_notation_is_text():
    assert written(sp.Piecewise((1, q1 > 0), (2, True))).startswith(r"\text{Piecewise")
    xml(Notation().formula(sp.Piecewise((1, q1 > 0), (2, True))))


def test_matrices():
    notation = Notation(QS)
    assert notation.latex(sp.Matrix([[q1, 0]])) == r"\begin{bmatrix} q_{1} & 0 \end{bmatrix}"
    box = matrix([[notation.formula(q1), notation.formula(l1)]])
    assert len(list(xml([box]).iter("mtd"))) == 2


def test_markup():
    assert latex(markup(r"K_i = \frac{1}{2} \dot{q}^T M \dot{q}")) == (
        r"K_{i}=\tfrac{1}{2}\dot{q}^{T}M\dot{q}"
    )
    assert latex(markup("r_{C_i}")) == "r_{C_{i}}"
    assert latex(markup("T^{i-1}_i")) == "T_{i}^{i-1}"
    root = xml(markup(r"\ddot{q}_1 + \alpha \times 2.5 \le \sum_i x"))
    assert "".join(root.itertext()) == "q¨1+α×2.5≤∑ix"


@pytest.mark.parametrize("source", [r"\evil", "}", "a_", "{a", "a&b", "x_{1", r"\dot{}", "_1"])
def test_markup_refuses_what_it_does_not_know(source):
    with pytest.raises(ValueError, match=r"not known|counterpart|missing|nothing"):
        markup(source)


# -- lines ----------------------------------------------------------------------------------------


def random_sum(rng, depth=2):
    if depth == 0:
        return rng.choice([l1, m1, sp.sin(q1), sp.cos(q2 + q3), qd1, sp.Integer(7)])
    return sp.Add(
        *(
            rng.choice([-2, -1, 1, 3]) * random_sum(rng, depth - 1) * random_sum(rng, depth - 1)
            for _ in range(rng.randint(1, 7))
        )
    )


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("limit", [20.0, 46.0])
def test_lines_keep_everything_and_stay_in_bounds(seed, limit):
    formula = Notation(QS).formula(random_sum(random.Random(seed), 3))
    lines = broken(formula, limit)
    assert all(line.width <= limit for line in lines)
    assert len(lines) <= 3 + 2 * width(formula) / (limit - 6)
    joined = "".join(latex(line.boxes) for line in lines)
    assert joined.replace("{}", "").replace(r"\cdot ", r"\,") == latex(formula)
    for line in lines:
        xml(line.boxes)


def test_breaks_between_terms_before_breaks_in_brackets():
    x = sp.symbols("x_1:7")
    formula = Notation().formula(x[0] * (x[1] + x[2]) - x[3] * (x[4] + x[5]))
    first, second = broken(formula, 10.0)
    assert latex(first.boxes) == r"x_{1}\,(x_{2}+x_{3})"
    assert latex(second.boxes) == r"{}-x_{4}\,(x_{5}+x_{6})"
    assert second.indent > 0


def test_long_products_break_with_a_dot():
    product = sp.Mul(*sp.symbols("x_1:30"))
    lines = broken(Notation().formula(product), 15.0)
    assert len(lines) > 1
    assert all(re.match(r"\{\}\\cdot x", latex(line.boxes)) for line in lines[1:])


def test_what_cannot_be_broken_stays_whole():
    formula = [text("x" * 100)]
    (line,) = broken(formula, 10.0)
    assert line.boxes == formula


def test_letters_know_greek():
    assert letter("omega").latex == r"\omega "
    assert letter("omega").mathml == "<mi>ω</mi>"
    assert letter("Chi").latex == "X"


def test_robot_writes_expressions_in_the_notation():
    robot = planar(2)
    assert robot.latex(sp.cos(robot.q(1) + robot.q(2))) == "c_{12}"
    assert r"\begin{bmatrix} k" not in robot.latex(robot.gravity_vector())
    assert robot.latex(robot.T).startswith(r"\begin{bmatrix} c_{12} & -s_{12} & 0")
