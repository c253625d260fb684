"""Robots as links for tests, as readers make them."""

import sympy as sp

from moro.formats.assembly import Assembly, Link, Motion, inverse, rpy, to_axis
from moro.formats.assembly.bodies import central_body
from moro.model import REVOLUTE, Coordinate, Drive, Shift, Turn

R, pi, zero = sp.Rational, sp.pi, sp.Integer(0)
one = sp.Integer(1)
X, Y, Z = (one, zero, zero), (zero, one, zero), (zero, zero, one)
gravity = (zero, zero, R("-9.81"))


def body(mass=one, com=(zero, zero, zero), moment=one):
    return central_body(sp.sympify(mass), com, tuple(map(tuple, sp.diag(*[moment] * 3).tolist())))


def joint(name, parent, xyz=(0, 0, 0), axis=Z, *, q=None, ratio=one, offset=zero, **more):
    """A link as files have it: an origin, an axis, a joint called like its link."""
    turn = to_axis(axis)
    kind, drive = more.pop("kind", REVOLUTE), more.pop("drive", Drive())
    motion = Motion(kind, ((q or name, ratio),), offset, f"{name}_joint", drive)
    origin = (Shift(tuple(map(sp.sympify, xyz))), *rpy(*more.pop("rpy", (zero, zero, zero))))
    return Link(name, parent, (*origin, *turn, motion, *inverse(turn)), more.pop("bodies", ()))


def fixed(name, parent, xyz=(0, 0, 0), *turns, bodies=()):
    return Link(name, parent, (Shift(tuple(map(sp.sympify, xyz))), *turns), bodies)


def robot(*links, **more):
    names = dict.fromkeys(q for link in links for m in link.motions for q, _ in m.terms)
    coordinates = more.pop("coordinates", {name: Coordinate() for name in names})
    return Assembly("robot", links, coordinates, gravity, **more)


def arm(**more):
    """Two joints about y, a flange and a tool fixed on them; a camera, a mast on the base."""
    return robot(
        Link("base", None, bodies=(body(100),)),
        joint("upper", "base", (0, 0, 1), Y, bodies=(body(2, (one, zero, zero)),)),
        joint("lower", "upper", (2, 0, 0), Y, bodies=(body(1, (one, zero, zero)),)),
        fixed("flange", "lower", (3, 0, 0), Turn("z", pi / 2), bodies=(body(R(1, 2)),)),
        fixed("tool", "flange", (0, 1, 0), bodies=(body(R(1, 2)),)),
        fixed("camera", "upper", (1, 0, 1)),
        fixed("mast", "base", (0, 0, 5), bodies=(body(7),)),
        **more,
    )


def frames(model):
    return {frame.name: frame for frame in model.frames}
