"""Reports: complete, well-formed, nothing wider than the page, names defined before their use."""

import re
from xml.etree import ElementTree

import pytest
import sympy as sp
from robots import planar, symbolic, symbolic_puma560

import moro as mr
from moro.abc import alpha1, d1, g, joint_variable, l1, q1, q2
from moro.printing.equations import Equation, rows
from moro.printing.typeset import latex, text, width
from moro.report import sections
from moro.report.page import (
    PAGE_WIDTH,
    Aligned,
    Displayed,
    Paragraph,
    Section,
    Tabular,
    paragraph,
    render,
)
from moro.report.writer import Writer


def writer(robot, page):
    return Writer(robot, robot._source, robot._collector, page)


SECTIONS = [
    "The arm",
    "Frames",
    "Jacobian",
    "Centres of mass",
    "Energies",
    "Inertia matrix",
    "Coriolis and centrifugal terms",
    "Gravity and friction",
    "Equations of motion",
]


def mixed():
    robot = symbolic([sp.pi / 2, 0, -sp.pi / 2, 0], kinds="rrpr", convention="mdh")
    robot.rotor_inertias = sp.symbols("J1:5")
    robot.viscous_friction = sp.symbols("b1:5")
    return robot


def twisted():
    """A symbolic twist, a prismatic joint, sines that must be written out."""
    robot = mr.Robot((l1, alpha1, d1, q1), (0, 0, q2, 0, "p"))
    robot.masses, robot.inertia_tensors = [sp.Symbol("c_1"), sp.Symbol("s_2")], None
    robot.cm_positions, robot.gravity = [[0, 0, 0], [l1, 0, 0]], [0, 0, -g]
    return robot


def ten():
    robot = mr.Robot(*((0, 0, joint_variable(i), 0, "p") for i in range(1, 11)))
    robot.masses, robot.cm_positions = None, [[0, 0, 0]] * 10
    robot.inertia_tensors, robot.gravity = [sp.zeros(3, 3)] * 10, [0, 0, -g]
    return robot


ARMS = {
    "planar": lambda: planar(2),
    "puma560": lambda: mr.load("puma560"),
    "stanford_arm": lambda: mr.load("stanford_arm"),
    "symbolic_puma560": symbolic_puma560,
    "mixed": mixed,
    "twisted": twisted,
    "ten": ten,
}


@pytest.fixture(scope="module", params=ARMS)
def arm(request):
    return ARMS[request.param]()


def environments(tex):
    """Return the environments, checking that they are nested well."""
    found, opened = [], []
    for kind, name in re.findall(r"\\(begin|end)\{(\w+\*?)\}", tex):
        if kind == "begin":
            opened.append(name)
            found.append(name)
        else:
            assert opened.pop() == name
    assert opened == []
    return found


def blocks(robot, page):
    return [block for section in sections(writer(robot, page)) for block in section.blocks]


@pytest.mark.parametrize("kind", ["tex", "html"])
def test_nothing_is_wider_than_the_page(arm, kind):
    page = PAGE_WIDTH[kind]
    for block in blocks(arm, page):
        if isinstance(block, Aligned):
            lefts = max(width(equation.left) for equation in block.equations)
            assert lefts < page / 3
            for row in rows(block.equations, page):
                assert lefts + row.line.width < page
        elif isinstance(block, Displayed):
            assert width(block.formula) <= page
        elif isinstance(block, Tabular):
            assert block.width <= page
            assert {len(row) for row in block.rows} == {len(block.rows[0])}


def test_latex_is_well_formed(arm):
    tex = arm.report("tex")
    assert environments(tex)[0] == "document"
    assert "$$" not in tex
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", tex):
        depth += 1 if brace == "{" else -1
        assert depth >= 0
    assert depth == 0
    for body in re.findall(r"\\begin\{align\*\}\n(.*?)\n\\end", tex, re.DOTALL):
        lines = body.split(" \\\\\n")
        assert all(len(re.findall(r"(?<!\\)&", _outside_matrices(x))) == 1 for x in lines)
        assert not any("\n\n" in line or line.strip() == "" for line in lines)
        assert len(lines) <= 120


def _outside_matrices(line):
    return re.sub(r"\\begin\{bmatrix\}.*?\\end\{bmatrix\}", "", line)


def test_html_is_well_formed_and_needs_nothing_else(arm):
    html = arm.report("html")
    root = ElementTree.fromstring(html.replace("<!DOCTYPE html>", ""))  # noqa: S314 - our own
    assert [x.text for x in root.iter("h2") if x.text != "Constants"] == SECTIONS
    assert not re.search(r"(src|href|url|import)\s*[=(]", html)
    assert not list(root.iter("script"))
    known = {"math", "mrow", "mi", "mn", "mo", "mtext", "mspace", "msub", "msup", "msubsup"}
    known |= {"mfrac", "msqrt", "mover", "mtable", "mtr", "mtd"}
    inside = {element.tag for math in root.iter("math") for element in math.iter()}
    assert inside <= known
    counts = {"msub": 2, "msup": 2, "mover": 2, "mfrac": 2, "msubsup": 3}
    for element in root.iter():
        assert len(element) == counts.get(element.tag, len(element))


def test_names_are_defined_once_and_before_they_are_used(arm):
    defined, used = [], set()
    names = re.compile(r"(?:k|\\gamma )_\{\d+\}")
    for section in sections(writer(arm, PAGE_WIDTH["tex"]))[4:]:
        for block in section.blocks:
            for equation in block.equations if isinstance(block, Aligned) else ():
                found = set(names.findall(latex(equation.right)))
                assert found <= set(defined)
                used |= found
                defined += names.findall(latex(equation.left))
    assert len(defined) == len(set(defined))
    assert set(defined) == used


def test_christoffel_symbols_are_defined_before_they_are_used():
    (section,) = (
        x for x in sections(writer(symbolic_puma560(), 46.0)) if x.title.startswith("Coriolis")
    )
    symbols, entries = (x for x in section.blocks if isinstance(x, Aligned))
    triple = re.compile(r"c_\{(\d\d\d)\}")
    defined = []
    for equation in symbols.equations:
        assert set(triple.findall(latex(equation.right))) <= set(defined)
        defined += triple.findall(latex(equation.left))
    used = {x for equation in entries.equations for x in triple.findall(latex(equation.right))}
    assert used == set(defined)
    assert len(defined) == len(set(defined))


def test_planar_arm_is_the_page_of_the_textbook():
    tex = planar(2).report("tex").replace(r"\,", " ")
    assert r"1 & 0 & 0\\" not in tex
    assert (
        r"M=\begin{bmatrix} m_{1} l_{c1}^{2}+m_{2} (l_{1}^{2}+l_{c2}^{2}+2 l_{1} l_{c2} c_{2})"
        r"+I_{z_{1}z_{1}}+I_{z_{2}z_{2}} & m_{2} l_{c2} (l_{c2}+l_{1} c_{2})+I_{z_{2}z_{2}}"
    ) in tex
    assert (
        r"C=\begin{bmatrix} -m_{2} l_{1} l_{c2} s_{2} \dot{q}_{2} & "
        r"-m_{2} l_{1} l_{c2} s_{2} (\dot{q}_{1}+\dot{q}_{2}) \\ "
        r"m_{2} l_{1} l_{c2} s_{2} \dot{q}_{1} & 0 \end{bmatrix}"
    ) in tex
    assert r"\tau_{2} &= (m_{2} l_{c2} (l_{c2}+l_{1} c_{2})+I_{z_{2}z_{2}}) \ddot{q}_{1}" in tex
    assert r"P_{1} &= m_{1} g l_{c1} s_{1}" in tex
    assert "Constants" not in tex
    assert "(t)" not in tex


def test_every_entry_of_the_symbolic_puma_is_there():
    tex = symbolic_puma560().report("tex")
    for i in range(1, 7):
        assert rf"\tau_{{{i}}} &=" in tex
        for j in range(i, 7):
            assert rf"M_{{{i}{j}}} &=" in tex
    assert "k_{68} &=" in tex
    assert "K &= \\tfrac{1}{2}\\dot{q}^{T}M\\dot{q}" in tex


@pytest.mark.sweep
def test_too_long_for_paper_is_said():
    tex = mr.load("panda").report("tex")
    assert "too long to print" in tex
    assert "M_{77} &=" in tex


def test_friction_and_rotors_have_their_places():
    tex = mixed().report("tex")
    assert "rotor inertias on its diagonal" in tex
    assert r"F_{1} &= b_{1}\,\dot{q}_{1}" in tex
    assert r"$M\ddot{q}+C\dot{q}+G+F=\tau $" in tex
    assert "Rotor inertia $I_{r_{i}}$" in tex


def test_modified_rows_are_those_of_the_link_before():
    assert r"\alpha_{i-1}" in mixed().report("tex")
    assert r"\alpha_{i}" in planar(2).report("tex")


def test_sines_are_written_out_where_symbols_look_alike():
    tex = twisted().report("tex")
    assert r"\sin (q_{1})" in tex
    assert "abbreviated" not in tex


def test_numbers_that_are_rounded_are_announced():
    assert "rounded to 5 digits" in mr.load("puma560").report("html")
    assert "rounded" not in planar(2).report("html")


def test_only_kinematics_is_known():
    robot = mr.Robot((l1, 0, 0, q1))
    tex = robot.report("tex")
    assert "Not derived, because these are not set: masses, cm\\_positions" in tex
    assert "T_{10}=" in tex
    assert "Centres of mass" not in tex


def test_plain_symbols_have_no_dynamics():
    robot = mr.Robot((l1, 0, 0, sp.Symbol("q1")))
    robot.masses, robot.cm_positions = None, [[0, 0, 0]]
    robot.inertia_tensors, robot.gravity = None, [0, -g, 0]
    assert "plain symbol has no velocity" in robot.report("html")


def test_names_cannot_break_the_page():
    robot = planar(2)
    robot.name = "50% <b>&\n\\end{document} $x_1"
    tex, html = robot.report("tex"), robot.report("html")
    assert environments(tex)[0] == "document"
    assert tex.splitlines()[0].startswith("% ")
    assert tex.splitlines()[1].startswith(r"\documentclass")
    assert r"50\% <b>\& \textbackslash{}end\{document\} \$x\_1" in tex
    root = ElementTree.fromstring(html.replace("<!DOCTYPE html>", ""))  # noqa: S314 - our own
    assert not list(root.iter("b"))


def test_writes_the_file(tmp_path):
    path = tmp_path / "arm.html"
    page = planar(2).report("html", path)
    assert path.read_text(encoding="utf-8") == page
    assert page == planar(2).report("html", str(path))


@pytest.mark.parametrize("kind", ["pdf", "", None, "TEX"])
def test_other_formats_are_refused(kind, tmp_path):
    with pytest.raises(ValueError, match='a report is "tex" or "html"'):
        planar(2).report(kind, tmp_path / "x")
    assert not list(tmp_path.iterdir())


def test_wide_cells_of_a_table_stand_below_it():
    robot = planar(2)
    long = sp.Add(*sp.symbols("x_1:40"))
    robot.inertia_tensors = [sp.diag(1, 2, 3), sp.diag(4, long, 5)]
    found = blocks(robot, 46.0)
    table, words, where = (found[i] for i in _after(found, "Inertia tensors ", 3))
    assert isinstance(table, Tabular)
    assert [latex(x) for x in table.rows[1]] == ["1", "1", "2", "3"]
    assert [latex(x) for x in table.rows[2]] == ["2", "4", "I_{2,yy}", "5"]
    assert words.parts == ["Here"]
    (equation,) = where.equations
    assert latex(equation.left) == "I_{2,yy}"
    assert "x_{39}" in latex(equation.right)


def test_tables_of_words_become_lists():
    narrow = writer(planar(2), 20.0)
    lines = [[text(str(i))] for i in (1, 2)]
    found = list(narrow.table(["i", [text("words")]], [[x, [text("long" * 20)]] for x in lines]))
    assert [type(x) for x in found] == [Paragraph, Aligned] * 2


def test_rows_before_have_their_numbers():
    robot = mr.Robot((l1, 0, d1, q1), (sp.Add(*sp.symbols("x_1:40")), 0, 0, q2), convention="mdh")
    tex = robot.report("tex")
    assert r"2 & a_{1} & 0" in tex.replace("$", "")
    assert r"a_{1} &= x_{1}+x_{2}" in tex


def test_only_limits_that_are_given_are_shown():
    robot = mr.Robot((l1, 0, 0, q1), (0, 0, q2, 0, "p"))
    assert "limits" not in robot.report("tex")
    assert "1000" not in robot.report("tex")
    robot.joint_limits = [(0, 1), None]
    tex = robot.report("tex")
    assert r"0\le q_{1}\le 1" in tex.replace(r"\le ", r"\le ")
    assert r"\text{not given}" in tex
    assert "1000" not in tex


def _after(found, words, count):
    start = next(i for i, x in enumerate(found) if isinstance(x, Paragraph) and x.parts[0] == words)
    return range(start + 1, start + 1 + count)


def test_report_is_a_function_of_the_arm():
    assert mixed().report("tex") == mixed().report("tex")


def test_blocks_on_a_page():
    equation = Equation([text("left")], [text("a < b")])
    content = [paragraph("x & $y_1$"), Aligned([equation])]
    page = render("T", [Section("S & T", content)], "html")
    assert "<h2>S &amp; T</h2>" in page
    assert "x &amp; <math><msub><mi>y</mi>" in page
    assert "<mtext>a &lt; b</mtext>" in page
