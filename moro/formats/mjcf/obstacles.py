"""What is said of a model that joints and bodies do not hold: loops, tendons, what moves freely."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from moro.formats.assembly import Obstacle
from moro.formats.errors import Problem
from moro.formats.mjcf.couplings import Coupling, followed, is_circle
from moro.formats.mjcf.specification import bodies, line_of
from moro.formats.mjcf.values import number

_ZERO = sp.Integer(0)
_FLEX = "is deformable (a flex): robots of rigid bodies are read"


@dataclass
class Tree:
    """Bodies on bodies, and what ties them."""

    #: of each body, what carries it
    parents: Mapping[str, str | None]
    #: of each body, the joints that move it there
    joints: Mapping[str, Sequence[str]]
    has_parts: bool
    #: bodies that move freely and carry no joints: no part of the robot
    objects: Collection[str] = ()
    #: bodies that the user moves, of a simulation
    targets: Collection[str] = ()
    couplings: dict[str, Coupling] = field(default_factory=dict)
    obstacles: list[Obstacle] = field(default_factory=list)
    #: what acts on the robot from outside
    passed_over: list[str] = field(default_factory=list)

    def add(
        self, element: Any, of: str, message: str, links: Sequence[str], joints: Sequence[str] = ()
    ) -> None:
        """Keep an obstacle between links, as long as one of the joints, if any are named, moves."""
        moving = [q for q, _, _ in (followed(x, self.couplings) for x in joints) if q is not None]
        if not joints or moving:
            problem = Problem(line_of(element, self.has_parts), of, message)
            there = tuple(x for x in links if x not in self.objects)
            self.obstacles.append(Obstacle(problem, there, tuple(dict.fromkeys(moving))))

    def couple(self, name: str, coupling: Coupling) -> bool:
        """Let a joint follow another, unless it follows one already."""
        if name in self.couplings or is_circle(name, coupling, self.couplings):
            return False
        self.couplings[name] = coupling
        return True

    def is_joint(self, name: str) -> bool:
        """Whether there is such a joint."""
        return any(name in joints for joints in self.joints.values())

    def body_of(self, joint: str) -> str:
        """Return the body that a joint moves."""
        return next(body for body, joints in self.joints.items() if joint in joints)

    def between(self, bodies: Sequence[str]) -> list[str]:
        """Return the joints that move bodies against each other."""
        ways = [set(self._way(body)) for body in bodies]
        apart = ways[0].union(*ways[1:]) - ways[0].intersection(*ways[1:])
        return [x for body in self.parents if body in apart for x in self.joints[body]]

    def _way(self, body: str | None) -> Iterator[str]:
        while body is not None:
            yield body
            body = self.parents[body]


def tree_of(mujoco: Any, spec: Any, has_parts: bool) -> Tree:
    """Return the bodies of a specification, and which of them are no part of a robot."""
    found = [body for body, _ in bodies(spec.worldbody)]
    kinds = mujoco.mjtJoint
    moving = {body.name for body in found if any(x.type != kinds.mjJNT_FREE for x in body.joints)}
    objects: list[str] = []
    for body in found:
        own = [x.name for x, _ in bodies(body)]
        if len(body.joints) and moving and not moving & set(own):
            objects += own
    return Tree(
        {x.name: None if x.name == "world" else x.parent.name for x in found},
        {x.name: [joint.name for joint in x.joints] for x in found},
        has_parts,
        objects=frozenset(objects),
        targets=frozenset(x.name for x in found if x.mocap),
    )


def couple(mujoco: Any, spec: Any, tree: Tree) -> None:
    """Keep what equality constraints that are active couple, and what they close to loops."""
    active = [equality for equality in spec.equalities if equality.active]
    refused = [
        (equality, message)
        for equality in active
        if equality.type == mujoco.mjtEq.mjEQ_JOINT and (message := _coupled(equality, tree))
    ]
    tendons = {tendon.name: _on_joints(tendon) for tendon in spec.tendons}
    ties = [x for x in active if x.type != mujoco.mjtEq.mjEQ_JOINT]
    ties = [
        x
        for x in ties
        if x.type != mujoco.mjtEq.mjEQ_TENDON or not _coupled_by_tendon(x, tendons, tree)
    ]
    # when it is known what follows what
    for equality, message in refused:
        moved = [x for x in (equality.name1, equality.name2) if tree.is_joint(x)]
        links = [tree.body_of(x) for x in moved]
        tree.add(equality, f"equality of joint {equality.name1}", message, links, moved)
    for equality in ties:
        _tie(mujoco, spec, equality, tree)


def _coupled(equality: Any, tree: Tree) -> str | None:
    """Keep a coupling of joints, or return why it is none that is read."""
    name, other = equality.name1, equality.name2 or None
    if missing := [x for x in (name, other) if x is not None and not tree.is_joint(x)]:
        return f"there is no joint `{missing[0]}`"
    a0, a1, *more = (number(x) for x in list(equality.data)[:5])
    if other and any(more):
        return f"it follows {other} by a polynomial: only lines, a0 + a1 x, are read"
    if not tree.couple(name, Coupling(a0, a1 if other else _ZERO, other)):
        return "it is coupled to others already"
    return None


def _coupled_by_tendon(
    equality: Any, tendons: Mapping[str, Mapping[str, Any] | None], tree: Tree
) -> bool:
    """Keep the coupling of two joints, c x + d y = a0, whose tendon keeps its length, if it is one.

    The second follows the first.
    """
    joints = tendons.get(equality.name1)
    if equality.name2 or joints is None or len(joints) != 2 or not all(joints.values()):
        return False
    (x, c), (y, d) = joints.items()
    return tree.couple(y, Coupling(number(equality.data[0]) / d, -c / d, x))


def _on_joints(tendon: Any) -> dict[str, Any] | None:
    """Return {joint: coefficient} of a tendon along joints; None where it is one in space."""
    found: dict[str, Any] = {}
    for wrap in tendon.path:
        if wrap.target is None or not hasattr(wrap.target, "stiffness"):
            return None
        name = wrap.target.name
        found[name] = found.get(name, _ZERO) + number(wrap.coef)
    return found


def _tie(mujoco: Any, spec: Any, equality: Any, tree: Tree) -> None:
    """Keep a loop: two bodies, or what sites are on, held together."""
    kind = str(equality.type).rpartition("_")[2].lower()
    of = f"equality {equality.name or kind}"
    if equality.type == mujoco.mjtEq.mjEQ_TENDON:
        known = {x.name: x for x in spec.tendons}
        tendons = [known[x] for x in (equality.name1, equality.name2) if x in known]
        links, joints = _reach(tendons, tree)
        tree.add(equality, of, "it holds the length of a tendon", links, joints)
        return
    if equality.type not in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
        return  # of what is deformable, which is kept anyway
    names = [equality.name1, equality.name2 or "world"]
    if equality.objtype == mujoco.mjtObj.mjOBJ_SITE:
        on = {site.name: body for body in spec.bodies for site in body.sites}
        names = [on[x].name for x in names if x in on]
    names = [x for x in names if x in tree.parents]
    if any(x in tree.targets for x in names):
        tree.passed_over.append(" and ".join(names))
        return
    joints = tree.between(names) if len(names) == 2 else []
    if joints:
        message = (
            f"it closes a loop, of {' and '.join(names)}: trees are read; with tip= the robot ends"
            " before it, with fix= its joints stand still"
        )
        tree.add(equality, of, message, names, joints)


def forces(mujoco: Any, spec: Any, tree: Tree) -> None:
    """Keep what acts along tendons, and what is deformable."""
    for tendon in spec.tendons:
        acts = [
            words
            for words in ("stiffness", "damping", "frictionloss", "armature")
            if any(_listed(getattr(tendon, words, 0)))
        ]
        if acts:
            links, joints = _reach([tendon], tree)
            message = f"its {' and '.join(acts)}: what acts on several joints at once is not read"
            tree.add(tendon, f"tendon {tendon.name}".strip(), message, links, joints)
    for flex in spec.flexes:
        links = list(dict.fromkeys([*flex.vertbody, *flex.nodebody]))
        tree.add(flex, f"flex {flex.name}", _FLEX, links)
    for body in spec.bodies:
        if body.plugin.active:
            message = f"its plugin {body.plugin.plugin_name} acts on it in ways that are not read"
            tree.add(body, f"body {body.name}", message, (body.name,))


def _reach(tendons: Sequence[Any], tree: Tree) -> tuple[list[str], list[str]]:
    """Return the bodies that tendons are on, and the joints that change their lengths."""
    links, joints = [], []
    for tendon in tendons:
        targets = [wrap.target for wrap in tendon.path if wrap.target is not None]
        on = [x for x in targets if not hasattr(x, "stiffness")]
        joints += [x.name for x in targets if hasattr(x, "stiffness")]
        links += [x.parent.name for x in targets]
        if on:
            joints += tree.between([x.parent.name for x in on])
    return list(dict.fromkeys(links)), list(dict.fromkeys(joints))


def _listed(x: Any) -> list[float]:
    try:
        return [float(y) for y in x]
    except TypeError:
        return [float(x)]
