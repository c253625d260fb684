"""Bodies where they are given, brought to the frames of joints and added up."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.formats.assembly.steps import placed, settled, settled_matrix, settled_vector
from moro.model import Body, Central, Placement
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
_NOWHERE = Placement()
NOTHING: Vector = (_ZERO, _ZERO, _ZERO)
#: a link that weighs nothing
MASSLESS = Body(_ZERO, NOTHING, (NOTHING, NOTHING, NOTHING))


def central_body(
    mass: Any,
    com: Vector,
    inertia: Matrix,
    frame: Placement = _NOWHERE,
    in_numbers: bool | None = None,
) -> Body:
    """Return a body that is given about its centre of mass, in a ``frame`` of its link (Steiner).

    What is divided by the mass, h / m for a centre of mass say, is formed without the division.
    Whether it is given ``in_numbers`` is seen from these, if it is not said.
    """
    if in_numbers is None:
        in_numbers = _in_numbers(mass, com, inertia)
    given = Central(com, inertia, frame)
    if any(map(_divisors, (mass, *com, *inertia[0], *inertia[1], *inertia[2]))):
        body = _body_of_quotients(mass, com, inertia, frame)
        return replace(body, in_numbers=in_numbers, central=given)
    r = add(times(frame.R, com), frame.p)
    tensor = sum_of(_in_parent(inertia, frame), _spread(mass, r, r))
    return Body(mass, scaled(mass, r), tensor, in_numbers, given)


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


def moved(body: Body, placement: Placement) -> Body:
    """Return a body, given in a frame, in the frame that this one is placed in."""
    if placement.R == _NOWHERE.R and not any(placement.p):
        return body
    if body.central is not None:
        com, inertia, frame = body.central.com, body.central.inertia, body.central.frame
        both = placed((*placement.steps, *frame.steps))
        return central_body(body.mass, com, inertia, both, body.in_numbers)
    h, I = times(placement.R, body.first_moment), _in_parent(body.inertia, placement)
    return Body(body.mass, *_shifted(body.mass, h, I, placement.p), body.in_numbers)


def together(bodies: Iterable[Body]) -> Body:
    """Return several bodies in one frame as one; one alone stays as it was described."""
    bodies = [body for body in bodies if not _is_nothing(body)]
    if len(bodies) < 2:
        return bodies[0] if bodies else MASSLESS
    mass, h, I = bodies[0].mass, bodies[0].first_moment, bodies[0].inertia
    for body in bodies[1:]:
        mass, h, I = mass + body.mass, add(h, body.first_moment), sum_of(I, body.inertia)
    in_numbers = any(body.in_numbers for body in bodies)  # a payload may be added to them
    return Body(settled(mass), settled_vector(h), settled_matrix(I), in_numbers)


def _is_nothing(body: Body) -> bool:
    rows = (body.first_moment, *body.inertia)
    return body.mass == 0 and not any(x for row in rows for x in row) and body.in_numbers


def _body_of_quotients(m: Any, c: Vector, I: Matrix, frame: Placement) -> Body:
    """Return a body whose centre of mass or tensor is divided by symbols, as a rule by its mass.

    Its moments about the origin of the frame that they are given in, h = m c and I + m (c.c 1 - c
    c^T), often need no division: they are formed in lowest terms, and only then moved.
    """
    m, h, I = _cancelled(m), scaled(m, c), sum_of(I, _spread(m, c, c))
    h = times(frame.R, _vector(map(_cancelled, h)))
    I = _in_parent(_matrix(map(_cancelled, row) for row in I), frame)
    h, I = _shifted(m, h, I, frame.p)
    return Body(m, _vector(map(_cancelled, h)), _matrix(map(_cancelled, row) for row in I))


def _shifted(m: Any, h: Vector, I: Matrix, p: Vector) -> tuple[Vector, Matrix]:
    """Return first moment and tensor about an origin from which the old one is at p.

    h + m p,    I + m (p.p 1 - p p^T) + 2 h.p 1 - h p^T - p h^T.
    """
    for part in (_spread(m, p, p), _spread(1, h, p), _spread(1, p, h)):
        I = sum_of(I, part)
    return add(h, scaled(m, p)), I


def _cancelled(x: Any) -> Any:
    """Return an expression in lowest terms, if it is divided by fewer symbols then."""
    divisors = _divisors(x)
    if not divisors:
        return x
    lowest = sp.cancel(x)
    return lowest if _divisors(lowest) < divisors else x


def _divisors(x: Any) -> set[Any]:
    """Return the symbols that an expression is divided by."""
    if getattr(x, "is_Rational", True):
        return set()
    powers = x.atoms(sp.Pow)
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
