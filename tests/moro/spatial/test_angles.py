"""Sines and cosines as fractions on the unit circle."""

from fractions import Fraction
from math import cos, pi, sin

from hypothesis import given, settings
from hypothesis import strategies as st

from moro.spatial.angles import rational_sincos


@given(st.floats(-20, 20))
@settings(max_examples=200)
def test_on_the_circle_and_near_the_angle(angle):
    s, c = rational_sincos(angle)
    assert s * s + c * c == 1
    assert abs(float(s) - sin(angle)) <= 2e-16
    assert abs(float(c) - cos(angle)) <= 2e-16
    assert s.denominator < 10**36


def test_of_what_no_float_says():
    """cos(1.5708) = sin(pi/2 - 1.5708); the float next to 1.5708 is 1e-16 off."""
    assert rational_sincos(0) == (0, 1)
    cosine = rational_sincos(Fraction("1.5708"))[1]
    assert abs(cosine + Fraction("3.6732051033725084e-6")) < Fraction("1e-17")
    assert float(rational_sincos(pi)[0]) == sin(pi)
