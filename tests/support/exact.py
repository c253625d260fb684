"""Exact arms: trees with rational poses whose bodies are point masses, and their dynamics.

The torques come from d'Alembert's principle, sum of m (a - g) . dr/dq_i over all points, with the
motion of the points from power series in time: no formula of rigid bodies is used.
"""

import operator
from fractions import Fraction

import numpy as np

from moro.model import PRISMATIC, REVOLUTE, Body, Frame, Joint, Model, Placement
from moro.spatial.angles import rational_sincos
from moro_codegen.graph.nodes import schedule
from moro_codegen.passes import PASSES, Pass


class Series:
    """c0 + c1 t + c2 t^2, whatever comes after left out."""

    def __init__(self, *c):
        self.c = c + (0,) * (3 - len(c))

    def __add__(self, other):
        other = other.c if isinstance(other, Series) else (other, 0, 0)
        return Series(*(a + b for a, b in zip(self.c, other, strict=True)))

    def __mul__(self, other):
        a, b = self.c, other.c if isinstance(other, Series) else (other, 0, 0)
        return Series(
            a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0]
        )

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self):
        return self * -1

    def __sub__(self, other):
        return self + -other

    def __rsub__(self, other):
        return -self + other


def rational(rng):
    return Fraction(int(rng.integers(-9, 10)), int(rng.integers(1, 10)))


def pair(rng):
    """Rational sine and cosine."""
    t = rational(rng)
    return 2 * t / (1 + t * t), (1 - t * t) / (1 + t * t)


def rotation(rng):
    """Rational rotation; one in two a quarter turn or none, as in most arms."""
    if rng.random() < 0.5:
        (s, c), axis = [(0, 1), (1, 0), (-1, 0), (0, -1)][rng.integers(4)], rng.integers(3)
    else:
        (s, c), axis = pair(rng), rng.integers(3)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], object)
    R = np.roll(R, (axis, axis), (0, 1))
    return tuple(tuple(Fraction(x) for x in row) for row in R)


def vector(rng, zero=0.4):
    return tuple(Fraction(0) if rng.random() < zero else rational(rng) for _ in range(3))


def exact_arm(rng, n, tree=False):
    """Return a model and, for every body, its points as (mass, position in the joint's frame)."""
    joints, bodies, points = [], [], []
    for i in range(n):
        parent = int(rng.integers(-1, i)) if tree else i - 1
        kind = REVOLUTE if rng.random() < 0.7 else PRISMATIC
        R = rotation(rng)
        if rng.random() < 0.5:
            R = tuple(tuple(Fraction(x) for x in row) for row in [(1, 0, 0), (0, 0, -1), (0, 1, 0)])
        offset = rational(rng) if kind == PRISMATIC else 0
        joints.append(Joint(kind, parent, Placement(R, vector(rng)), offset))
        points.append([(abs(rational(rng)), vector(rng)) for _ in range(rng.integers(0, 5))])
        bodies.append(body(points[-1]))
    tip = Frame("tip", n - 1, Placement(rotation(rng), vector(rng)))
    return Model("exact", tuple(joints), tuple(bodies), vector(rng), (tip,)), points


def body(points):
    """Return the body that the points make up."""
    mass = sum((m for m, _ in points), Fraction(0))
    moment = tuple(sum((m * r[k] for m, r in points), Fraction(0)) for k in range(3))
    inertia = tuple(
        tuple(
            sum(
                (m * ((i == j) * sum(x * x for x in r) - r[i] * r[j]) for m, r in points),
                Fraction(0),
            )
            for j in range(3)
        )
        for i in range(3)
    )
    return Body(mass, moment, inertia)


def exact_state(rng, n):
    """Return sincos, q, qd, qdd; q is independent of sincos, that of the other joints."""
    return [pair(rng) for _ in range(n)], *([rational(rng) for _ in range(n)] for _ in range(3))


def point_torques(model, points, sincos, q, qd, qdd):
    """Return the torques by d'Alembert's principle."""
    n = model.dof
    moving = moving_points(model, points, sincos, q, qd, qdd)
    torques = []
    for i in range(n):
        unit = [int(k == i) for k in range(n)]
        varied = moving_points(model, points, sincos, q, unit, [0] * n)
        torques.append(
            sum(
                m * (2 * x.c[2] - g) * dx.c[1]
                for (m, r), (_, dr) in zip(moving, varied, strict=True)
                for x, dx, g in zip(r, dr, model.gravity, strict=True)
            )
        )
    return torques


def _paths(sincos, q, qd, qdd):
    """Return (sin, cos, q) of every joint in time."""
    half = [Fraction(x) / 2 for x in qdd]
    return [
        (
            Series(s, c * v, c * a - s * v * v / 2),
            Series(c, -s * v, -s * a - c * v * v / 2),
            Series(x, v, a),
        )
        for (s, c), x, v, a in zip(sincos, q, map(Fraction, qd), half, strict=True)
    ]


def moving_points(model, points, sincos, q, qd, qdd):
    """Return (mass, position in the base, as series in time) of every point."""
    paths = _paths(sincos, q, qd, qdd)
    return [
        (m, _in_base(model, i, tuple(Series(x) for x in r), paths))
        for i, own in enumerate(points)
        for m, r in own
    ]


def _in_base(model, i, r, paths):
    """Return the position in the base of a point of body i."""
    while i >= 0:
        joint, (sin, cos, q), (x, y, z) = model.joints[i], paths[i], r
        if joint.type == REVOLUTE:
            x, y = cos * x - sin * y, sin * x + cos * y
        else:
            z = z + q + joint.offset
        R, p = joint.placement.R, joint.placement.p
        r = tuple(R[k][0] * x + R[k][1] * y + R[k][2] * z + p[k] for k in range(3))
        i = joint.parent
    return r


#: what leaves numbers exact: x axes are turned by angles that are no fractions
EXACT = [x for x in PASSES if x is not Pass.X_AXES]


def random_expressions(rng, graph, count):
    """Sums and products of one another and of constants, and values of their inputs."""
    nodes = [graph.input("x", i) for i in range(4)]
    for _ in range(60):
        a, b = (nodes[i] for i in rng.integers(len(nodes), size=2))
        a = a if rng.random() < 0.8 else graph.constant(rational(rng))
        nodes.append([a + b, a - b, a * b][rng.integers(3)])
    return nodes[-count:], {"x": [rational(rng) for _ in range(4)]}


def exact_values(results, inputs, sincos=()):
    """Return the values of nodes of a graph in Fractions.

    ``inputs``: {name: values}; ``sincos``: pairs of the inputs "q". Angles may be sums of these.
    """
    values = {}

    def value(node):
        if node.op == "const":
            return node.value
        if node.op == "input":
            name, k = node.value
            return inputs[name][k]
        return values[node]

    def turn(angle):
        """Sine and cosine of an angle, as a complex number's parts."""
        if angle.op == "const":
            return rational_sincos(angle.value)
        if angle.op == "input":
            return sincos[angle.value[1]]
        (s1, c1), (s2, c2) = map(turn, angle.args)
        s2 = s2 if angle.op == "add" else -s2
        return s1 * c2 + c1 * s2, c1 * c2 - s1 * s2

    for node in schedule(results):
        if node.op in ("sin", "cos"):
            values[node] = turn(node.args[0])[node.op == "cos"]
        else:
            values[node] = OPERATIONS[node.op](*map(value, node.args))
    return [value(node) for node in results]


OPERATIONS = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    "sign": lambda x: (x > 0) - (x < 0),
}
