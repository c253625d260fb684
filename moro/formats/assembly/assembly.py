"""Links, coordinates and gravity, put together to a Model."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from moro.checks.callers import outside
from moro.formats.assembly import bodies, drives, parts, tree
from moro.formats.assembly.links import Link, Motion
from moro.formats.assembly.obstacles import Obstacle
from moro.formats.assembly.steps import joined, placed
from moro.formats.errors import Problem
from moro.model import REVOLUTE, Body, Coordinate, Drive, Frame, Joint, Model, Parameter, Turn
from moro.model.placement import Step
from moro.spatial.vectors import Vector, times, transpose

_ZERO = sp.Integer(0)


@dataclass(frozen=True)
class Assembly:
    """A robot as texts and files describe it: links on links, in exact SymPy values.

    Links may come in any order. What is fixed together becomes one body of the Model; every link's
    frame stays known by its name.
    """

    name: str
    links: tuple[Link, ...]
    #: by name, in the order of q; those that move nothing are left out
    coordinates: Mapping[str, Coordinate]
    #: in the world, in which links without a parent are placed [m/s^2]
    gravity: Vector
    #: the link whose frame is the tip; by default the one that most links carry
    tip: str | None = None
    parameters: tuple[Parameter, ...] = ()
    #: by default, what no link and no drive has
    not_set: frozenset[str] | None = None
    #: what is to be said of it: (of what, what)
    notes: tuple[tuple[str, str], ...] = ()
    #: what joints do not hold, each for the parts of the robot that it concerns
    obstacles: tuple[Obstacle, ...] = ()

    def problems(self) -> list[Problem]:
        """Return what keeps this part of the robot from being a tree of joints."""
        links, moving = {link.name for link in self.links}, set(self._moving(self.links))
        return [x.problem for x in self.obstacles if x.is_in(links, moving)]

    def fixed(self, values: Mapping[str, Any]) -> Assembly:
        """Return the robot with coordinates that stand still, {name: value [rad or m]}.

        ValueError for a name that is no coordinate's, with the nearest one.
        """
        if not values:
            return self
        for name, x in values.items():
            self._coordinate(name)
            self._warn_beyond(name, x)
        shown = ", ".join(f"{name} = {x}" for name, x in values.items())
        return replace(
            self,
            links=tuple(parts.held(self.links, values)),
            coordinates={q: x for q, x in self.coordinates.items() if q not in values},
            notes=(*self.notes, ("fixed", shown)),
        )

    def part(self, root: str | None = None, tip: str | Sequence[str] | None = None) -> Assembly:
        """Return what is on the link ``root``, up to the link (or links) ``tip``.

        The frame of root is frame 0 then; joints before it stand still, at zero, and gravity is
        turned into its axes. Of links off the way to the tips, those that are fixed to it stay;
        what moves there is left out, and so is what is on a tip. ValueError for what is no link, or
        no link on root.
        """
        found, gravity, notes = [*self.links], self.gravity, self.notes
        tips = [tip] if isinstance(tip, str) else [*(tip or ())]
        there = tree.by_name(found)
        for name in tips:
            tree.known(name, there, "tip", "no link")
        if root is not None:
            found, steps = parts.tree_on(found, root)
            gravity = times(transpose(placed(steps).R), gravity)
        if tips:
            names = {link.name for link in found}
            for name in tips:
                if name not in names:
                    raise ValueError(f"tip: {name} is not on {root}, which is to be the root")
            found = parts.chains_to(found, tips)
        if len(found) < len(self.links):
            left_out = len(self.links) - len(found)
            notes = (*notes, ("part", f"{len(found)} links, without {left_out} others"))
        end = tips[-1] if tips else self.tip
        return replace(
            self,
            links=tuple(found),
            gravity=gravity,
            tip=end if end in {link.name for link in found} else None,
            notes=notes,
        )

    def model(self) -> Model:
        """Return the tree of joints and bodies. ValueError for what is no tree, or has no joint."""
        links = sorted(tree.parents_first(self.links), key=lambda link: link.spins)
        order = self._moving(links)
        built = _Build({name: j for j, name in enumerate(order)})
        for link in links:
            built.add(link)
        if not built.joints:
            raise ValueError(f"{self.name} has no joint that moves")
        coordinates = [self._driven(name, links) for name in order]
        absent = _absent([x.drive for x in coordinates], built.carried)
        return Model(
            name=self.name,
            joints=tuple(built.joints),
            bodies=tuple(map(bodies.together, built.carried)),
            gravity=self.gravity,
            coordinates=tuple(coordinates),
            frames=self._frames(built, links),
            parameters=self.parameters,
            not_set=absent if self.not_set is None else self.not_set,
        )

    def _moving(self, links: Iterable[Link]) -> list[str]:
        """Return the names of the coordinates that move something, in their order."""
        used = set()
        for link in links:
            for motion in link.motions:
                for q, ratio in motion.terms:
                    if q not in self.coordinates:
                        self._coordinate(q)
                    if ratio != 0:
                        used.add(q)
        return [name for name in self.coordinates if name in used]

    def _coordinate(self, name: Any) -> str:
        return tree.known(name, self.coordinates, "joint", f"no joint of {self.name} that moves")

    def _warn_beyond(self, name: str, x: Any) -> None:
        """Warn of a joint that is to stand still where it cannot go."""
        limits = self.coordinates[name].limits
        if limits is not None and x.is_number and not limits[0] <= x <= limits[1]:
            lower, upper = (f"{float(bound):g}" for bound in limits)
            message = f"{name} is fixed at {float(x):g}, beyond its limits {lower}..{upper}"
            warnings.warn(message, UserWarning, stacklevel=outside())

    def _driven(self, name: str, links: Iterable[Link]) -> Coordinate:
        """Return a coordinate with the drives of the joints that it moves."""
        coordinate = self.coordinates[name]
        found = [coordinate.drive]
        for motion in (motion for link in links for motion in link.motions):
            ratios = _ratios(motion)
            if motion.drive == drives.NONE or name not in ratios:
                continue
            if len(ratios) > 1:
                raise ValueError(
                    f"friction and rotor of joint {motion.name}, which {' and '.join(ratios)} move"
                    " together, are given at these coordinates, not at the joint"
                )
            what = f"joint {motion.name}"
            found.append(drives.folded(motion.drive, ratios[name], motion.offset, what))
        drive = drives.together(found, f"coordinate {name}")
        return replace(coordinate, drive=drive, name=coordinate.name or name)

    def _frames(self, built: _Build, links: list[Link]) -> tuple[Frame, ...]:
        """Return every link's frame, the tip's last."""
        tip = self.tip
        if tip is None:
            depth: dict[str | None, tuple[int, int]] = {None: (0, 0)}
            for link in links:
                joints, count = depth[link.parent]
                depth[link.name] = joints + len(link.motions), count + 1
            carrying = [link.name for link in links if not link.spins]
            if not carrying:
                return ()
            tip = max(reversed(carrying), key=depth.__getitem__)
        last = next(frame for frame in built.frames if frame.name == tip)
        return (*(frame for frame in built.frames if frame is not last), last)


@dataclass
class _Build:
    """What is built, link by link, parents first."""

    #: index of each coordinate, by name
    order: Mapping[str, int]
    joints: list[Joint] = field(default_factory=list)
    #: the bodies that each joint carries, in its frame
    carried: list[list[Body]] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    #: of each link: its joint, and the steps to the link from the joint's frame
    where: dict[str | None, tuple[int, tuple[Step, ...]]] = field(
        default_factory=lambda: {None: (-1, ())}
    )

    def add(self, link: Link) -> None:
        index, steps = self.where[link.parent]
        for step in link.path:
            if not isinstance(step, Motion):
                steps = (*steps, step)
            elif terms := _ratios(step):
                index, steps = self._joint(index, steps, step, terms), ()
            else:
                steps = (*steps, parts.still(step, step.offset))
        steps = joined(steps)
        self.where[link.name] = index, steps
        placement = placed(steps)
        if not link.spins:
            self.frames.append(Frame(link.name, index, placement))
        if index >= 0:
            self.carried[index] += (bodies.moved(body, placement) for body in link.bodies)

    def _joint(
        self, parent: int, steps: tuple[Step, ...], motion: Motion, ratios: Mapping[str, Any]
    ) -> int:
        """Add a joint. A turn about z just before it, unless it costs nothing, is in its offset."""
        steps, offset = joined(steps), motion.offset
        if motion.type == REVOLUTE and (angle := _last_turn_about_z(steps)) is not None:
            steps, offset = steps[:-1], offset + angle
        terms = tuple((self.order[q], ratio) for q, ratio in ratios.items())
        self.joints.append(Joint(motion.type, parent, placed(steps), offset, terms, motion.name))
        self.carried.append([])
        return len(self.joints) - 1


def _absent(drives: Sequence[Drive], carried: Iterable[list[Body]]) -> frozenset[str]:
    """Return what no drive and no link has, by the names of ``Model.not_set``."""
    there = {
        "rotor_inertias": any(x.rotor_inertia != 0 for x in drives),
        "viscous_friction": any(x.viscous != 0 for x in drives),
        "coulomb_friction": any(x.coulomb != (0, 0) or x.static for x in drives),
        **dict.fromkeys(("masses", "cm_positions", "inertia_tensors"), any(carried)),
    }
    return frozenset(name for name, given in there.items() if not given)


def _last_turn_about_z(steps: Sequence[Step]) -> Any:
    """Return the angle of the last step if it turns about z other than by quarters, or None."""
    last = steps[-1] if steps else None
    if not isinstance(last, Turn) or last.axis != "z" or (last.angle * 2 / sp.pi).is_Integer:
        return None
    return last.angle


def _ratios(motion: Motion) -> dict[str, Any]:
    """Return {coordinate: ratio} of a motion, without those that cancel."""
    found: dict[str, Any] = {}
    for q, ratio in motion.terms:
        found[q] = found.get(q, _ZERO) + ratio
    return {q: ratio for q, ratio in found.items() if ratio != 0}
