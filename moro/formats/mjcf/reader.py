"""From the path of an MJCF to links that can be put together."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moro.checks.callers import outside
from moro.formats import names
from moro.formats.errors import Problem, RobotFileError, RobotFileWarning
from moro.formats.mjcf import specification
from moro.formats.mjcf.sources import looked_through

if TYPE_CHECKING:
    from moro.formats.assembly import Assembly
    from moro.formats.mjcf.build import Compiled

#: what MuJoCo calls a model of no name
_UNNAMED = "MuJoCo Model"
_NOT_A_NUMBER = "'NaN'"


def read(path: str | os.PathLike[str], *, as_written: bool = False) -> Assembly:
    """Return the robot that the file at ``path`` describes; its name is made an identifier.

    Bodies, joints and sites are as MuJoCo compiles them. Raises RobotFileError with all that is
    wrong, or with MuJoCo's own message. What is passed over and acts on the robot gives a
    RobotFileWarning.
    """
    path = Path(path)
    shown, has_parts = os.fspath(path), looked_through(path)
    mujoco, said = specification.mujoco_of(path), list[str]()
    spec = specification.parsed(mujoco, path, said, has_parts)
    if any(_NOT_A_NUMBER in text for text in said):
        raise RobotFileError(shown, [Problem(None, "", "holds NaN, which is no number")])
    # what the values say needs SymPy: a text that is no MJCF is refused without
    from moro.formats.mjcf.build import build, problems

    found = _compiled(mujoco, spec, path, said, has_parts, as_written)
    name = spec.modelname.strip()
    built = build(names.identifier(path.stem if name in ("", _UNNAMED) else name), found)
    if wrong := [*problems(built)]:
        raise RobotFileError(shown, wrong)
    for text in (*said, *_passed_over(found)):
        remark = Problem(None, "", text).at(shown)
        warnings.warn(remark, RobotFileWarning, stacklevel=outside())
    return replace(built, notes=(*built.notes, *_notes(found, found.meaning.meant)))


def _compiled(
    mujoco: Any, spec: Any, path: Path, said: list[str], has_parts: bool, as_written: bool
) -> Compiled:
    """Return what MuJoCo makes of a specification, beside what it leaves out of it."""
    from moro.formats.mjcf import motors, obstacles
    from moro.formats.mjcf.build import Compiled
    from moro.formats.mjcf.values import Meaning

    specification.name_all(spec)
    tree = obstacles.tree_of(mujoco, spec, has_parts)
    if not int(spec.option.disableflags) & _no_equality(mujoco):
        obstacles.couple(mujoco, spec, tree)
    obstacles.forces(mujoco, spec, tree)
    driven = motors.motors(mujoco, spec, tree)
    model = specification.compiled(mujoco, spec, path, said, has_parts)
    return Compiled(mujoco, spec, model, tree, driven, Meaning(as_written))


def _no_equality(mujoco: Any) -> int:
    bits = mujoco.mjtDisableBit
    return int(bits.mjDSBL_EQUALITY) | int(bits.mjDSBL_CONSTRAINT)


def _passed_over(found: Compiled) -> Iterator[str]:
    """Yield what acts on the robot from outside, and is not read."""
    model = found.model
    lifted = [body.name for body in found.bodies if model.body_gravcomp[body.id]]
    if lifted:
        yield (
            f"gravcomp of {', '.join(lifted[:5])}{', ...' if len(lifted) > 5 else ''} is passed"
            " over: the torques bear the whole weight"
        )
    if tied := found.tree.passed_over:
        yield f"what ties {', '.join(tied)}, of which a simulation moves one, is passed over"
    if model.opt.density or model.opt.viscosity:
        yield "the fluid around the robot (density, viscosity) is passed over"


def _notes(found: Compiled, meant: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    shapes = [
        body.name
        for body in found.bodies
        if found.model.body_mass[body.id] and not body.explicitinertial
    ]
    if objects := [x.name for x in found.spec.bodies if x.name in found.tree.objects]:
        yield "left out", f"objects that move freely: {', '.join(objects)}"
    if shapes:
        yield "inertia", f"computed by MuJoCo from shapes: {', '.join(shapes)}"
    if meant:
        read = ", ".join(f"{text} as {exact}" for text, exact in meant.items())
        yield "decimals", f"{read}; as_written=True takes them as they are"
