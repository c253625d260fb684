"""Rows of DH parameters to ``Model``: both conventions brought to one form, on entry.

Modified DH (Khalil & Kleinfinger 1986) has Rx(alpha) Tx(a) before the joint, as ``Model``; in
standard DH, a and alpha stand in the row before. What a standard row has after its joint, Tx(a)
Rx(alpha), is where frame i is fixed in link i. So in both conventions the joints' frames are
Khalil's: z along the joint, x along the common normal to the joint after it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from typing import Any

import sympy as sp

from moro.formats.dh.arm import Arm, Row
from moro.formats.dh.meanings import meanings
from moro.model import (
    Body,
    Central,
    Coordinate,
    Drive,
    Frame,
    Joint,
    Model,
    Parameter,
    Placement,
    Shift,
    Turn,
)
from moro.model.placement import Step
from moro.spatial.vectors import (
    Matrix,
    Vector,
    add,
    dot,
    product,
    scaled,
    sum_of,
    times,
    transpose,
)

_ZERO = sp.Integer(0)


def model_from_dh(name: str, arm: Arm, defaults: Mapping[Any, Any]) -> Model:
    """Return the tree that the algorithms read, with the arm's own SymPy scalars.

    What is not set is zero. Frames are called 1, 2, .. n. ``defaults`` are those of all symbols of
    the arm (None: no default).
    """
    where = meanings(arm)
    gx, gy, gz = arm.gravity or (_ZERO,) * 3
    return Model(
        name,
        tuple(_joint(arm, i) for i in range(len(arm.rows))),
        tuple(_body(arm, i) for i in range(len(arm.rows))),
        (gx, gy, gz),
        tuple(Frame(str(i + 1), i, frame_in_link(arm, i)) for i in range(len(arm.rows))),
        tuple(_coordinate(arm, i) for i in range(len(arm.rows))),
        tuple(Parameter(s, x, where.get(str(s), "")) for s, x in defaults.items()),
        frozenset(field.name for field in fields(arm) if getattr(arm, field.name) is None),
        arm.convention,
    )


def frame_in_link(arm: Arm, i: int) -> Placement:
    """Return where frame i + 1 of the convention is in the frame of its joint."""
    return _by(*_twist(arm.rows[i])) if arm.convention == "dh" else Placement()


def _joint(arm: Arm, i: int) -> Joint:
    row = arm.rows[i]
    steps = [*_before(arm, i)]
    if row.type.is_angle:
        steps.append(Shift((_ZERO, _ZERO, row.d)))
    else:
        steps.append(Turn("z", row.theta))
    return Joint(
        row.type,
        i - 1,
        _by(*steps),
        row.theta if row.type.is_angle else row.d,
    )


def _coordinate(arm: Arm, i: int) -> Coordinate:
    rotors, viscous, coulomb = arm.rotor_inertias, arm.viscous_friction, arm.coulomb_friction
    drive = Drive(
        rotors[i] if rotors else _ZERO,
        viscous[i] if viscous else _ZERO,
        coulomb[i] if coulomb else (_ZERO, _ZERO),
    )
    limits = arm.joint_limits[i] if arm.joint_limits else None
    return Coordinate(arm.rows[i].variable, limits, drive)


def _before(arm: Arm, i: int) -> Iterator[Step]:
    """Yield what comes before joint i: Tx(a) and Rx(alpha), which commute."""
    if arm.convention == "mdh":
        yield from _twist(arm.rows[i])
    elif i > 0:
        yield from _twist(arm.rows[i - 1])


def _twist(row: Row) -> Iterator[Step]:
    yield Shift((row.a, _ZERO, _ZERO))
    yield Turn("x", row.alpha)


def _by(*steps: Step) -> Placement:
    """Return the placement by the steps that are not zero."""
    zeros = Shift((_ZERO, _ZERO, _ZERO)), Turn("x", _ZERO), Turn("z", _ZERO)
    return Placement.by(*(step for step in steps if step not in zeros))


def _body(arm: Arm, i: int) -> Body:
    """Return the inertial parameters of link i about the origin of its joint's frame (Steiner)."""
    nothing = (_ZERO, _ZERO, _ZERO)
    c = _vector(arm.cm_positions[i]) if arm.cm_positions else nothing
    I = _matrix(arm.inertia_tensors[i]) if arm.inertia_tensors else (nothing, nothing, nothing)
    frame = frame_in_link(arm, i)
    given = Central(c, I, frame)
    if arm.masses is None or arm.cm_positions is None:
        return Body(_ZERO, nothing, (nothing, nothing, nothing), False, given)
    m = arm.masses[i]
    in_numbers = arm.inertia_tensors is not None and _in_numbers(m, c, I)
    if any(map(_divisors, (m, *c, *I[0], *I[1], *I[2]))):
        body = _body_of_quotients(m, c, I, frame)
        return replace(body, in_numbers=in_numbers, central=given)
    r = add(times(frame.R, c), frame.p)
    tensor = sum_of(_in_parent(I, frame), _spread(m, r, r))
    return Body(m, scaled(m, r), tensor, in_numbers, given)


def _in_numbers(m: Any, c: Vector, I: Matrix) -> bool:
    """Return whether a link is given in numbers; a payload may be added to them.

    That is so if it is one without the payload: if, with all symbols 0, it has a mass, a centre of
    mass (unless at the origin) and the principal entries of its tensor, as with them.
    """
    if not sp.Tuple(m, c, I).free_symbols:
        return True
    moments = [I[k][k] for k in range(3) if I[k][k] != 0]
    return all(map(_has_number, (m, *moments))) and (not any(c) or any(map(_has_number, c)))


def _has_number(x: Any) -> bool:
    """Return whether an expression is not 0 where its symbols are."""
    alone = x.xreplace(dict.fromkeys(x.free_symbols, _ZERO))
    return bool(alone.is_finite and alone != 0)


def _body_of_quotients(m: Any, c: Vector, I: Matrix, frame: Placement) -> Body:
    """Return a body whose centre of mass or tensor is divided by symbols, as a rule by its mass.

    Its moments about the origin of the frame that they are given in, h = m c and I + m (c.c 1 - c
    c^T), often need no division: they are formed in lowest terms, and only then moved by p. About
    the origin of the joint's frame, R (h, I) R^T and p add up to

        h + m p,    I + m (p.p 1 - p p^T) + 2 h.p 1 - h p^T - p h^T.
    """
    m, h, I = _cancelled(m), scaled(m, c), sum_of(I, _spread(m, c, c))
    h = times(frame.R, _vector(map(_cancelled, h)))
    I = _in_parent(_matrix(map(_cancelled, row) for row in I), frame)
    p = frame.p
    for part in (_spread(m, p, p), _spread(1, h, p), _spread(1, p, h)):
        I = sum_of(I, part)
    h = add(h, scaled(m, p))
    return Body(m, _vector(map(_cancelled, h)), _matrix(map(_cancelled, row) for row in I))


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
    both = dot(r, s)
    return _matrix(
        [m * ((both if j == k else _ZERO) - r[j] * s[k]) for k in range(3)] for j in range(3)
    )


def _in_parent(I: Matrix, frame: Placement) -> Matrix:
    return product(product(frame.R, I), transpose(frame.R))


def _vector(values: Any) -> Vector:
    x, y, z = values
    return x, y, z


def _matrix(rows: Any) -> Matrix:
    x, y, z = map(_vector, rows)
    return x, y, z
