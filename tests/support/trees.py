"""Branched robots for tests, as models made by hand."""

from dataclasses import replace

import sympy as sp

from moro.abc import symbol
from moro.model import REVOLUTE, Body, Coordinate, Drive, Joint, Model, Placement, Shift


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


def coupled(model, rows, nv):
    """A model whose joint i moves by the sum of ratio q_j for (j, ratio) in rows[i]."""
    joints = zip(model.joints, rows, strict=True)
    joints = tuple(replace(joint, terms=tuple(row)) for joint, row in joints)
    drives = (Drive(sp.Rational(j + 1, 10), sp.Rational(1, j + 2)) for j in range(nv))
    return replace(
        model,
        joints=joints,
        coordinates=tuple(Coordinate(drive=d) for d in drives),
        not_set=model.not_set - {"rotor_inertias", "viscous_friction"},
    )


def random_rows(rng, n):
    """Rows of A for n joints, every coordinate in some of them; and the number of coordinates."""
    nv = rng.randint(max(1, n - 2), n)
    ratios = [sp.Rational(x) for x in ("1", "1", "-1", "-1", "2", "1/2", "-3/2", "1.09")]
    rows = []
    for i in range(n):
        others = [j for j in range(nv) if j != i and rng.random() < 0.25]
        own = [i] if i < nv else [] if others else [rng.randrange(nv)]
        rows.append([(j, rng.choice(ratios)) for j in sorted({*own, *others})])
    return rows, nv


def matrix_of(rows, nv):
    """A as a SymPy matrix."""
    A = sp.zeros(len(rows), nv)
    for i, row in enumerate(rows):
        for j, ratio in row:
            A[i, j] = ratio
    return A
