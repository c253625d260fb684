"""A robot as a robot file: rows of DH parameters as rows, links as links."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from moro.formats import names
from moro.formats.assembly import Assembly, Link, Motion
from moro.formats.assembly.tree import parents_first
from moro.formats.yaml.placements import Row, Z, axis, poses, row
from moro.formats.yaml.references import BASE, TOOL
from moro.formats.yaml.text import Values, document, word
from moro.model import REVOLUTE, Body, Coordinate, Drive, Model, Shift
from moro.model.placement import Step

_ZERO = sp.Integer(0)

Fields = dict[str, Any]
#: constant steps, how a link moves after them, and constant steps
Path = tuple[tuple[Step, ...], tuple[Motion, ...], tuple[Step, ...]]


def text(robot: Assembly, model: Model) -> str:
    """Return the file of a robot, whose ``model`` has all its parameters.

    ValueError for a value that no file can hold.
    """
    writer = _Writer(robot, model)
    comments = [f"# {own}: {symbol}" for own, symbol in writer.values.renamed.items()]
    return "\n".join([*comments, document(writer.file())])


class _Writer:
    def __init__(self, robot: Assembly, model: Model):
        self.model = model
        self.values = Values(parameter.symbol for parameter in model.parameters)
        links = [link for link in parents_first(robot.links) if not _is_number(link)]
        self.convention = model.convention or _convention(links)
        self.links = [part for link in links for part in _simple(link, self.convention)]
        moving = {q for link in links for m in link.motions for q, r in m.terms if r != 0}
        order = (q for q in robot.coordinates if q in moving)
        #: the number of each coordinate, by its name
        self.numbers = {q: k for k, q in enumerate(order, 1)}
        #: how links are referred to: by names, or by numbers
        self.called: dict[str | None, str] = {None: "0"}
        #: the link of the entry before, and how many moved, and stood still, until there
        self.last: str | None = None
        self.moving = self.still = self.spinning = 0
        #: the coordinates of the entries until there
        self.known: set[str] = set()
        #: those that are new in the entry at hand
        self.fresh: list[str] = []
        #: those that a joint has to itself, and the name of that joint
        self.said: dict[str, str] = {}

    def file(self) -> Fields:
        """Return the whole file."""
        model = self.model
        fields: Fields = {"name": names.identifier(model.name)}
        if self.convention:
            fields["convention"] = self.convention
        fields["gravity"] = "~" if "gravity" in model.not_set else self.list(model.gravity)
        if model.parameters:
            fields["parameters"] = {
                self.values.symbols[x.symbol].name: self.default(x.default)
                for x in model.parameters
            }
        base = next((x for x in self.links if _is_base(x)), None)
        if base is not None and all(x.parent is not None for x in self.links if x is not base):
            fields["base"] = self.placement(base.path) or self.nowhere
            self.called[BASE] = BASE
            self.last = BASE
            self.links.remove(base)
        frames = self.frames()
        entries = [
            self.entry(link, [x for x in frames if x.parent == link.name])
            for link in self.links
            if link not in frames
        ]
        tip = model.tip.name
        if tool := next((x for x in frames if x.name == TOOL == tip), None):
            where = {} if tool.parent == self.last else {"link": self.called[tool.parent]}
            fields["tool"] = where | (self.placement(tool.path) or self.nowhere)
        elif tip != self.last and tip in {*self.called, *(x.name for x in frames)}:
            fields["tip"] = self.called.get(tip, word(tip))
        apart = {f"q{k}": self.apart(q) for q, k in self.numbers.items()}
        if apart := {q: said for q, said in apart.items() if said}:
            fields["coordinates"] = apart
        return fields | {"links": entries}

    def frames(self) -> list[Link]:
        """Return links that are but frames of the link that they follow, and the tool."""
        carrying = {link.parent for link in self.links}
        found: list[Link] = []
        at: str | None = None
        for link in self.links:
            bare = not link.motions and not link.bodies and link.name not in carrying
            tool = link.name == TOOL == self.model.tip.name and link.parent is not None
            if bare and (tool or (link.parent is not None and link.parent == at)):
                found.append(link)
            else:
                at = link.name
        return found

    # -- links ------------------------------------------------------------------------------------

    def entry(self, link: Link, frames: Iterable[Link]) -> Fields:
        """Return what is said of a link, and of the frames on it."""
        before, motions, after = _path(link)
        fields: Fields = {"joint": _kind(motions)}
        own = self.number(link)
        unnamed = link.name.startswith(_UNNAMED) or (link.spins and link.name.isdigit())
        if link.name != own and not unnamed:
            fields["name"] = word(link.name if not link.name.isdigit() else f"link_{link.name}")
        if link.parent != self.last:
            fields["parent"] = self.called[link.parent]
        if motions and motions[0].name:
            fields["joint_name"] = word(motions[0].name)
        found = None
        if not link.spins:
            self.called[link.name] = fields.get("name", own)
            self.last = link.name
            found = row(before, after, bool(motions), self.convention) if self.convention else None
        if found is not None:
            fields |= self.row(found, motions)
        else:
            fields |= self.placed(before, motions, after)
        fields |= self.bodies(link, bool(motions))
        if on := {
            word(x.name): self.placement(x.path) or self.nowhere
            for x in frames
            if not x.name == TOOL == self.model.tip.name
        }:
            fields["frames"] = on
        return fields | self.drive(motions)

    def number(self, link: Link) -> str:
        """Return what a link is called that has no name."""
        if link.spins:
            self.spinning += 1
            return f"rotor_{self.spinning}"
        if link.motions:
            self.moving += 1
            return str(self.moving)
        self.still += 1
        return f"fixed_{self.still}"

    def row(self, found: Row, motions: Sequence[Motion]) -> Fields:
        """Return a row; the joint variable is in what it is added to."""
        fields = {name: self.values(getattr(found, name)) for name in ("a", "alpha", "d", "theta")}
        if motions:
            moved = "theta" if _turns(motions) else "d"
            offset = getattr(found, moved) + motions[0].offset
            fields[moved] = self.displacement(motions[0], offset)
        if len(motions) > 1:
            fields["d"] = self.values(found.d + motions[1].offset)
        return fields | self.pitch(motions)

    def placed(
        self, before: tuple[Step, ...], motions: Sequence[Motion], after: tuple[Step, ...]
    ) -> Fields:
        """Return the placement of a link that is on its axis, and how it moves."""
        if not motions:
            return self.placement(before)
        if len(motions) > 1 and (height := motions[1].offset) != 0:
            before = (*before, Shift((_ZERO, _ZERO, height)))
        direction, steps = axis(before, after) or (Z, before)
        fields = self.placement(steps)
        if direction != Z or not fields:
            fields["axis"] = _letter(direction) or self.list(direction)
        offset = motions[0].offset
        if (said := self.displacement(motions[0], offset)) != "0":
            fields["theta" if _turns(motions) else "d"] = said
        return fields | self.pitch(motions)

    def displacement(self, motion: Motion, offset: Any) -> str:
        """Return how far a joint moves: of a coordinate of its own, the next one, the offset."""
        terms = {q: ratio for q, ratio in motion.terms if ratio != 0}
        numbers = [self.numbers[q] for q in self.known]
        following = max(numbers, default=0) + 1
        self.fresh = [q for q in terms if q not in self.known]
        self.known |= set(terms)
        if {self.numbers[q]: ratio for q, ratio in terms.items()} == {following: 1}:
            return self.values(offset)
        variables = (ratio * _variable(self.numbers[q]) for q, ratio in terms.items())
        return self.values(sum(variables, offset))

    def pitch(self, motions: Sequence[Motion]) -> Fields:
        if len(motions) < 2:
            return {}
        turn, slide = (dict(motion.terms) for motion in motions)
        return {"pitch": self.values(_pitch(turn, slide))}

    def placement(self, steps: Sequence[Any]) -> Fields:
        """Return a placement: one pose, or several."""
        found = [self.pose(pose) for pose in poses(steps)]
        return found[0] if len(found) == 1 else {"placement": found} if found else {}

    def pose(self, pose: Fields) -> Fields:
        rows = {name: self.list(x) for name, x in pose.items() if name != "R"}
        return rows | {name: [*map(self.list, x)] for name, x in pose.items() if name == "R"}

    @property
    def nowhere(self) -> Fields:
        return {"xyz": self.list((_ZERO,) * 3)}

    # -- bodies and drives ------------------------------------------------------------------------

    def bodies(self, link: Link, moves: bool) -> Fields:
        """Return the bodies of a link: the first as the link's own, if it is in its frame."""
        if "masses" in self.model.not_set:
            return {}
        first, *others = [self.body(body, link.spins) for body in link.bodies] or [{}]
        if set(first) & {"xyz", "rpy", "R", "placement"}:
            first, others = {}, [first, *others]
        if not first and (others or moves):
            return {"bodies": others}
        return first | ({"bodies": others} if others else {})

    def body(self, body: Body, spins: bool = False) -> Fields:
        if body.mass == 0 and body.central is not None and spins and not any(body.central.com):
            return {"inertia": self.tensor(body.central.inertia)}
        fields: Fields = {"mass": self.values(body.mass)}
        if body.central is None:
            fields["first_moment"] = self.list(body.first_moment)
            fields["inertia"] = self.tensor(body.inertia)
            return fields | {"inertia_about": "origin"}
        fields["com"] = self.list(body.central.com)
        fields["inertia"] = self.tensor(body.central.inertia)
        return fields | self.placement(body.central.frame.steps)

    def tensor(self, I: Sequence[Sequence[Any]]) -> Any:
        """Return the diagonal of a tensor, or its entries by name."""
        products = {"xy": I[0][1], "xz": I[0][2], "yz": I[1][2]}
        moments = {"xx": I[0][0], "yy": I[1][1], "zz": I[2][2]}
        if not any(products.values()):
            return self.list(moments.values())
        named = moments | {name: x for name, x in products.items() if x != 0}
        return {name: self.values(x) for name, x in named.items()}

    def drive(self, motions: Sequence[Motion]) -> Fields:
        """Return what is said of the coordinate that a joint has to itself, if it has."""
        if not motions or len(self.fresh) != 1:
            return {}
        self.said[self.fresh[0]] = motions[0].name
        return self.driven(self.fresh[0])

    def apart(self, q: str) -> Fields:
        """Return what is said of a coordinate, and not where a joint has it to itself."""
        x: Coordinate = self.model.coordinates[self.numbers[q] - 1]
        named = x.name in ("", f"q{self.numbers[q]}", self.said.get(q))
        fields = {} if named else {"joint_name": word(x.name)}
        return fields if q in self.said else fields | self.driven(q)

    def driven(self, q: str) -> Fields:
        """Return the drive and the limits of a coordinate."""
        k = self.numbers[q]
        x: Coordinate = self.model.coordinates[k - 1]
        fields: Fields = {}
        drive, first = x.drive, k == 1
        if drive.rotor_inertia != 0 or (first and self.is_zero("rotor_inertias")):
            fields["rotor_inertia"] = self.values(drive.rotor_inertia)
        if friction := self.friction(drive, first):
            fields["friction"] = friction
        if drive.stiffness != 0:
            fields["stiffness"] = self.values(drive.stiffness)
            if drive.rest != 0:
                fields["rest"] = self.values(drive.rest)
        return fields | ({} if x.limits is None else {"limits": self.list(x.limits)})

    def friction(self, drive: Drive, first: bool) -> Fields:
        fields: Fields = {}
        if drive.viscous != 0:
            fields["viscous"] = self.values(drive.viscous)
        if any(x != 0 for x in drive.coulomb):
            fields["coulomb"] = self.both_ways(drive.coulomb)
        if drive.static is not None:
            fields["static"] = self.both_ways(drive.static)
            fields["stribeck_velocity"] = self.values(drive.stribeck_velocity)
        if drive.width is not None:
            fields["smooth"] = self.values(drive.width)
        if first and self.is_zero("viscous_friction"):
            fields["viscous"] = "0"
        return fields

    def is_zero(self, quantity: str) -> bool:
        """Whether a quantity of drives is given, and zero everywhere."""
        name = {"rotor_inertias": "rotor_inertia", "viscous_friction": "viscous"}[quantity]
        given = quantity not in self.model.not_set
        return given and all(getattr(x.drive, name) == 0 for x in self.model.coordinates)

    def both_ways(self, pair: tuple[Any, Any]) -> Any:
        return self.values(pair[0]) if pair[0] == pair[1] else self.list(pair)

    def default(self, x: Any) -> str:
        return "~" if x is None else self.values(x)

    def list(self, values: Iterable[Any]) -> list[str]:
        return [self.values(x) for x in values]


# -- links that an entry can hold -----------------------------------------------------------------

#: how the names of links begin that are made here
_UNNAMED = "\0"


def _simple(link: Link, convention: str) -> Iterator[Link]:
    """Yield a link as several that are rows, or placed on their axes."""
    *inner, (before, motions, after) = _paths(link)
    parent = link.parent
    for k, (steps, moves, _) in enumerate(inner):
        name = f"{_UNNAMED}{link.name}{_UNNAMED}{k}"
        yield Link(name, parent, (*steps, *moves))
        parent = name
    fits = not motions or link.spins or axis(before, after) is not None
    if fits or (convention and row(before, after, bool(motions), convention) is not None):
        yield replace(link, parent=parent, path=(*before, *motions, *after))
        return
    name = f"{_UNNAMED}{link.name}"
    yield Link(name, parent, (*before, *motions))
    yield replace(link, parent=name, path=after)


def _paths(link: Link) -> list[Path]:
    """Return the path of a link in parts with one motion, or a helical pair, in each."""
    found: list[Path] = []
    before: tuple[Step, ...] = ()
    motions: tuple[Motion, ...] = ()
    after: tuple[Step, ...] = ()
    for step in link.path:
        if not isinstance(step, Motion):
            before, after = (before, (*after, step)) if motions else ((*before, step), after)
        elif not motions or (not after and _is_helical(motions, step)):
            motions = (*motions, step)
        else:
            found.append((before, motions, ()))
            before, motions, after = after, (step,), ()
    return [*found, (before, motions, after)]


def _path(link: Link) -> Path:
    (only,) = _paths(link)
    return only


def _is_helical(motions: Sequence[Motion], step: Motion) -> bool:
    """Whether a slide goes with a turn as that of a helical joint does."""
    if len(motions) != 1 or motions[0].type != REVOLUTE or step.type == REVOLUTE:
        return False
    turn, slide = dict(motions[0].terms), dict(step.terms)
    return turn.keys() == slide.keys() and all(
        sp.simplify(slide[q] * turn[next(iter(turn))] - turn[q] * slide[next(iter(turn))]) == 0
        for q in turn
    )


def _pitch(turn: dict[str, Any], slide: dict[str, Any]) -> Any:
    q = next(iter(turn))
    return sp.simplify(2 * sp.pi * slide[q] / turn[q])


def _kind(motions: Sequence[Motion]) -> str:
    if len(motions) > 1:
        return "helical"
    return motions[0].type.name if motions else "fixed"


def _turns(motions: Sequence[Motion]) -> bool:
    return motions[0].type.is_angle


def _is_number(link: Link) -> bool:
    """Whether a link is but the number of its parent, as readers of rows add it."""
    return link.name.isdigit() and not (link.path or link.bodies) and link.parent is not None


def _is_base(link: Link) -> bool:
    """Whether a link is a frame in the world that others are on."""
    return link.name == BASE and link.parent is None and not (link.motions or link.bodies)


def _convention(links: Iterable[Link]) -> str:
    """Return the convention in which most links are rows that are not on their axes; "" if none."""
    last = [_paths(link)[-1] for link in links]
    off = [path for path in last if path[1] and axis(path[0], path[2]) is None]
    rows = {
        convention: sum(
            row(before, after, True, convention) is not None for before, _, after in off
        )
        for convention in ("dh", "mdh")
    }
    best = max(rows, key=rows.__getitem__)
    return best if rows[best] else ""


def _letter(direction: Sequence[Any]) -> str:
    """Return the name of an axis of the frame, or ""."""
    for name, x in zip("xyz", direction, strict=True):
        if abs(x) == 1 and sum(map(abs, direction)) == 1:
            return name if x > 0 else f"-{name}"
    return ""


def _variable(k: int) -> Any:
    from moro.abc import joint_variable

    return joint_variable(k)
