"""The inertia matrix by the composite rigid body algorithm, over any scalar.

Walker & Orin 1982, Featherstone 2008 (sec. 6.2): the joint j accelerates link j and all it carries
as one rigid body. The wrench for that, carried inwards, is column j of M over the joints. Only
``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import in_coordinates
from moro.algorithms.posture import Posture, ancestors, composites
from moro.spatial.transform import wrench_in_parent
from moro.spatial.vectors import Scalar


def joint_inertia(arm: Posture, rotors: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of M(q) (n x n), rotor inertias on its diagonal [kg m^2, kg m or kg]."""
    links = arm.links
    M: list[list[Scalar]] = [[0] * len(links) for _ in links]
    for j, body in enumerate(composites(arm)):
        wrench = links[j].type.momentum(body)
        M[j][j] = links[j].type.along(wrench)
        inner = links[j]
        for i in ancestors(links, j):
            wrench = wrench_in_parent(inner, wrench)
            inner = links[i]
            M[i][j] = M[j][i] = inner.type.along(wrench)
    M = in_coordinates(links, M, arm.nv)
    for j, rotor in enumerate(rotors):
        M[j][j] = M[j][j] + rotor
    return M
