"""The inertia matrix by the composite rigid body algorithm, over any scalar.

Walker & Orin 1982, Featherstone 2008 (sec. 6.2): the joint j accelerates link j and all it carries
as one rigid body. The wrench for that, carried inwards, is column j of M. Only ``+ - *`` are asked
of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.posture import Posture, posture
from moro.algorithms.transport import (
    along_joint,
    ancestors,
    composites,
    momentum,
    wrench_in_parent,
)
from moro.model import Model, Scalar


def inertia_matrix(
    model: Model, q: Sequence[Scalar], sincos: Sequence[tuple[Scalar, Scalar] | None]
) -> list[list[Scalar]]:
    """Return the rows of M(q) (n x n), rotor inertias on its diagonal [kg m^2, kg m or kg].

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. With arrays for scalars, many samples are computed at once.
    """
    rotors = [joint.rotor_inertia for joint in model.joints]
    return joint_inertia(posture(model, q, sincos), rotors)


def joint_inertia(arm: Posture, rotors: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of the inertia matrix of an arm in a posture."""
    links = arm.links
    M: list[list[Scalar]] = [[0] * len(links) for _ in links]
    for j, body in enumerate(composites(arm)):
        wrench = momentum(links[j].kind, body)
        M[j][j] = along_joint(links[j], wrench) + rotors[j]
        inner = links[j]
        for i in ancestors(links, j):
            wrench = wrench_in_parent(inner, wrench)
            inner = links[i]
            M[i][j] = M[j][i] = along_joint(inner, wrench)
    return M
