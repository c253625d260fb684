"""Tables in text, LaTeX and HTML."""

from xml.etree import ElementTree

import pytest
import sympy as sp

import moro as mr
from moro.abc import l1, q1
from moro.printing.tables import Table


@pytest.fixture
def table():
    return Table(("i", "alpha", "state"), [(1, sp.pi / 2, "a & b < c"), (2, l1 * sp.cos(q1), "x")])


def test_text(table):
    assert repr(table).splitlines() == [
        "i  alpha            state",
        "-  ---------------  ---------",
        "1  pi/2             a & b < c",
        "2  l_1*cos(q_1(t))  x",
    ]


def test_rows_are_values(table):
    assert len(table) == 2
    assert table[0] == (1, sp.pi / 2, "a & b < c")
    assert [row[0] for row in table] == [1, 2]


def test_latex(table):
    code = table.latex()
    assert code.startswith(r"\begin{array}{ccc} i & \alpha  & \text{state} \\ \hline 1 & ")
    assert r"\text{a \& b < c}" in code
    assert code.count(r"\\") == 2
    assert table._repr_latex_() == f"$\\displaystyle {code}$"


def test_html(table):
    for code in (table.html(), table._repr_html_()):
        root = ElementTree.fromstring(code)  # noqa: S314 - our own
        assert [len(row) for row in root.iter("tr")] == [3, 3, 3]
        assert "a & b < c" in "".join(root.itertext())
        assert "<mfrac>" in code
        assert "<mi>α</mi>" in code
        assert "$" not in code  # columns hold where no script comes to typeset them


def test_wide_cells_are_broken_into_lines():
    table = Table(("x",), [(sp.Add(*sp.symbols("x_1:60")),)])
    assert table.html().count("<br/>") >= 2


def test_entries_and_words_as_they_are_printed(table):
    assert table.shape == (3, 3)
    assert (table[0, 1], table[1, 1], table[2, 0]) == ("alpha", sp.pi / 2, 2)
    assert "alpha" in table
    assert "pi/2" in table
    assert "beta" not in table
    assert (1, sp.pi / 2, "a & b < c") in table


def test_text_has_numbers_in_order():
    k2, k10 = sp.symbols("k_2 k_10")
    rows = [(k10 * sp.sin(q1) + k2,), (sp.cos(k10) + 1,)]
    assert repr(Table(("x",), rows)).splitlines()[2:] == ["k_2 + k_10*sin(q_1(t))", "cos(k_10) + 1"]


def test_robots_print_their_rows():
    robot = mr.load("puma560")
    assert "0.4318" in robot._repr_latex_()
    assert "q_{1}" in robot._repr_latex_()
    assert robot._repr_latex_() == robot.dh_table._repr_latex_()
    assert r"(t)" not in robot._repr_latex_().replace("left", "").replace(" ", "")


def test_summary_prints_text():
    summary = mr.load("two_link").model_summary()
    assert r"\text{cm\_positions}" in summary.latex()
    ElementTree.fromstring(summary._repr_html_())  # noqa: S314 - our own
