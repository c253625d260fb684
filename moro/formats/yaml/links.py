"""From what a robot file says to links of an ``Assembly``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import sympy

from moro.checks.tensors import matrix
from moro.formats import assembly
from moro.formats.assembly import Assembly, Motion, inverse, rpy, to_axis
from moro.formats.assembly.bodies import central_body
from moro.formats.assembly.bodies import moved as body_in
from moro.formats.assembly.steps import placed, settled_matrix
from moro.formats.yaml.coordinates import Moved, displacement, moved
from moro.formats.yaml.drives import driven
from moro.formats.yaml.meanings import meanings
from moro.formats.yaml.references import BASE, TOOL, references
from moro.formats.yaml.schema import Body, Link, Placed, RobotFile, is_row
from moro.model import (
    PRISMATIC,
    REVOLUTE,
    ROTOR,
    Coordinate,
    Parameter,
    Rotation,
    Shift,
    Turn,
)
from moro.model import Body as Weighed
from moro.model.placement import Step

_ZERO = sympy.Integer(0)
_NOTHING = (_ZERO, _ZERO, _ZERO)


def assembled(file: RobotFile) -> Assembly:
    """Return the links that ``file`` describes. Frames are links, too, that are fixed."""
    motions, _ = moved(file)
    called = references(file)
    links: list[assembly.Link] = []
    if file.base is not None:
        links.append(assembly.Link(BASE, None, steps(file.base)))
    number = 0
    for entry, motion, name, parent in zip(
        file.links, motions, called.names, called.parents, strict=True
    ):
        row = is_row(entry.model_fields_set, entry.joint)
        path = _row(entry, motion, file.convention) if row else _placed(entry, motion)
        links.append(assembly.Link(name, parent, path, tuple(_bodies(entry))))
        links += (assembly.Link(x, name, steps(frame)) for x, frame in entry.frames.items())
        number += motion is not None and entry.joint != "rotor"
        if motion is not None and row and name != str(number):  # frame i of the texts
            links.append(assembly.Link(str(number), name))
    if file.tool is not None:
        links.append(assembly.Link(TOOL, called.tool, steps(file.tool)))
    return Assembly(
        file.name,
        tuple(links),
        _coordinates(file, motions),
        file.gravity or _NOTHING,
        called.tip or None,
        _parameters(file, called.names),
        _not_set(file),
    )


def steps(placed: Placed) -> tuple[Step, ...]:
    """Return the elementary motions of a placement."""
    found: list[Step] = []
    for pose in placed.poses:
        if pose.xyz is not None:
            found.append(Shift(pose.xyz))
        if pose.rpy is not None:
            found += rpy(*pose.rpy)
        if pose.R is not None:
            found.append(Rotation(settled_matrix(pose.R)))
    return tuple(found)


def _placed(link: Link, motion: Moved | None) -> tuple[Step | Motion, ...]:
    """Return the way to a link that is placed, with its axis in its own frame."""
    turned = () if link.axis is None else to_axis(link.axis)
    return (*steps(link), *turned, *_motions(link, motion, _ZERO), *inverse(turned))


def _row(link: Link, motion: Moved | None, convention: str) -> tuple[Step | Motion, ...]:
    """Return a row: Rz(theta) Tz(d) Tx(a) Rx(alpha), or modified, Tx(a) Rx(alpha) before it."""
    twist = (Shift((link.a, _ZERO, _ZERO)), Turn("x", link.alpha))
    name, _ = displacement(link)
    own: list[Step | Motion] = []
    if motion is None or name == "d":
        own.append(Turn("z", link.theta))
    own += _motions(link, motion, link.d)
    if motion is None or link.joint == "revolute":
        own.append(Shift((_ZERO, _ZERO, link.d)))
    return (*own, *twist) if convention == "dh" else (*twist, *own)


def _motions(link: Link, motion: Moved | None, height: object) -> Iterator[Motion]:
    """Yield how a link moves; a helical one slides by ``height``, and while it turns by q."""
    if motion is None:
        return
    terms = tuple((f"q{k}", ratio) for k, ratio in motion.terms)
    name = link.joint_name or ""
    if link.joint == "prismatic":
        yield Motion(PRISMATIC, terms, motion.offset, name)
        return
    yield Motion(ROTOR if link.joint == "rotor" else REVOLUTE, terms, motion.offset, name)
    if link.joint == "helical":
        rise = link.pitch / (2 * sympy.pi)
        yield Motion(PRISMATIC, tuple((q, ratio * rise) for q, ratio in terms), height, name)


def _bodies(link: Link) -> Iterator[Weighed]:
    if link.mass is not None:
        yield _body(link)
    elif link.inertia is not None:  # of a rotor, whose mass is the parent's
        yield _body(link.model_copy(update={"mass": _ZERO, "com": _NOTHING}))
    for body in link.bodies or ():
        yield body_in(_body(body), placed(steps(body)))


def _body(body: Body) -> Weighed:
    inertia = settled_matrix(matrix(body.inertia))
    if body.com is not None and body.inertia_about == "com":
        return central_body(body.mass, body.com, inertia)
    x, y, z = body.first_moment or (body.mass * x for x in body.com or _NOTHING)
    return Weighed(body.mass, (x, y, z), inertia)


def _coordinates(file: RobotFile, motions: Iterable[Moved | None]) -> dict[str, Coordinate]:
    """Return the coordinates by their names, in order."""
    found: dict[int, Coordinate] = {}
    for link, motion in zip(file.links, motions, strict=True):
        if motion is None:
            continue
        for k in motion.own:
            alone = driven(link) if len(motion.own) == 1 else Coordinate()
            found[k] = driven(file.coordinates[k], alone) if k in file.coordinates else alone
    return {f"q{k}": found[k] for k in sorted(found)}


def _parameters(file: RobotFile, names: list[str]) -> tuple[Parameter, ...]:
    """Return the declared ones, and symbols that are not, with where they are."""
    where = meanings(file, names)
    symbols = {**file.parameters, **dict.fromkeys(where.keys() - file.parameters.keys())}
    return tuple(Parameter(symbol, x, where.get(symbol, "")) for symbol, x in symbols.items())


def _not_set(file: RobotFile) -> frozenset[str]:
    """Return the quantities that the file says nothing of."""
    entries = [*file.links, *file.coordinates.values()]
    frictions = (x.friction.model_fields_set for x in entries if x.friction is not None)
    rubbing = set[str]().union(*frictions)
    there = {
        "masses": any(link.mass is not None or link.bodies is not None for link in file.links),
        "rotor_inertias": any(
            x.rotor_inertia is not None or x.motor_inertia is not None for x in entries
        ),
        "viscous_friction": "viscous" in rubbing,
        "coulomb_friction": bool(rubbing & {"coulomb", "static"}),
    }
    there |= dict.fromkeys(("cm_positions", "inertia_tensors"), there["masses"])
    there["gravity"] = file.gravity is not None
    return frozenset(name for name, given in there.items() if not given)
