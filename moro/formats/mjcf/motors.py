"""What actuators add to the joints that they drive: the inertia and damping of motors."""

from __future__ import annotations

from typing import Any

from moro.formats.mjcf.build import Motor
from moro.formats.mjcf.obstacles import Tree


def motors(mujoco: Any, spec: Any, tree: Tree) -> dict[str, Motor]:
    """Return what motors add at joints, g^2 of armature and damping behind a gear g.

    Those that drive tendons are kept as obstacles.
    """
    found: dict[str, Motor] = {}
    at_joints = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    for actuator in spec.actuators:
        inertia = float(getattr(actuator, "armature", 0.0))
        damping = [float(x) for x in getattr(actuator, "damping", (0.0,))]
        if not (inertia or any(damping)):
            continue
        of = f"actuator {actuator.name}".strip()
        if actuator.trntype in at_joints and not any(damping[1:]):
            square = float(actuator.gear[0]) ** 2
            before = found.get(actuator.target, Motor())
            found[actuator.target] = Motor(
                before.inertia + square * inertia, before.damping + square * damping[0]
            )
        else:
            message = "its armature and damping act on more than one joint, or not as lines"
            tree.add(actuator, of, message, ())
    return found
