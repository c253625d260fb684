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

from moro.formats.assembly.bodies import central_body
from moro.formats.dh.arm import Arm, Row
from moro.formats.dh.meanings import meanings
from moro.model import (
    ROTOR,
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
)

_ZERO = sp.Integer(0)


def model_from_dh(name: str, arm: Arm, defaults: Mapping[Any, Any]) -> Model:
    """Return the tree that the algorithms read, with the arm's own SymPy scalars.

    What is not set is zero. Frames are called 1, 2, .. n; before them come those with the names of
    links. ``defaults`` are those of all symbols of the arm (None: no default).
    """
    where = meanings(arm)
    gx, gy, gz = arm.gravity or (_ZERO,) * 3
    rotors = [*_rotors(arm)]
    return Model(
        name,
        (*(_joint(arm, i) for i in range(len(arm.rows))), *(x for x, _ in rotors)),
        (*(_body(arm, i) for i in range(len(arm.rows))), *(x for _, x in rotors)),
        (gx, gy, gz),
        tuple(_frames(arm)),
        tuple(_coordinate(arm, j, q) for j, q in enumerate(arm.variables)),
        tuple(Parameter(s, x, where.get(str(s), "")) for s, x in defaults.items()),
        frozenset(
            field.name
            for field in fields(arm)
            if getattr(arm, field.name) is None and field.name != "rotors"
        ),
        arm.convention,
    )


def _frames(arm: Arm) -> Iterator[Frame]:
    for i, name in enumerate(arm.link_names):
        if name:
            yield Frame(name, i, frame_in_link(arm, i))
    for i in range(len(arm.rows)):
        yield Frame(str(i + 1), i, frame_in_link(arm, i))


def frame_in_link(arm: Arm, i: int) -> Placement:
    """Return where frame i + 1 of the convention is in the frame of its joint."""
    return _by(*_twist(arm.rows[i])) if arm.convention == "dh" else Placement()


def _joint(arm: Arm, i: int) -> Joint:
    row = arm.rows[i]
    index = {variable: j for j, variable in enumerate(arm.variables)}
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
        tuple((index[variable], ratio) for variable, ratio in row.terms),
        arm.joint_names[i] if arm.joint_names else "",
    )


def _rotors(arm: Arm) -> Iterator[tuple[Joint, Body]]:
    """Yield the rotors that couple: each on the link before its joint, about the joint's axis."""
    for i, rotor in enumerate(arm.rotors or ()):
        if rotor is not None:
            inertia, ratio = rotor
            joint = _joint(arm, i)
            terms = tuple((j, ratio * x) for j, x in joint.terms)
            nothing = (_ZERO, _ZERO, _ZERO)
            tensor = (nothing, nothing, (_ZERO, _ZERO, inertia))
            spinning = replace(joint, type=ROTOR, offset=_ZERO, terms=terms, name=f"rotor{i + 1}")
            yield spinning, central_body(_ZERO, nothing, tensor, in_numbers=False)


def _coordinate(arm: Arm, j: int, variable: Any) -> Coordinate:
    rotors, viscous, coulomb = arm.rotor_inertias, arm.viscous_friction, arm.coulomb_friction
    drive = Drive(
        rotors[j] if rotors else _ZERO,
        viscous[j] if viscous else _ZERO,
        coulomb[j] if coulomb else (_ZERO, _ZERO),
    )
    limits = arm.joint_limits[j] if arm.joint_limits else None
    alone = len([i for i in arm.variables.values() if i == arm.variables[variable]]) == 1
    name = arm.joint_names[arm.variables[variable]] if arm.joint_names and alone else ""
    return Coordinate(variable, limits, drive, name)


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
    return central_body(arm.masses[i], c, I, frame, False if arm.inertia_tensors is None else None)


def _vector(values: Any) -> Vector:
    x, y, z = values
    return x, y, z


def _matrix(rows: Any) -> Matrix:
    x, y, z = map(_vector, rows)
    return x, y, z
