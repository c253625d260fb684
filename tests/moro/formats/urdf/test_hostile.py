"""Malformed and hostile XML: a clear error, nothing executed or fetched."""

from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from slips import slipped
from urdfs import axis, body, joint, link, robot, written

from moro.formats import xml
from moro.formats.errors import RobotFileError
from moro.formats.urdf.reader import read

LAUGHS = (
    '<!DOCTYPE lolz [<!ENTITY lol0 "lol">'
    + "".join(f'<!ENTITY lol{i} "{f"&lol{i - 1};" * 10}">' for i in range(1, 10))
    + "]>\n<robot name='x'>&lol9;</robot>"
)
EXTERNAL = '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<robot name="x">&x;</robot>'
REMOTE = '<!DOCTYPE robot SYSTEM "http://example.org/robot.dtd">\n<robot name="x"/>'


@pytest.mark.parametrize("text", [LAUGHS, EXTERNAL, REMOTE])
def test_document_types_are_refused(tmp_path, text):
    with pytest.raises(RobotFileError, match=r"robot\.urdf:1: a document type \(<!DOCTYPE"):
        read(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"robot\.urdf: the file is empty"),
        ("\n \n", r"robot\.urdf: the file is empty"),
        ("robot", ":1: not XML: syntax error"),
        (
            "<robot>\n<link name='a'>\n</robot>",
            r":3: not XML: mismatched tag \(in <link> of line 2",
        ),
        ("<robot>\n<link name='a'/>", r":2: not XML: no element found \(in <robot> of line 1\)"),
        ("<robot name='a' name='b'/>", ":1: not XML: duplicate attribute"),
        ("<robot/>\n<robot/>", ":2: not XML: junk after document element"),
        ("<robot>&lol;</robot>", ":1: not XML: undefined entity"),
        ("<?xml version='1.0' encoding='no-such'?><robot/>", "not XML: unknown encoding"),
        (b"<robot>\n\xff</robot>", ":2: not XML: not well-formed"),
        (b"\x00" * 10, ":1: not XML"),
        ("<a>" * 200, ":1: more than 100 elements in one another"),
        ("<mujoco/>", ":1: expected the root <robot> of a URDF, found <mujoco>"),
        ("<Robot/>", "found <Robot>; did you mean `robot`"),
    ],
)
def test_what_is_no_urdf(tmp_path, text, message):
    with pytest.raises(RobotFileError, match=message):
        read(written(tmp_path, text))


def test_a_hundred_megabytes(tmp_path):
    path = tmp_path / "robot.urdf"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(RobotFileError, match="is larger than 20 MB"):
        read(path)


def test_no_such_file(tmp_path):
    written(tmp_path, "<robot/>", "panda.urdf")
    with pytest.raises(RobotFileError, match=r"no such file; did you mean `.*panda\.urdf`"):
        read(tmp_path / "pamda.urdf")
    with pytest.raises(RobotFileError, match="is a folder"):
        read(tmp_path)


@pytest.mark.parametrize(
    "inside",
    [
        '<xacro:property name="r" value="1"/>',
        '<link name="${prefix}base"/>',
        '<gazebo reference="a"><x file="$(find a)/b"/></gazebo>',
    ],
)
def test_xacro_says_what_makes_a_urdf_of_it(tmp_path, inside):
    path = written(tmp_path, robot("<link name='a'/>", inside), "arm.urdf.xacro")
    with pytest.raises(RobotFileError) as error:
        read(path)
    assert ":3: " in str(error.value)
    assert "`xacro arm.urdf.xacro > arm.urdf`" in str(error.value)


def test_text_in_other_encodings_is_read(tmp_path):
    text = robot(link("a"), link("b"), joint("ä", "a", "b"))
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "latin-1"):
        declared = f'<?xml version="1.0" encoding="{encoding.removesuffix("-sig")}"?>\n{text}'
        assert [*read(written(tmp_path, declared.encode(encoding))).coordinates] == ["ä"]


def test_memory_stays_small_for_many_elements(tmp_path):
    many = "".join("<visual/>" for _ in range(50_000))
    with pytest.raises(RobotFileError, match="there is no <link>"):
        read(written(tmp_path, robot(many)))


SAMPLE = robot(
    link("base", body()),
    joint("a", "base", "arm", axis("0 1 0") + '<limit lower="-1" upper="1"/>'),
    link("arm", body(2, "0 0 1", "0.1 0 0")),
    joint("b", "arm", "hand", '<mimic joint="a" multiplier="-1"/>', "prismatic"),
    link("hand", body()),
)


@given(slipped(SAMPLE))
@settings(max_examples=150, deadline=None)
@pytest.mark.filterwarnings("ignore::moro.formats.errors.RobotFileWarning")
def test_any_slip_is_read_or_refused_with_a_place(tmp_path_factory, text):
    path = written(tmp_path_factory.mktemp("urdf"), text)
    problems, joints = outcome(path)
    assert bool(problems) != bool(joints)
    assert all(len(problem.message) < 300 for problem in problems)
    assert joints in (0, 1, 2)


def outcome(path):
    """Problems that a file has, or how many joints its model."""
    try:
        built = read(path)
    except RobotFileError as error:
        return error.problems, 0
    return [], len(built.model().joints) if built.coordinates else 1


@given(st.binary(max_size=200))
@settings(max_examples=100, deadline=None)
def test_any_bytes_are_xml_or_refused(data):
    with suppress(xml.DocumentError):
        assert xml.parse(data).tag
