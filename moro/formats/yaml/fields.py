"""Which fields of a robot file go together, and which do not.

All of it is seen from which fields there are, so that it is said together with what is wrong with
their values.
"""

from __future__ import annotations

from collections.abc import Iterator

from moro.formats.yaml.document import List, Scalar, Table
from moro.formats.yaml.problems import Location, missing
from moro.formats.yaml.schema import Driven, is_row

Found = Iterator[tuple[Location, str]]

_ALL_OR_NONE = "; leave out mass, com and inertia for all links or for none"
_BODY = ("mass", "com", "first_moment", "inertia")


def between(tree: Table) -> Found:
    """Yield the location and the description of each combination that means nothing."""
    for where in ("base", "tool"):
        if isinstance(place := tree.get(where), Table):
            yield from _placement(place, (where,))
    coordinates = tree.get("coordinates")
    for name, fields in coordinates.items() if isinstance(coordinates, Table) else ():
        if isinstance(fields, Table):
            yield from _drive(fields, ("coordinates", name))
    links = tree.get("links")
    entries = [
        (i, link)
        for i, link in enumerate(links if isinstance(links, List) else ())
        if isinstance(link, Table)
    ]
    dynamic = any(field in link for _, link in entries for field in (*_BODY, "bodies"))
    for i, link in entries:
        yield from _link(link, ("links", i), dynamic)


def _link(link: Table, at: Location, dynamic: bool) -> Found:
    joint = _word(link, "joint")
    fixed = joint == "fixed"
    if is_row(link, joint):
        yield from ((spot, missing(spot)) for spot in _absent(link, at, "a", "alpha", "d", "theta"))
    else:
        yield from _placed(link, at, joint)
    yield from _placement(link, at)
    if joint == "helical":
        yield from ((spot, missing(spot)) for spot in _absent(link, at, "pitch"))
    elif "pitch" in link:
        yield (*at, "pitch"), "is of a helical joint; leave it out"
    if fixed:
        for name in (*Driven.model_fields, "axis"):
            if name in link:
                yield (*at, name), "is of a joint that moves, and this one is fixed; leave it out"
    else:
        yield from _drive(link, at)
    if joint == "rotor" and "frames" in link:
        yield (*at, "frames"), "move with a link, and nothing is on a rotor; leave them out"
    needed = dynamic and not fixed and "bodies" not in link
    if joint == "rotor" and not any(name in link for name in ("mass", "com", "first_moment")):
        if needed and "inertia" not in link:
            yield (*at, "inertia"), missing((*at, "inertia"))
    else:
        yield from _body(link, at, needed, _ALL_OR_NONE)
    bodies = link.get("bodies")
    for i, body in enumerate(bodies if isinstance(bodies, List) else ()):
        if isinstance(body, Table):
            yield from _placement(body, (*at, "bodies", i))
            yield from _body(body, (*at, "bodies", i), True, "")
    frames = link.get("frames")
    for name, frame in frames.items() if isinstance(frames, Table) else ():
        if isinstance(frame, Table):
            yield from _placement(frame, (*at, "frames", name))


def _placed(link: Table, at: Location, joint: str) -> Found:
    """Find parts of a row at a joint that is given by a placement."""
    turning = dict.fromkeys(("revolute", "helical", "rotor"), "theta")
    moved = (turning | {"prismatic": "d"}).get(joint)
    for name in ("a", "alpha", "d", "theta"):
        if name in link and name != moved:
            yield (
                (*at, name),
                "is of a row of DH parameters, and this link is placed by `xyz`, `rpy` or `R`",
            )


def _placement(fields: Table, at: Location) -> Found:
    if "placement" in fields:
        for name in ("xyz", "rpy", "R"):
            if name in fields:
                yield (*at, name), "belongs into `placement`, where that is given"
    if "rpy" in fields and "R" in fields:
        yield (*at, "R"), "is given by `rpy` already; leave one of both out"
    poses = fields.get("placement")
    for i, pose in enumerate(poses if isinstance(poses, List) else ()):
        if isinstance(pose, Table):
            yield from _placement(pose, (*at, "placement", i))


def _body(fields: Table, at: Location, needed: bool, otherwise: str) -> Found:
    """Find what a body lacks; it needs nothing where it is not there."""
    if not needed and not any(name in fields for name in _BODY):
        return
    moment = "first_moment" in fields
    for spot in _absent(fields, at, "mass", *(() if moment else ("com",)), "inertia"):
        yield spot, missing(spot) + otherwise
    if moment and "com" in fields:
        yield (*at, "first_moment"), "is the mass times `com`; leave one of both out"
    if moment and _word(fields, "inertia_about") != "origin":
        yield (
            (*at, "inertia_about"),
            "missing; expected `origin`, about which the inertia is where `first_moment` is given",
        )


def _drive(fields: Table, at: Location) -> Found:
    friction = fields.get("friction")
    friction = friction if isinstance(friction, Table) else Table(None)
    geared = "motor_inertia" in fields or _word(friction, "side") == "motor"
    if "motor_inertia" in fields and "rotor_inertia" in fields:
        yield (*at, "motor_inertia"), "is `rotor_inertia`, before the gear; leave one of both out"
    if geared and "gear_ratio" not in fields:
        yield (
            (*at, "gear_ratio"),
            "missing; expected the turns of the motor for one of the joint",
        )
    if "gear_ratio" in fields and not geared:
        yield (
            (*at, "gear_ratio"),
            "counts for `motor_inertia`, and for `friction` with `side: motor`; neither is given",
        )
    if "rest" in fields and "stiffness" not in fields:
        yield (*at, "rest"), "is where a spring rests; expected its `stiffness` too"
    for name, other in (("static", "stribeck_velocity"), ("stribeck_velocity", "static")):
        if name in friction and other not in friction:
            yield (*at, "friction", name), f"needs `{other}` too"


def _absent(fields: Table, at: Location, *names: str) -> Iterator[Location]:
    return ((*at, name) for name in names if name not in fields)


def _word(fields: Table, name: str) -> str:
    """Return a word that a field says, in small letters; "" where it says none."""
    node = fields.get(name)
    word = node.text.lower() if isinstance(node, Scalar) else ""
    return {"r": "revolute", "p": "prismatic"}.get(word, word)
