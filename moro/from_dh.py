"""DH rows to ``Model``: every convention brought to one form, on entry.

Standard DH puts Tz(d) Tx(a) Rx(alpha) after the joint: it moves into the child's placement and into
the body's inertial parameters. Modified DH has Rx(alpha) Tx(a) before the joint, as ``Model``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import sympy as sp

from moro.closed_form import Arm
from moro.model import Body, Joint, Matrix, Model, Placement, Vector

_ZERO = sp.Integer(0)


def model_from_dh(
    name: str,
    arm: Arm,
    viscous: Sequence[Any] | None,
    coulomb: Sequence[tuple[Any, Any]] | None,
) -> Model:
    """Return the tree that the recursive algorithms read, with the arm's own SymPy scalars."""
    n = len(arm.rows)
    rotor = arm.rotor_inertias or (_ZERO,) * n
    viscous = viscous or (_ZERO,) * n
    coulomb = coulomb or ((_ZERO, _ZERO),) * n
    joints = tuple(
        Joint(
            "revolute" if row.kind == "r" else "prismatic",
            i - 1,
            _before(arm, i),
            row.theta if row.kind == "r" else row.d,
            rotor[i],
            viscous[i],
            (coulomb[i][0], coulomb[i][1]),
        )
        for i, row in enumerate(arm.rows)
    )
    bodies = tuple(_body(arm, i) for i in range(n))
    gx, gy, gz = arm.gravity or (_ZERO,) * 3
    return Model(name, joints, bodies, (gx, gy, gz), _after(arm, n - 1))


def _before(arm: Arm, i: int) -> Placement:
    """Pose of joint i's frame in the frame of joint i - 1, at rest."""
    row = arm.rows[i]
    turn = row.theta if row.kind == "p" else _ZERO
    if arm.convention == "mdh":
        d = row.d if row.kind == "r" else _ZERO
        R = _rotation_x(row.alpha)
        return Placement(_times(R, _rotation_z(turn)), (row.a, d * R[1][2], d * R[2][2]))
    if i == 0:
        return Placement(_rotation_z(turn), (_ZERO, _ZERO, _ZERO))
    after = _after(arm, i - 1)
    return Placement(_times(after.R, _rotation_z(turn)), after.p)


def _after(arm: Arm, i: int) -> Placement:
    """Pose of DH frame i in the frame of joint i."""
    if arm.convention == "mdh":
        return Placement(_rotation_x(_ZERO), (_ZERO, _ZERO, _ZERO))
    row = arm.rows[i]
    return Placement(_rotation_x(row.alpha), (row.a, _ZERO, row.d if row.kind == "r" else _ZERO))


def _body(arm: Arm, i: int) -> Body:
    """Inertial parameters of link i about the origin of joint i's frame (Steiner)."""
    if arm.masses is None or arm.cm_positions is None or arm.inertia_tensors is None:
        zeros = (_ZERO, _ZERO, _ZERO)
        return Body(_ZERO, zeros, (zeros, zeros, zeros))
    m, pose = arm.masses[i], _after(arm, i)
    a, b, c = arm.inertia_tensors[i]
    cx, cy, cz = arm.cm_positions[i]
    if any(map(_divisors, (m, cx, cy, cz, *a, *b, *c))):
        return _body_of_quotients(m, (cx, cy, cz), (a, b, c), pose)
    x, y, z = r = _moved((cx, cy, cz), pose)
    I = _times(_times(pose.R, (a, b, c)), _transpose(pose.R))
    return Body(m, (m * x, m * y, m * z), _sum(I, _spread(m, r, r)))


def _body_of_quotients(m: Any, r: Vector, I: Matrix, pose: Placement) -> Body:
    """Return a body whose centre of mass or tensor is divided by symbols, as a rule by its mass.

    Its moments about the origin of the frame that they are given in, h = m r and I + m (r.r 1 - r
    r^T), often need no division: they are formed in lowest terms, and only then moved by p. About
    the origin of the joint's frame, R (h, I) R^T and p add up to

        h + m p,    I + m (p.p 1 - p p^T) + 2 h.p 1 - h p^T - p h^T.
    """
    x, y, z = r
    m, h, I = _cancelled(m), (m * x, m * y, m * z), _sum(I, _spread(m, r, r))
    h, I = _vector(map(_cancelled, h)), _matrix([map(_cancelled, row) for row in I])
    h, I = _moved(h, Placement(pose.R, (_ZERO,) * 3)), _times(_times(pose.R, I), _transpose(pose.R))
    p = pose.p
    for part in (_spread(m, p, p), _spread(1, h, p), _spread(1, p, h)):
        I = _sum(I, part)
    h = _vector(x + m * y for x, y in zip(h, p, strict=True))
    return Body(m, _vector(map(_cancelled, h)), _matrix([map(_cancelled, row) for row in I]))


def _cancelled(x: Any) -> Any:
    """Return an expression in lowest terms, if it is divided by fewer symbols then."""
    divisors = _divisors(x)
    if not divisors:
        return x
    lowest = sp.cancel(x)
    return lowest if _divisors(lowest) < divisors else x


def _divisors(x: Any) -> set[Any]:
    """Return the symbols that an expression is divided by."""
    powers = sp.sympify(x).atoms(sp.Pow)
    found = (y.base.free_symbols for y in powers if y.exp.could_extract_minus_sign())
    return set().union(*found)


def _spread(m: Any, r: Vector, s: Vector) -> Matrix:
    """Return m (r.s 1 - r s^T): for r = s, the tensor of a mass m at r about the origin."""
    both = r[0] * s[0] + r[1] * s[1] + r[2] * s[2]
    return _matrix(
        [[m * ((both if j == k else _ZERO) - r[j] * s[k]) for k in range(3)] for j in range(3)]
    )


def _moved(r: Vector, pose: Placement) -> Vector:
    return _vector(
        sum((R * c for R, c in zip(row, r, strict=True)), p)
        for row, p in zip(pose.R, pose.p, strict=True)
    )


def _rotation_x(alpha: Any) -> Matrix:
    s, c, one = sp.sin(alpha), sp.cos(alpha), sp.Integer(1)
    return ((one, _ZERO, _ZERO), (_ZERO, c, -s), (_ZERO, s, c))


def _rotation_z(theta: Any) -> Matrix:
    s, c, one = sp.sin(theta), sp.cos(theta), sp.Integer(1)
    return ((c, -s, _ZERO), (s, c, _ZERO), (_ZERO, _ZERO, one))


def _times(A: Matrix, B: Matrix) -> Matrix:
    return _matrix(
        [[sum(a * b for a, b in zip(r, c, strict=True)) for c in zip(*B, strict=True)] for r in A]
    )


def _transpose(A: Matrix) -> Matrix:
    return _matrix([list(column) for column in zip(*A, strict=True)])


def _sum(A: Matrix, B: Matrix) -> Matrix:
    return _matrix([[a + b for a, b in zip(r, s, strict=True)] for r, s in zip(A, B, strict=True)])


def _matrix(rows: Iterable[Iterable[Any]]) -> Matrix:
    a, b, c = map(_vector, rows)
    return a, b, c


def _vector(components: Iterable[Any]) -> Vector:
    x, y, z = components
    return x, y, z
