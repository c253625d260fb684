"""From MuJoCo's specification and model to links that can be put together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from moro.checks.constants import RANGE, is_sane
from moro.formats.assembly import Assembly, Link, Motion, Obstacle, inverse, placed, to_axis
from moro.formats.assembly.bodies import central_body
from moro.formats.errors import Problem
from moro.formats.mjcf.couplings import followed
from moro.formats.mjcf.obstacles import Tree
from moro.formats.mjcf.specification import bodies, line_of
from moro.formats.mjcf.values import Meaning, Said, number, numbers, position, vector
from moro.model import PRISMATIC, REVOLUTE, Body, Coordinate, Drive, Shift
from moro.model.placement import Step
from moro.spatial.vectors import Matrix, product, transpose

_ZERO, _ONE = sp.Integer(0), sp.Integer(1)
_FREE = (
    "moves freely: a floating base is a matter of its own, yet to come; load what stands on it with"
    " root={name}"
)
#: by MuJoCo's principal axes, of a tensor; before version 4
_MISSED = 1e-6
_BALL = "turns about three axes at once, by a ball: joints of one axis are read"


@dataclass(frozen=True)
class Motor:
    """What actuators add at a joint, behind their gears."""

    inertia: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class Compiled:
    """What MuJoCo made of a file, and what the file says."""

    mujoco: Any
    spec: Any
    model: Any
    tree: Tree
    #: by joint
    motors: Mapping[str, Motor]
    meaning: Meaning

    @property
    def bodies(self) -> list[Any]:
        """The bodies of the robot, parents first."""
        there = (body for body, _ in bodies(self.spec.worldbody))
        return [body for body in there if body.name not in self.tree.objects]

    def is_off(self, *names: str) -> bool:
        """Whether the file switches one of these off: "GRAVITY", ..., as MuJoCo calls them."""
        bits = self.mujoco.mjtDisableBit
        flags = int(self.model.opt.disableflags)
        return any(flags & int(getattr(bits, f"mjDSBL_{x}", 0)) for x in names)


def build(name: str, found: Compiled) -> Assembly:
    """Return the robot of a model."""
    links: list[Link] = []
    coordinates: dict[str, Coordinate] = {}
    for body in found.bodies:
        links.append(_link(body, found))
        coordinates.update(_coordinates(body, found))
    frames = {link.name for link in links}
    for body in found.bodies:
        links += _sites(body, found, frames)
    gravity = [_ZERO] * 3 if found.is_off("GRAVITY") else numbers(found.model.opt.gravity)
    x, y, z = gravity
    obstacles = (*found.tree.obstacles, *_obstacles(found))
    return Assembly(name, tuple(links), coordinates, (x, y, z), obstacles=obstacles)


def problems(assembly: Assembly) -> Iterator[Problem]:
    """Yield numbers that are beyond any size."""
    for link in assembly.links:
        values: list[Any] = []
        for step in link.path:
            if isinstance(step, Shift):
                values += step.p
            elif isinstance(step, Motion):
                values += step.drive.scalars
        for body in link.bodies:
            values += [body.mass, *body.first_moment, *(x for row in body.inertia for x in row)]
        if not all(is_sane(sp.sympify(x)) for x in values):
            message = f"expected 0 or numbers within {RANGE} in size"
            yield Problem(None, f"body {link.name}", message)


# -- links ----------------------------------------------------------------------------------------


def _link(body: Any, found: Compiled) -> Link:
    if body.name == "world":
        return Link(body.name, None)
    k = body.id
    shift = Shift(vector(found.model.body_pos[k], body.pos))
    turns = found.meaning.rotation(
        found.model.body_quat[k], _said(body, found, found.model.body_quat[k], body.quat, body.alt)
    )
    path: list[Step | Motion] = [shift, *turns]
    for joint in body.joints:
        path += _moved(joint, found)
    return Link(body.name, body.parent.name, tuple(path), _bodies(body, found))


def _sites(body: Any, found: Compiled, taken: set[str]) -> Iterator[Link]:
    """Yield the frames of sites that have names."""
    for site in body.sites:
        if not site.name:
            continue
        name = site.name if site.name not in taken else f"{site.name}_site"
        if name in taken:
            continue
        taken.add(name)
        model, k = found.model, site.id
        quat = model.site_quat[k]
        turns = found.meaning.rotation(quat, _said(site, found, quat, site.quat, site.alt))
        yield Link(name, body.name, (Shift(vector(model.site_pos[k], site.pos)), *turns))


def _said(element: Any, found: Compiled, quat: Any, given: Any, alt: Any) -> Said:
    """Return how the file gives a rotation."""
    kinds, kind = found.mujoco.mjtOrientation, alt.type
    if kind == kinds.mjORIENTATION_QUAT:
        return Said.by_quaternion(given, quat)
    is_plain = element.frame is None and not found.spec.compiler.degree
    if is_plain and kind == kinds.mjORIENTATION_EULER:
        return Said.by_angles(alt.euler)
    if is_plain and kind == kinds.mjORIENTATION_AXISANGLE:
        return Said.by_angles(alt.axisangle[3:])
    return Said()


# -- joints ---------------------------------------------------------------------------------------


def _moved(joint: Any, found: Compiled) -> Sequence[Step | Motion]:
    """Return a motion about or along an axis through an anchor in the frame of the body."""
    kinds, model, k = found.mujoco.mjtJoint, found.model, joint.id
    if joint.type not in (kinds.mjJNT_HINGE, kinds.mjJNT_SLIDE):
        return ()
    turn = to_axis(found.meaning.direction(model.jnt_axis[k], joint.axis))
    is_hinge = joint.type == kinds.mjJNT_HINGE
    x, y, z = vector(model.jnt_pos[k], joint.pos) if is_hinge else (_ZERO, _ZERO, _ZERO)
    q, ratio, offset = followed(joint.name, found.tree.couplings)
    terms = ((q, ratio),) if q is not None else ()
    if q is not None:
        offset -= ratio * _rest(q, found)
    drive = _drive(joint, found)
    motion = Motion(REVOLUTE if is_hinge else PRISMATIC, terms, offset, joint.name, drive)
    return Shift((x, y, z)), *turn, motion, *inverse(turn), Shift((-x, -y, -z))


def _rest(name: str, found: Compiled) -> Any:
    """Return the position of a joint in which its body is where the file places it (ref)."""
    joint, model = found.spec.joint(name), found.model
    return _position(model.qpos0[model.jnt_qposadr[joint.id]], joint, found)


def _drive(joint: Any, found: Compiled) -> Drive:
    """Return what acts at a joint: armature, damping, dry friction, spring."""
    model, motor = found.model, found.motors.get(joint.name, Motor())
    dof, at = model.jnt_dofadr[joint.id], model.jnt_qposadr[joint.id]
    stiffness = 0.0 if found.is_off("SPRING", "PASSIVE") else model.jnt_stiffness[joint.id]
    damping = model.dof_damping[dof] + motor.damping
    dry = 0.0 if found.is_off("FRICTIONLOSS", "CONSTRAINT") else model.dof_frictionloss[dof]
    friction, at_rest = _positive(dry), _position(model.qpos_spring[at], joint, found)
    return Drive(
        rotor_inertia=_positive(model.dof_armature[dof] + motor.inertia),
        viscous=_positive(0.0 if found.is_off("DAMPER", "PASSIVE") else damping),
        coulomb=(friction, friction),
        stiffness=_positive(stiffness),
        rest=at_rest - _rest(joint.name, found) if stiffness else _ZERO,
    )


def _positive(x: float) -> Any:
    return number(x, abs(float(x)))


def _position(x: float, joint: Any, found: Compiled) -> Any:
    return position(x, joint.type == found.mujoco.mjtJoint.mjJNT_HINGE)


def _coordinates(body: Any, found: Compiled) -> Iterator[tuple[str, Coordinate]]:
    """Yield the coordinates that the joints of a body bring, with their limits."""
    kinds, model = found.mujoco.mjtJoint, found.model
    for joint in body.joints:
        is_driven = joint.name in found.tree.couplings
        if is_driven or joint.type not in (kinds.mjJNT_HINGE, kinds.mjJNT_SLIDE):
            continue
        limits = None
        if model.jnt_limited[joint.id]:
            lower, upper = (_position(x, joint, found) for x in model.jnt_range[joint.id])
            limits = (lower, upper)
        yield joint.name, Coordinate(limits=limits, name=joint.name)


def _obstacles(found: Compiled) -> Iterator[Obstacle]:
    """Yield what is no joint of one axis, and springs and dampers that are no lines."""
    kinds, model, tree = found.mujoco.mjtJoint, found.model, found.tree
    for body in found.bodies:
        for joint in body.joints:
            of, links = f"body {body.name}", (body.parent.name, body.name)
            line = line_of(joint, tree.has_parts) or line_of(body, tree.has_parts)
            if joint.type == kinds.mjJNT_FREE:
                yield Obstacle(Problem(line, of, _FREE.format(name=repr(body.name))), links)
            elif joint.type == kinds.mjJNT_BALL:
                yield Obstacle(Problem(line, of, _BALL), links)
            elif bent := _bent(joint, model):
                message = f"its {bent}, which is not read: only what is linear is"
                q, _, _ = followed(joint.name, tree.couplings)
                if q is not None:
                    yield Obstacle(Problem(line, f"joint {joint.name}", message), links, (q,))


def _bent(joint: Any, model: Any) -> str:
    """Say what of a joint's spring or damper is not linear."""
    k, dof = joint.id, model.jnt_dofadr[joint.id]
    for array, at, words in (
        ("jnt_stiffnesspoly", k, "spring gets stiffer on the way"),
        ("dof_dampingpoly", dof, "damping grows with speed"),
        ("jnt_springyield", k, "spring yields"),
    ):
        if np.any(getattr(model, array, np.zeros(model.nv + model.njnt))[at]):
            return words
    return ""


# -- bodies ---------------------------------------------------------------------------------------


def _bodies(body: Any, found: Compiled) -> tuple[Body, ...]:
    """Return the body of a link, its tensor about its centre of mass, in the axes of the link."""
    model, k = found.model, body.id
    if not model.body_mass[k]:
        return ()
    mass, _, _ = numbers([model.body_mass[k], 0.0, 0.0], [body.mass, 0.0, 0.0])
    is_given = bool(body.explicitinertial)
    com = vector(model.body_ipos[k], body.ipos if is_given else None)
    return (central_body(mass, com, _inertia(body, found, is_given)),)


def _inertia(body: Any, found: Compiled, is_given: bool) -> Matrix:
    model, k = found.model, body.id
    quat, moments = model.body_iquat[k], model.body_inertia[k]
    full = np.array(body.fullinertia)
    if is_given and np.all(np.isfinite(full)) and np.any(full):
        xx, yy, zz, xy, xz, yz = numbers(full, full)
        I: Matrix = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
        if _is_tensor(I, quat, moments):
            return I
    said = _said(body, found, quat, body.iquat, body.ialt) if is_given else Said()
    R = placed(found.meaning.rotation(quat, said)).R
    a, b, c = numbers(moments, body.inertia if is_given else None)
    diagonal: Matrix = (a, _ZERO, _ZERO), (_ZERO, b, _ZERO), (_ZERO, _ZERO, c)
    return product(product(R, diagonal), transpose(R))


def _is_tensor(I: Matrix, quat: Any, moments: Any) -> bool:
    """Whether a tensor has these principal axes and moments, which MuJoCo finds to 7 digits."""
    w, v = quat[0], np.array(quat[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    R = np.eye(3) + 2 * (w * cross + cross @ cross)
    missed = R @ np.diag(moments) @ R.T - np.array(I, dtype=float)
    return bool(np.max(np.abs(missed)) <= _MISSED * np.max(moments))
