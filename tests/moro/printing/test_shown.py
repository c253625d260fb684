"""What Jupyter and the printers show: equations, the matrix form, the regressor, reports."""

import re
from xml.etree import ElementTree

import pytest
import sympy as sp
from robots import planar

import moro as mr
from moro.abc import joint_variable, q1, q2, symbol, t


def xml(code):
    return ElementTree.fromstring(code)  # noqa: S314 - our own


def single(friction=False):
    robot = planar(1)
    robot.viscous_friction = [symbol("b", 1)] if friction else None
    return robot


def drawn(expr):
    """Return the middle line of what SymPy draws in characters."""
    lines = sp.pretty(expr, wrap_line=False).splitlines()
    return next(line for line in lines if "I_{" in line)


@pytest.mark.parametrize("write", [str, sp.latex, drawn, single().latex])
def test_the_matrix_form_prints_as_the_texts_write_it(write):
    """M qdd + C qd + G + friction = tau: each block by what only it has."""
    text = write(single(friction=True).dynamic_model_matrix_form())
    places = [re.search(x, text).start() for x in ("I_", r"\bg[ *⋅\\]", "b[_₁]", "tau|τ")]
    assert places == sorted(places)


def test_the_matrix_form_is_a_sum_like_any_other():
    form = planar(2).dynamic_model_matrix_form()
    M, C, G = planar(2).inertia_matrix(), planar(2).coriolis_matrix(), planar(2).gravity_vector()
    qd, qdd = (sp.Matrix([q1.diff(t, k), q2.diff(t, k)]) for k in (1, 2))
    assert form.lhs.doit() == M * qdd + C * qd + G
    assert form.lhs.subs(q1, 0).args[0] == sp.MatMul(M.subs(q1, 0), qdd.subs(q1, 0))
    assert list(form.rhs) == [symbol("tau", 1), symbol("tau", 2)]


def test_equations_of_motion_show_as_formulas():
    robot = planar(2)
    for equations in (robot.dynamic_model(), robot.dynamic_model(collect=True).equations):
        assert equations == list(equations)
        assert len(equations) == 2
        assert r"\tau_{2} &= " in equations._repr_latex_()
        assert "<mi>τ</mi>" in equations._repr_html_()
        xml(equations._repr_html_())
    assert robot.euler_lagrange_equations() == robot.dynamic_model()
    assert robot.euler_lagrange_equations(collect=True).equations == equations


def test_a_regressor_shows_as_formulas():
    Y, p = regressor = planar(2).regressor()
    assert (regressor.Y, regressor.p) == (Y, p) == tuple(regressor)
    assert r"Y &= \begin{bmatrix} \ddot{q}_{1} & g\,c_{1} & " in regressor.latex()
    assert r"p &= \begin{bmatrix}" in regressor.latex()
    xml(regressor._repr_html_())
    wide = planar(3).regressor()
    assert r"Y_{11} &= \ddot{q}_{1} \\" in wide.latex()
    assert "Y_{21}" not in wide.latex()


def test_what_is_too_long_for_a_notebook_is_plain_text():
    puma = mr.load("puma560").regressor()
    assert puma._repr_latex_() is None
    assert "Y" in puma._repr_html_()


def test_a_report_shows_in_a_frame_of_its_own(tmp_path):
    page = planar(1).report("html", tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page
    frame = xml(page._repr_html_())
    assert frame.tag == "iframe"
    assert frame.get("srcdoc").split() == page.split()
    assert not hasattr(planar(1).report("tex"), "_repr_html_")


def test_a_summary_lists_vectors_as_they_are_given():
    robot = planar(2)
    robot.cm_positions = [[0, 0, 1], [0, 0, 2]]
    summary = {row[0]: row[2] for row in robot.model_summary()}
    assert summary["cm_positions"] == "[[0, 0, 1], [0, 0, 2]]"
    assert summary["gravity"] == "[0, -g, 0]"
    assert "masses" in robot.model_summary()
    assert "nothing" not in robot.model_summary()


def test_symbols_are_in_the_order_of_their_numbers():
    robot = planar(11)
    names = [str(x) for x in robot.parameters if str(x).startswith("m_")]
    assert names == [f"m_{i}" for i in range(1, 12)]
    slides = mr.Robot(*((0, 0, joint_variable(i), 0, "p") for i in range(1, 12)))
    slides.masses, slides.cm_positions = None, [[0, 0, 0]] * 11
    slides.inertia_tensors = [sp.zeros(3, 3)] * 11
    assert "= m_8 + m_9 + m_10 + m_11\n" in str(slides.inertia_matrix(collect=True))


def test_numbers_of_a_table_are_in_one_style():
    """4*MZ_5/5 never stands beside 0.16*M_5."""
    for name in ("panda", "puma560", "stanford_arm"):
        text = repr(mr.load(name).base_parameters())
        assert re.search(r"\d\.\d", text)
        assert not re.search(r"/(2|4|5|8|10)\b", text)
    halves = planar(1)
    halves.masses = [sp.Rational(1, 2)]
    assert "/2" in repr(halves.base_parameters())
