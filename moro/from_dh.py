"""DH rows to ``Model``: every convention brought to one form, on entry.

Standard DH puts Tz(d) Tx(a) Rx(alpha) after the joint: it moves into the child's placement and into
the body's inertial parameters. Modified DH has Rx(alpha) Tx(a) before the joint, as ``Model``.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    x, y, z = (
        sum((R * c for R, c in zip(row, arm.cm_positions[i], strict=True)), p)
        for row, p in zip(pose.R, pose.p, strict=True)
    )
    a, b, c = arm.inertia_tensors[i]
    I = _times(_times(pose.R, (a, b, c)), _transpose(pose.R))
    r, rr = (x, y, z), x * x + y * y + z * z
    about_origin = [
        [I[j][k] + m * ((rr if j == k else _ZERO) - r[j] * r[k]) for k in range(3)]
        for j in range(3)
    ]
    return Body(m, (m * x, m * y, m * z), _matrix(about_origin))


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


def _matrix(rows: Sequence[Sequence[Any]]) -> Matrix:
    def vector(row: Sequence[Any]) -> Vector:
        x, y, z = row
        return x, y, z

    a, b, c = map(vector, rows)
    return a, b, c
