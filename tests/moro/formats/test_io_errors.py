"""Bad robot files: each gets an error that names file, line and field, found and expected."""

from __future__ import annotations

import time
import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from moro import load
from moro.formats.loading import Problem, RobotFileError, RobotFileWarning, read
from moro.formats.yaml.document import MAX_SIZE

#: a good file, whose lines the tests below change one at a time
ARM = """\
name: arm
convention: dh
gravity: [0, 0, -9.81]
parameters: {m_tool: 2.5}
links:
  - joint: revolute
    a: 0.5
    alpha: pi/2
    d: 0
    theta: 0
    mass: m_tool
    com: [0, 0, 0.1]
    inertia: [1, 1, 1]
    rotor_inertia: 0.1
    friction: {viscous: 0.1, coulomb: [0.2, 0.3]}
    limits: [-pi, pi]
"""


@pytest.fixture
def errors_of(tmp_path):
    def errors_of(content: str | bytes) -> list[Problem]:
        path = tmp_path / "arm.yaml"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        with pytest.raises(RobotFileError) as caught:
            load(path)
        error = caught.value
        assert isinstance(error, ValueError)
        assert error.path == str(path)
        assert str(error).startswith(f"{path}:")
        for problem in error.problems[:20]:
            assert problem.at(str(path)) in str(error).splitlines()
        return error.problems

    return errors_of


def changed(field: str, value: str | None) -> str:
    """Return ARM with another value for a field; None removes its line."""
    lines = ARM.splitlines()
    (i,) = (i for i, line in enumerate(lines) if line.lstrip(" -").startswith(f"{field}:"))
    before = lines[i].partition(f"{field}:")[0]
    lines[i : i + 1] = [] if value is None else [f"{before}{field}: {value}"]
    return "\n".join(lines) + "\n"


def test_the_arm_that_is_changed_is_good(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(ARM)
    assert load(path).dof == 1


# --- one wrong value -----------------------------------------------------------------------------

NUMBER = "expected a number or an expression"

WRONG_VALUES = [
    # not a number
    (
        "mass",
        "true",
        11,
        "links[1].mass",
        f"found `true`, which YAML takes for a truth value; {NUMBER}",
    ),
    ("mass", "no", 11, "links[1].mass", "found `no`, which YAML takes for a truth value"),
    ("mass", "", 11, "links[1].mass", f"found nothing; {NUMBER}"),
    ("mass", "~", 11, "links[1].mass", f"found nothing; {NUMBER}"),
    ("mass", "[1]", 11, "links[1].mass", f"found a list of 1 value; {NUMBER}"),
    ("mass", "{kg: 1}", 11, "links[1].mass", f"found a mapping; {NUMBER}"),
    ("mass", "heavy", 11, "links[1].mass", "`heavy` is not a number, `pi` or a declared parameter"),
    ("mass", "m_tol", 11, "links[1].mass", "did you mean `m_tool`?"),
    ("mass", "1,5", 11, "links[1].mass", "decimals have a point: `1.5`"),
    ("mass", "1.5 kg", 11, "links[1].mass", "values are in SI units"),
    ("mass", "1:30", 11, "links[1].mass", "a value is one number, without `:`"),
    ("mass", "0x1F", 11, "links[1].mass", "`x1F` is not expected"),
    ("mass", "2001-01-01", 11, "links[1].mass", "no zeros in front"),
    ("mass", "sqrt(-1)", 11, "links[1].mass", "`sqrt(-1)` is not a real number"),
    ("mass", ".nan", 11, "links[1].mass", "not a finite number"),
    ("mass", "nan", 11, "links[1].mass", "not a finite number"),
    ("mass", ".inf", 11, "links[1].mass", "not a finite number"),
    ("mass", "1e400", 11, "links[1].mass", "beyond 1e-300..1e300"),
    ("mass", "1/0", 11, "links[1].mass", "`1/0` divides by zero"),
    ("mass", "9**9**9", 11, "links[1].mass", "an exponent is at most 32"),
    ("mass", "open('x')", 11, "links[1].mass", "not text"),
    ("mass", "open(1)", 11, "links[1].mass", "`open` is not a function that may be used"),
    ("mass", "!!python/object:os.system x", 11, "links[1].mass", "tags such as"),
    ("mass", "!!float 1", 11, "links[1].mass", "tags such as `!!float` are not read"),
    ("mass", "1+" * 600 + "1", 11, "links[1].mass", "at most 1000 are read"),
    ("a", "q1", 7, "links[1].a", "a joint variable, which only `theta` of a joint that turns"),
    ("theta", "q2", 10, "links[1].theta", "there can be `q1` to `q1`, one for each joint"),
    ("theta", "q1**2", 10, "links[1].theta", "must be a sum of joint variables, each times"),
    ("theta", "t", 10, "links[1].theta", "`t` stands for time"),
    ("alpha", "pi/2 rad", 8, "links[1].alpha", "angles in radians"),
    ("alpha", "90°", 8, "links[1].alpha", "90 degrees are `pi/2`"),
    # out of range
    ("mass", "-1", 11, "links[1].mass", "must not be negative, not -1"),
    ("mass", "sqrt(2) - 2", 11, "links[1].mass", "must not be negative, not -2 + sqrt(2)"),
    ("rotor_inertia", "-0.1", 14, "links[1].rotor_inertia", "must not be negative, not -0.1"),
    ("friction", "{viscous: -1}", 15, "links[1].friction.viscous", "must not be negative, not -1"),
    ("friction", "{coulomb: -1}", 15, "links[1].friction.coulomb", "must not be negative, not -1"),
    (
        "friction",
        "{coulomb: [1, -2]}",
        15,
        "links[1].friction.coulomb[2]",
        "must not be negative, not -2",
    ),
    ("limits", "[1, -1]", 16, "links[1].limits", "must be (lower, upper), but 1 > -1"),
    ("limits", "[-.inf, 1]", 16, "links[1].limits[1]", "not a finite number"),
    ("limits", "[0, m_tool]", 16, "links[1].limits", "must be a number, not m_tool"),
    # wrong shape
    ("com", "[0, 0]", 12, "links[1].com", "found a list of 2 values; expected [x, y, z]"),
    ("com", "0", 12, "links[1].com", "found `0`; expected [x, y, z]"),
    ("com", "[0 0 1]", 12, "links[1].com", "separate the values by commas, [0, 0, 1]"),
    ("com", "[0, x, 0]", 12, "links[1].com[2]", "`x` is not a number"),
    ("com", "[0, [1], 0]", 12, "links[1].com[2]", f"found a list of 1 value; {NUMBER}"),
    ("com", "[atan2(1, 2), 0]", 12, "links[1].com[1]", "needs quotes around it"),
    ("gravity", "9.81", 3, "gravity", "expected [x, y, z] in m/s^2"),
    ("gravity", "[0, 0, g]", 3, "gravity[3]", "`g` is not a number"),
    (
        "inertia",
        "[1, 1]",
        13,
        "links[1].inertia",
        "found a list of 2 values; expected [Ixx, Iyy, Izz]",
    ),
    ("inertia", "[]", 13, "links[1].inertia", "found a list of 0 values; expected [Ixx"),
    ("inertia", "1", 13, "links[1].inertia", "found `1`; expected [Ixx, Iyy, Izz]"),
    ("inertia", "[1, [1], 1]", 13, "links[1].inertia", "mixes rows and numbers"),
    (
        "inertia",
        "[[1,0,0],[0,1],[0,0,1]]",
        13,
        "links[1].inertia",
        "found a row that is a list of 2",
    ),
    ("inertia", "[[1,0,0],[0,x,0],[0,0,1]]", 13, "links[1].inertia[2][2]", "`x` is not a number"),
    (
        "inertia",
        "[[1,2,0],[3,1,0],[0,0,1]]",
        13,
        "links[1].inertia",
        "must be symmetric: entry 1,2 is 2",
    ),
    ("inertia", "[[1,0.1,0],[0.1001,1,0],[0,0,1]]", 13, "links[1].inertia", "entry 2,1 is 0.1001"),
    ("inertia", "[[1,m_tool,0],[0,1,0],[0,0,1]]", 13, "links[1].inertia", "entry 1,2 is m_tool"),
    (
        "inertia",
        "[[1,m_tool,0],[m_tool+1,1,0],[0,0,1]]",
        13,
        "links[1].inertia",
        "must be symmetric",
    ),
    ("limits", "[1]", 16, "links[1].limits", "expected [lower, upper] in rad or m"),
    ("limits", "3", 16, "links[1].limits", "found `3`; expected [lower, upper]"),
    ("friction", "3", 15, "links[1].friction", "found `3`; expected a mapping: viscous, coulomb"),
    ("friction", "{coulomb: [1, 2, 3]}", 15, "links[1].friction.coulomb", "found a list of 3"),
    ("links", "", 5, "links", "found nothing; expected a list with one entry"),
    ("parameters", "[m_tool]", 4, "parameters", "expected a mapping: `name: default value`"),
    # words
    ("joint", "rotational", 6, "links[1].joint", "or `fixed`; write `revolute`"),
    ("joint", "revolut", 6, "links[1].joint", "did you mean `revolute`?"),
    ("joint", "[revolute]", 6, "links[1].joint", "found a list of 1 value; expected `revolute`"),
    (
        "convention",
        "hd",
        2,
        "convention",
        'must be "dh" (standard) or "mdh" (modified), not \'hd\'; did you mean "dh"?',
    ),
    ("convention", "modified", 2, "convention", 'did you mean "mdh"?'),
    # names
    ("name", "ur-5e", 1, "name", "use `ur_5e`"),
    ("name", "5axis", 1, "name", "use `robot_5axis`"),
    ("name", "int", 1, "name", "keyword of C, C++ or Python; "),
    ("name", "lambda", 1, "name", "keyword of C, C++ or Python; "),
    ("name", "x" * 41, 1, "name", "has 41 characters; a name has at most 40"),
    ("name", "../../etc/passwd", 1, "name", "use `etc_passwd`"),
    ("name", "grün", 1, "name", "use `grun`"),
    ("name", "on", 1, "name", "truth value; expected a name"),
    ("name", "", 1, "name", "found nothing; expected a name"),
    ("parameters", "{m_tool: 1, pi: 3}", 4, "parameters.pi", "the number pi"),
    ("parameters", "{m_tool: 1, sin: 3}", 4, "parameters.sin", "a function"),
    ("parameters", "{m_tool: 1, t: 3}", 4, "parameters.t", "time"),
    ("parameters", "{m_tool: 1, q1: 3}", 4, "parameters.q1", "a joint variable"),
    ("parameters", "{m_tool: 1, q_12: 3}", 4, "parameters.q_12", "a joint variable"),
    ("parameters", "{m_tool: 1, m-x: 3}", 4, "parameters.m-x", "use `m_x`"),
    ("parameters", "{m_tool: 1, int: 3}", 4, "parameters.int", "use `p_int`"),
    ("parameters", "{m_tool: m_tool}", 4, "parameters.m_tool", "must be a number, not m_tool"),
    ("parameters", "{m_tool: true}", 4, "parameters.m_tool", "truth value"),
]


@pytest.mark.parametrize(("field", "value", "line", "where", "said"), WRONG_VALUES)
def test_a_wrong_value(errors_of, field, value, line, where, said):
    (problem,) = (p for p in errors_of(_without_links(field, value)) if p.field == where)
    assert problem.line == line
    assert said in problem.message


def _without_links(field: str, value: str) -> str:
    """Return the changed arm; where the value of ``links`` itself changes, without its entries."""
    text = changed(field, value)
    if field == "links":
        return "\n".join(line for line in text.splitlines() if not line.startswith(" "))
    return text


# --- fields --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "line", "field", "nearest"),
    [
        ("inertia:", "inerita:", 13, "links[1].inerita", "inertia"),
        ("gravity:", "Gravity:", 3, "Gravity", "gravity"),
        ("links:", "link:", 5, "link", "links"),
        ("viscous:", "viscos:", 15, "links[1].friction.viscos", "viscous"),
    ],
)
def test_an_unknown_field_names_the_nearest_known_one(errors_of, old, new, line, field, nearest):
    """And the field that is missing because of the typo is not reported as well."""
    problems = errors_of(ARM.replace(old, new, 1))
    assert problems == [Problem(line, field, f"unknown field; did you mean `{nearest}`?")]


def test_an_unknown_field_like_no_other_lists_the_known_ones(errors_of):
    (problem,) = errors_of("colour: red\n" + ARM)
    assert problem == Problem(
        1,
        "colour",
        "unknown field; known are name, convention, gravity, parameters, base, tool, tip,"
        " coordinates, links",
    )


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("a", "the length along x, in m"),
        ("alpha", "the angle about x, in rad"),
        ("d", "the length along z, in m"),
        ("theta", "the angle about z, in rad"),
        ("mass", "leave out mass, com and inertia for all links or for none"),
        ("com", "the centre of mass [x, y, z], in m"),
        ("inertia", "in kg m^2, about the centre of mass"),
    ],
)
def test_a_missing_field(errors_of, field, expected):
    (problem,) = errors_of(changed(field, None))
    assert (problem.line, problem.field) == (6, f"links[1].{field}")
    assert problem.message.startswith("missing; expected ")
    assert expected in problem.message


def test_missing_joint_and_links(errors_of):
    (problem,) = errors_of(ARM.replace("joint: revolute\n    a:", "a:"))
    assert problem == Problem(6, "links[1].joint", "missing; expected `revolute` or `prismatic`")
    (problem,) = errors_of("name: arm\n")
    assert (problem.line, problem.field) == (1, "links")
    assert problem.message.startswith("missing; expected a list with one entry")


def test_a_link_without_masses_among_links_with_them(errors_of):
    bare = "  - {joint: revolute, a: 0, alpha: 0, d: 0, theta: 0}\n"
    problems = errors_of(ARM + bare)
    assert [(p.line, p.field) for p in problems] == [
        (17, f"links[2].{field}") for field in ("mass", "com", "inertia")
    ]


def test_a_key_given_twice(errors_of):
    (problem,) = errors_of(ARM.replace("    d: 0\n", "    d: 0\n    a: 1\n"))
    assert problem == Problem(10, "links[1].a", "given twice; first in line 7")


@pytest.mark.parametrize("link", ["3", "", "[1, 2]", "revolute"])
def test_a_link_that_is_not_a_mapping(errors_of, link):
    (problem,) = errors_of(f"{ARM}  - {link}\n")
    assert (problem.line, problem.field) == (17, "links[2]")
    assert "expected a mapping: joint, a, alpha, d, theta" in problem.message


def test_all_errors_come_at_once_in_the_order_of_the_file(errors_of):
    text = ARM.replace("dh", "hd").replace("pi/2", "pi/0").replace("[0, 0, 0.1]", "[0, 0]")
    text = text.replace("    rotor_inertia", "    rotor").replace("    a: 0.5\n", "")
    text += "    limits: [0, 1]\n"
    problems = errors_of(text)
    assert [(p.line, p.field) for p in problems] == [
        (2, "convention"),
        (6, "links[1].a"),
        (7, "links[1].alpha"),
        (11, "links[1].com"),
        (13, "links[1].rotor"),
        (16, "links[1].limits"),
    ]


def test_very_many_errors_are_counted(errors_of, tmp_path):
    head, link = ARM.split("links:\n")
    problems = errors_of(head + "links:\n" + link.replace("a: 0.5", "a: x") * 50)
    assert len(problems) == 50
    text = str(RobotFileError("arm.yaml", problems))
    assert len(text.splitlines()) == 21
    assert text.endswith("arm.yaml: and 30 more")


def test_a_problem_inside_an_alias_is_reported_where_it_is_used(errors_of):
    problems = errors_of(
        ARM.replace("friction: {viscous: 0.1", "friction: &f {viscous: -1")
        + ARM.split("links:\n")[1].replace("{viscous: 0.1, coulomb: [0.2, 0.3]}", "*f")
    )
    assert [p.field for p in problems] == [f"links[{i}].friction.viscous" for i in (1, 2)]


# --- the whole file ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("", 1, "the file is empty"),
        ("# nothing\n", 1, "the file is empty"),
        ("---\n", 2, "expected `links:`"),
        ("[1, 2]", 1, "expected `links:`"),
        ("hello", 1, "expected `links:`"),
        ("name: a\n\tlinks: []\n", 2, "a tab; indent with spaces"),
        ("links:\n\t- joint: revolute\n", 2, "a tab; indent with spaces"),
        ("name: a\nlinks:\n  - joint: revolute\n   a: 0\n", 4, "not indented like those above"),
        ("name: a\n convention: dh\n", 2, "not indented like those above"),
        ("links:\n  - a:0\n    d: 0\n", 2, "a space is missing after `a:`"),
        ("links:\n  - d: 0\n    a:0\n", 3, "a space is missing after `a:`"),
        ("gravity: [0, 0, 1\nname: a\n", 2, "a list is not closed with `]`"),
        ("gravity: [0, 0, 1]]\n", 1, "a closing bracket without an opening one"),
        ("parameters: {g: 1\n", 2, "a mapping in braces is not closed with `}`"),
        ("name: 'arm\n", 2, "a quoted text is not closed"),
        ("name: %arm\n", 1, "needs quotes"),
        ("name: arm\nlinks\ngravity: 3\n", 3, "neither `key: value` nor the entry of a list"),
        ("name: \x00\n", 1, "the character U+0000 is not text"),
        ('name: "\\UFFFFFFFF"\n', None, "not YAML"),
        ("name: a\n---\nname: b\n", 2, "a second document starts here"),
        ("name: *x\n", 1, "`*x` repeats `&x`, which is not above it"),
        ("links: &x [*x]\n", 1, "`*x` stands inside of `&x` itself"),
        ("? [1, 2]\n: 3\n", 1, "a key is a plain name"),
        ("<<: {name: arm}\n", 1, "`<<` (merging) is not read"),
        ("links: []\n", 1, "no links; an arm has 1 to 300"),
        ("links: {joint: revolute}\n", 1, "found a mapping; expected a list with one entry"),
        ("links: 6\n", 1, "found `6`; expected a list with one entry"),
        ("x" * 200 + ": 1\n", 1, "a key of more than 100 characters"),
    ],
)
def test_a_file_that_is_not_the_document_it_should_be(errors_of, text, line, said):
    (problem,) = errors_of(text)
    assert problem.line == line
    assert said in problem.message


@pytest.mark.parametrize(
    ("content", "line", "said"),
    [
        (b"name: a\nlinks: \xff\n", 2, "is not UTF-8 text (byte 0xFF)"),
        (ARM.encode("utf-16"), 1, "is not UTF-8 text (it is UTF-16)"),
        (b"#" * (MAX_SIZE + 1), None, "is larger than 4 MB; an arm has at most 300 links"),
    ],
)
def test_a_file_that_is_not_text(errors_of, content, line, said):
    (problem,) = errors_of(content)
    assert problem.line == line
    assert said in problem.message


EXPLOSION = "\n".join(
    ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    + [
        f"{y}: &{y} [{', '.join([f'*{x}'] * 9)}]"
        for x, y in zip("abcdefgh", "bcdefghi", strict=True)
    ]
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (EXPLOSION, "more than 20000 values, those that aliases (`*name`) repeat counted"),
        ("\n".join(f"k{i}: 0" for i in range(30_000)), "more than 20000 values"),
        ("links: " + "[" * 100_000, "nested deeper than 10 levels"),
        ("links: " + "{a: " * 100_000, "nested deeper than 10 levels"),
        ("- " * 100_000, "nested deeper than 10 levels"),
        ("links:\n" + ARM.split("links:\n")[1] * 301, "more than 300 entries; an arm has 1 to 300"),
        ("links:\n" + ARM.split("links:\n")[1] * 10_000, "an arm has 1 to 300 links"),
        ("links:\n" + "  - {}\n" * 10_000, "an arm has 1 to 300 links"),
    ],
)
def test_a_file_that_explodes_costs_little(errors_of, text, said):
    start = time.thread_time()
    (problem,) = errors_of(text)
    assert said in problem.message
    assert time.thread_time() - start < 5


# --- any damage ----------------------------------------------------------------------------------

PIECES = ["\t", "  ", "\n", ":", ": ", "- ", "[", "]", "{", "}", "&a ", "*a", "!!", "'", '"', "|"]
PIECES += ["#", "?", "%", "0", "-1", "1e9", "nan", "true", "pi/0", "x", "é", "\x00", "a: ", "---"]


@settings(deadline=None, max_examples=200, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(
        st.tuples(st.integers(0, len(ARM)), st.integers(0, 12), st.sampled_from(["", *PIECES])),
        min_size=1,
        max_size=3,
    )
)
def test_any_damage_to_a_file_gives_an_arm_or_a_list_of_problems(tmp_path_factory, damages):
    text = ARM
    for start, length, piece in damages:
        text = text[:start] + piece + text[start + length :]
    path = tmp_path_factory.getbasetemp() / "damaged.yaml"
    path.write_text(text, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotFileWarning)
        try:
            arm = read(path)
        except RobotFileError as error:
            assert error.problems  # noqa: PT017
            for line, _, message in error.problems:
                assert message
                assert line is None or 1 <= line <= text.count("\n") + 1
        else:
            assert arm.links
