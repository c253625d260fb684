"""Bodies brought to the frames of joints, and added up."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from moro.formats.assembly.bodies import MASSLESS, central_body, moved, together
from moro.model import Body, Central, Placement, Shift, Turn

zero, pi = sp.Integer(0), sp.pi
m, l, lc, Ix, Iy, Iz = sp.symbols("m l lc Ix Iy Iz")
whole = st.integers(-5, 5).map(sp.Integer)
vectors = st.tuples(whole, whole, whole)
turns = st.builds(Turn, st.sampled_from("xz"), st.integers(0, 3).map(lambda k: k * pi / 2))
places = st.builds(lambda *steps: Placement.by(*steps), turns, st.builds(Shift, vectors), turns)


def diagonal(*entries):
    return tuple(map(tuple, sp.diag(*entries).tolist()))


def points(body):
    """Mass, h and the tensor of a set of point masses, from their definitions."""
    mass = sum(w for w, _ in body)
    h = sum((w * sp.Matrix(r) for w, r in body), sp.zeros(3, 1))
    I = sp.zeros(3)
    for w, r in body:
        r = sp.Matrix(r)
        I += w * (r.dot(r) * sp.eye(3) - r * r.T)
    return mass, h, I


def as_body(body):
    mass, h, I = points(body)
    return Body(mass, tuple(h), tuple(map(tuple, I.tolist())))


clouds = st.lists(st.tuples(st.integers(1, 4).map(sp.Integer), vectors), min_size=1, max_size=4)


@given(clouds, places)
@settings(max_examples=40, deadline=None)
def test_a_moved_cloud_of_points_is_the_cloud_of_moved_points(cloud, place):
    R, p = sp.Matrix(place.R), sp.Matrix(place.p)
    assert moved(as_body(cloud), place) == as_body([(w, R * sp.Matrix(r) + p) for w, r in cloud])


@given(clouds, clouds)
@settings(max_examples=20, deadline=None)
def test_bodies_add_up(first, second):
    both = together([as_body(first), MASSLESS, as_body(second)])
    assert both == as_body([*first, *second])


def test_one_body_stays_as_it_was_described():
    rod = central_body(m, (lc, zero, zero), diagonal(zero, Iy, Iz))
    assert rod.inertia == diagonal(zero, Iy + m * lc**2, Iz + m * lc**2)
    there = Placement.by(Turn("x", pi / 2), Shift((l, zero, zero)))
    found = together([MASSLESS, moved(rod, there)])
    assert found.central == Central((lc, zero, zero), diagonal(zero, Iy, Iz), found.central.frame)
    assert found.central.frame.R == there.R
    assert found.central.frame.p == there.p
    assert found.first_moment == (m * (l + lc), 0, 0)
    assert together([]) == MASSLESS


def test_divisions_by_the_mass_cancel():
    hx, hy = sp.symbols("h_x h_y")
    body = central_body(m, (hx / m, hy / m, zero), diagonal(Ix, Iy, Iz - (hx**2 + hy**2) / m))
    assert body.first_moment == (hx, hy, 0)
    assert moved(body, Placement.by(Shift((l, zero, zero)))).inertia[2][2].has(1 / m) is False
