"""By which coordinates the joints of a robot file move.

A joint whose ``theta`` (or ``d``, where it slides) holds no joint variable moves by one of its own,
which is added there: the one after the highest of the joints before it. Where joint variables stand
in it, it is how far the joint moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import sympy
from sympy.core.function import AppliedUndef

from moro.abc import joint_variable
from moro.formats import coupling
from moro.formats.yaml.problems import Location
from moro.formats.yaml.schema import Driven, Link, RobotFile

_ZERO = sympy.Integer(0)

Found = list[tuple[Location, str]]


@dataclass(frozen=True)
class Moved:
    """A joint that moves by the sum of ratio q_k, and an offset."""

    #: (k, ratio): coordinates from 1
    terms: tuple[tuple[int, Any], ...]
    offset: Any
    #: those of its coordinates that no joint before it has
    own: tuple[int, ...]


def displacement(link: Link) -> tuple[str, Any]:
    """Return the field that says how far a joint moves, and what it says."""
    name = "d" if link.joint == "prismatic" else "theta"
    return name, getattr(link, name) or _ZERO


def moved(file: RobotFile) -> tuple[list[Moved | None], Found]:
    """Return how each link moves (None: it is fixed), and what is wrong with that."""
    found: list[Moved | None] = []
    wrong: Found = []
    known: set[int] = set()
    for i, link in enumerate(file.links):
        name, value = displacement(link)
        for other in ("d", "theta"):
            constant = getattr(link, other) or _ZERO
            if (link.joint == "fixed" or other != name) and constant.atoms(AppliedUndef):
                wrong.append((("links", i, other), f"must be constant, not {_text(constant)}"))
        if link.joint == "fixed":
            found.append(None)
            continue
        try:
            terms, offset = affine(value)
        except ValueError as error:
            wrong.append((("links", i, name), str(error)))
            terms, offset = {}, _ZERO
        terms = terms or {max(known, default=0) + 1: sympy.Integer(1)}
        own = tuple(k for k in terms if k not in known)
        known |= set(own)
        found.append(Moved(tuple(terms.items()), offset, own))
    wrong += _gaps(found, file) or _inseparable(found, file)
    wrong += _drives(found, file)
    return found, wrong


def affine(value: Any) -> tuple[dict[int, Any], Any]:
    """Return {k: ratio} and offset of a sum of ratio q_k and a constant. ValueError if it is none.

    Joint variables are q_k(t) of ``moro.abc``.
    """
    variables = sorted(value.atoms(AppliedUndef), key=lambda q: (len(q.func.__name__), str(q)))
    if not variables:
        return {}, value
    try:
        ratios, offset = coupling.affine(value, variables)
    except ValueError as error:
        raise ValueError(f"{error} {_text(value)}") from None
    return {_number(q): ratio for q, ratio in ratios.items()}, offset


def _number(q: Any) -> int:
    """Return k of q_k. ValueError for any other function."""
    name = q.func.__name__.removeprefix("q_")
    if not name.isdigit() or q != joint_variable(int(name)):
        raise ValueError(f"holds {q}; joint variables are q1, q2, .. of moro.abc")
    return int(name)


def _gaps(found: list[Moved | None], file: RobotFile) -> Found:
    """Find joint variables after one that moves nothing."""
    wrong: Found = []
    owner = {k: i for i, x in enumerate(found) if x is not None for k in x.own}
    missing = next(k for k in range(1, len(owner) + 2) if k not in owner)
    if beyond := [k for k in owner if k > missing]:
        i = owner[beyond[0]]
        message = (
            f"is moved by q{beyond[0]}, and no joint by q{missing}; number joint variables without"
            " gaps"
        )
        wrong.append((("links", i, displacement(file.links[i])[0]), message))
    wrong += (
        (("coordinates", f"q{k}"), "moves no joint") for k in file.coordinates if k not in owner
    )
    return wrong


def _inseparable(found: list[Moved | None], file: RobotFile) -> Found:
    """Find joint variables of which some motion moves nothing."""
    joints = [dict(x.terms) for x in found if x is not None]
    known = sorted({k for terms in joints for k in terms})
    if not known:
        return [(("links",), "no link moves; a robot has 1 joint at least")]
    if not (lost := coupling.inseparable(joints, known)):
        return []
    i = next(i for i, x in enumerate(found) if x is not None and {*lost} & {*dict(x.terms)})
    names = " and ".join(f"q{k}" for k in lost)
    where = ("links", i, displacement(file.links[i])[0])
    return [(where, f"{names} move joints only together; they are too many by one at least")]


def _drives(found: list[Moved | None], file: RobotFile) -> Iterator[tuple[Location, str]]:
    """Find drives at joints without a coordinate that is theirs alone, and such given twice."""
    for i, (x, link) in enumerate(zip(found, file.links, strict=True)):
        if x is None:
            continue
        given = [name for name in _DRIVEN if getattr(link, name) is not None]
        if given and len(x.own) != 1:
            names = " and ".join(f"q{k}" for k, _ in x.terms)
            yield (
                ("links", i, given[0]),
                f"is of a joint that {names} {'move' if len(x.terms) > 1 else 'moves'}, and not"
                " of a joint variable that is new here; give it there, or under `coordinates`",
            )
        both = file.coordinates.get(x.own[0]) if len(x.own) == 1 else None
        for name in given if both is not None else ():
            if getattr(both, name) is not None:
                where = ("coordinates", f"q{x.own[0]}", name)
                yield where, f"is given twice; first at links[{i + 1}]"


_DRIVEN = [name for name in Driven.model_fields if name != "joint_name"]


def _text(value: Any) -> str:
    """Return an expression as a file has it: q2 for q_2(t)."""
    names = {q: sympy.Symbol(q.func.__name__.replace("_", "")) for q in value.atoms(AppliedUndef)}
    return str(value.xreplace(names))
