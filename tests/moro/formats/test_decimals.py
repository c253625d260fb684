"""Numbers in attributes; angles and directions that decimals mean."""

import pytest
import sympy as sp

from moro.formats.decimals import angle, direction, number, numbers

R, pi = sp.Rational, sp.pi
root2, root3 = sp.sqrt(2) / 2, sp.sqrt(3) / 2


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        (" -0.10 ", R(-1, 10)),
        ("+.5", R(1, 2)),
        ("2.", 2),
        ("1.5e-3", R(3, 2000)),
        ("1E+2", 100),
        ("0.1000000000000000055511151231257827", R("0.1000000000000000055511151231257827")),
        ("1e300", 10**300),
    ],
)
def test_decimals_are_exact(text, value):
    assert number(text).value == value


@pytest.mark.parametrize(
    "text",
    ["", "x", "nan", "inf", "-inf", "1,5", "1_0", "0x10", "1e", "--1", "1.2.3", "٣", "pi", "1/2"],
)
def test_text_that_is_no_number(text):
    assert number(text) == f"expected a number, found `{text}`"


@pytest.mark.parametrize("text", ["1e301", "1e-301", "1e999999999", "-1e400"])
def test_numbers_beyond_any_sane_size(text):
    assert number(text) == f"expected 0 or a number within 1e-300..1e300 in size, found `{text}`"


def test_a_number_of_a_million_digits():
    assert number("1" * 1_000_000).endswith("1...`")


def test_vectors():
    assert [x.value for x in numbers(" 1 \n -2\t.5 ", 3)] == [1, -2, R(1, 2)]
    assert numbers("1 2", 3) == "expected 3 numbers, found `1 2`"
    assert numbers(" ", 3) == "expected 3 numbers, found nothing"
    assert numbers("1 2 x", 3) == "expected a number, found `x`"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.5708", pi / 2),  # rounded
        ("1.5707", pi / 2),  # cut
        ("1.57", pi / 2),
        ("-3.14", -pi),
        ("3.1415926", pi),
        ("1.57079632679", pi / 2),
        ("0.7854", pi / 4),
        ("-2.35619449019", -3 * pi / 4),
        ("0.5236", pi / 6),
        ("1.0472", pi / 3),
        ("4.7123889804", 3 * pi / 2),
        ("-1.5707963705062866", -pi / 2),  # in single precision
        ("1.57079637", pi / 2),
        ("15.708e-1", pi / 2),
        ("-4.89659e-12", 0),
    ],
)
def test_decimals_that_mean_an_angle(text, value):
    assert angle(number(text)) == (value, True)
    assert angle(number(text), as_written=True) == (R(text), False)


@pytest.mark.parametrize(
    "text", ["1.5707963267948966", "1.5707963267948968", "-0.7853981633974483"]
)
def test_the_double_next_to_an_angle_is_that_angle(text):
    exact = pi * round(float(text) * 4 / float(pi)) / 4
    assert angle(number(text)) == angle(number(text), as_written=True) == (exact, False)


@pytest.mark.parametrize(
    "text", ["1.5709", "1.6", "0.79", "0.785", "0.52", "0.2618", "1.57075", "3e-6", "0.3", "31.42"]
)
def test_decimals_that_mean_themselves(text):
    assert angle(number(text)) == (R(text), False)


@pytest.mark.parametrize(
    ("text", "meant", "is_said"),
    [
        ("0 1 6.12323e-17", (0, 1, 0), True),
        ("-1.2246e-16 0 -1", (0, 0, -1), True),
        ("0.5 0 0.866", (R(1, 2), 0, root3), True),
        ("0 0.707 -0.707", (0, root2, -root2), False),
        ("1 2 3", (1, 2, 3), False),
        ("0.6 0 0.8", (R(3, 5), 0, R(4, 5)), False),
        ("0 0 0.8660254", (0, 0, R("0.8660254")), False),
        ("0 4.89659e-12 1", (0, 0, 1), True),
        ("0 1e-9 1", (0, R("1e-9"), 1), False),
    ],
)
def test_directions(text, meant, is_said):
    found, said = direction(numbers(text, 3))
    assert (tuple(found), said) == (meant, is_said)
    assert direction(numbers(text, 3), as_written=True) == ([R(x) for x in text.split()], False)
