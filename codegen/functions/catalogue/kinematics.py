"""Where a frame is, and how it moves."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.posture import Posture
from moro.spatial.vectors import Scalar
from moro_codegen.functions.arguments import LAST, Argument, J, Q
from moro_codegen.functions.function import Function, Outputs
from moro_codegen.functions.system import System, flat
from moro_codegen.graph.nodes import Node

T = Argument("T", (4, 4), "1, m", f"pose of {LAST} in frame 0: [[R, p], [0, 1]]")


def _forward_kinematics(system: System, q: Sequence[Node]) -> Outputs:
    def pose(arm: Posture) -> Sequence[Scalar]:
        tip = poses(arm)[-1]
        rows = [(*row, x) for row, x in zip(tip.R, tip.p, strict=True)]
        return flat([*rows, (0, 0, 0, 1)])

    return [system.geometry(q, pose)]


def _jacobian(system: System, q: Sequence[Node]) -> Outputs:
    return [system.geometry(q, lambda arm: flat(frame_jacobian(arm)))]


FUNCTIONS = (
    Function(
        "forward_kinematics",
        (Q,),
        (T,),
        f"Forward kinematics: the pose of {LAST}.",
        _forward_kinematics,
        "product of the transforms",
        frame="",
    ),
    Function(
        "jacobian",
        (Q,),
        (J,),
        f"Jacobian of {LAST}: velocity of its origin, angular velocity.",
        _jacobian,
        "joint axes, and the way from each to the frame",
        frame="",
    ),
)
