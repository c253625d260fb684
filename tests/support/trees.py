"""Branched robots for tests, as models made by hand."""

import sympy as sp

from moro.abc import symbol
from moro.model import REVOLUTE, Body, Joint, Model, Placement, Shift


def planar_tree():
    """A trunk with two arms of two joints each, all axes parallel; gravity along -y."""
    parents, along_x = (-1, 0, 1, 0, 3), ("", "l_1", "l_2", "l_1", "l_4")
    joints, bodies, zero = [], [], sp.Integer(0)
    for i, (parent, length) in enumerate(zip(parents, along_x, strict=True), 1):
        way = [Shift((sp.Symbol(length), zero, zero))] if length else []
        joints.append(Joint(REVOLUTE, parent, Placement.by(*way)))
        m, r, I = symbol("m", i), symbol("lc", i), sp.Symbol(f"I_{i}")
        J = ((zero, zero, zero), (zero, zero, zero), (zero, zero, I + m * r**2))
        bodies.append(Body(m, (m * r, zero, zero), J))
    return Model("two_arms", tuple(joints), tuple(bodies), (zero, -symbol("g"), zero))


def sympified(model):
    """A model of fractions in SymPy's numbers."""
    return model.map(lambda x: sp.Rational(x.numerator, x.denominator) if x else sp.Integer(0))
