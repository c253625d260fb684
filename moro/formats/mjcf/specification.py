"""MuJoCo's specification of a model, without what has no part in its dynamics; its errors."""

from __future__ import annotations

import importlib
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from moro.formats.errors import Problem, RobotFileError

_T = TypeVar("_T")
_MISSING = (
    "MuJoCo models are read by MuJoCo's own reader, which is not installed:"
    " pip install 'moro-codegen[mjcf]'"
)
_LINE = re.compile(r",? ?\bline (\d+)$", re.MULTILINE)
_PREFIX = re.compile(r"^(XML )?Error: (Error: )?")
#: what a model may hold beside bodies, joints, sites and shapes, those first that name others
_BESIDE = (
    *("keys", "sensors", "actuators", "equalities", "tendons", "pairs", "excludes", "skins"),
    *("flexes", "tuples", "cameras", "lights"),
)
#: what shapes name, and other shapes do not
_ASSETS = ("materials", "textures", "hfields")


def mujoco_of(path: Path) -> Any:
    """Return the package. Raises RobotFileError where it is not there, or is too old."""
    try:
        mujoco = importlib.import_module("mujoco")
    except ImportError:
        raise RobotFileError(os.fspath(path), [Problem(None, "", _MISSING)]) from None
    if not hasattr(mujoco, "MjSpec") or not hasattr(mujoco.MjSpec, "delete"):
        message = f"MuJoCo {mujoco.__version__} is too old: pip install 'moro-codegen[mjcf]'"
        raise RobotFileError(os.fspath(path), [Problem(None, "", message)])
    return mujoco


def parsed(mujoco: Any, path: Path, warnings: list[str], has_parts: bool) -> Any:
    """Return the specification of a file. Raises RobotFileError with MuJoCo's message."""
    with _listening(mujoco, warnings):
        read = mujoco.MjSpec.from_file
        return _said_of(path, lambda: read(os.fspath(path)), has_parts)


def compiled(mujoco: Any, spec: Any, path: Path, warnings: list[str], has_parts: bool) -> Any:
    """Return the model of a specification, of which nothing is left that the dynamics is without.

    Bodies whose inertia is given need no shapes, and shapes that are missing keep none of them from
    being read. Raises RobotFileError with MuJoCo's message.
    """
    needed = _without_shapes(mujoco, spec)
    with _listening(mujoco, warnings):
        try:
            return _said_of(path, spec.compile, has_parts)
        except RobotFileError as error:
            if not needed:
                raise
            problem = error.problems[0]
            shown = ", ".join(needed[:5]) + (", ..." if len(needed) > 5 else "")
            why = f"{problem.message} (the inertia of {shown} is that of their shapes)"
            raise RobotFileError(error.path, [problem._replace(message=why)]) from None


def _without_shapes(mujoco: Any, spec: Any) -> list[str]:
    """Take out what the dynamics is without; return the bodies that have their inertia by meshes.

    Bodies that stand still have frames, which have to stay, and no inertia that counts.
    """
    spec.compiler.fusestatic = False
    for kind in _BESIDE:
        for element in list(getattr(spec, kind)):
            spec.delete(element)
    rule = int(spec.compiler.inertiafromgeom)
    always = int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE)
    never = int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE)
    lowest, highest = spec.compiler.inertiagrouprange
    meshes, needed = set(), []
    for body, moves in bodies(spec.worldbody):
        is_given = rule == never or (rule != always and body.explicitinertial) or not moves
        for geom in list(body.geoms):
            if is_given or not lowest <= geom.group <= highest:
                spec.delete(geom)
                continue
            geom.material = ""
            if geom.meshname:
                meshes.add(geom.meshname)
                needed.append(body.name)
    for mesh in list(spec.meshes):
        if mesh.name not in meshes:
            spec.delete(mesh)
        else:
            mesh.material = ""
    for site in spec.sites:
        site.material = ""
    for kind in _ASSETS:
        for element in list(getattr(spec, kind)):
            spec.delete(element)
    return list(dict.fromkeys(needed))


def bodies(body: Any, moves: bool = False) -> Iterator[tuple[Any, bool]]:
    """Yield a body and what it carries, parents first, and whether joints move them."""
    waiting = [(body, moves)]
    while waiting:
        body, moves = waiting.pop()
        moves = moves or bool(len(body.joints))
        yield body, moves
        waiting += [(child, moves) for child in reversed(list(body.bodies))]


def name_all(spec: Any) -> None:
    """Give names to bodies and joints that have none."""
    found = [body for body, _ in bodies(spec.worldbody)]
    taken = {body.name for body in found}
    for k, body in enumerate(found):
        body.name = body.name or _free(f"body_{k}", taken)
    taken = {joint.name for body in found for joint in body.joints}
    for body in found:
        for joint in body.joints:
            joint.name = joint.name or _free(f"{body.name}_joint", taken)


def _free(name: str, taken: set[str]) -> str:
    """Return a name that is not taken, and take it."""
    found, k = name, 1
    while found in taken:
        k += 1
        found = f"{name}_{k}"
    taken.add(found)
    return found


# -- what MuJoCo says -----------------------------------------------------------------------------


@contextmanager
def _listening(mujoco: Any, warnings: list[str]) -> Iterator[None]:
    """Keep what MuJoCo warns of, which it would write to a file where the user happens to be."""
    mujoco.set_mju_user_warning(warnings.append)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)


def _said_of(path: Path, do: Callable[[], _T], has_parts: bool) -> _T:
    """Return what is done, or raise RobotFileError with what MuJoCo says.

    Lines are those of the file, unless it includes others, of which it may be one.
    """
    try:
        return do()
    except (ValueError, RuntimeError) as error:
        raise RobotFileError(os.fspath(path), [problem(str(error), has_parts)]) from None


def problem(message: str, has_parts: bool = False) -> Problem:
    """Return what MuJoCo says, as a problem."""
    found = _LINE.search(message)
    if not found or has_parts:
        return Problem(None, "", _in_a_row(message))
    return Problem(int(found[1]), "", _in_a_row(message[: found.start()]))


def _in_a_row(message: str) -> str:
    return "MuJoCo: " + "; ".join(
        x.strip() for x in _PREFIX.sub("", message).split("\n") if x.strip()
    )


def line_of(element: Any, has_parts: bool) -> int | None:
    """Return the line in which an element of a specification begins, where that is known."""
    found = _LINE.search(element.info)
    return int(found[1]) if found and not has_parts else None
