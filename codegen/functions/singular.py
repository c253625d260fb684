"""Arms without forward dynamics: some motion of the joints meets no inertia."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coordinates import displacements
from moro.algorithms.posture import posture
from moro.model import Model
from moro.spatial.vectors import Scalar
from moro_codegen.graph.nodes import constant_value

#: inertias below these are rounding: of one joint, against the arm's largest; of several together,
#: against each of theirs
LIGHTEST, DEPENDENT = 1e-15, 1e-13


def check_resisted(model: Model, rotors: Sequence[Scalar]) -> None:
    """Raise ValueError where a motion of the joints meets no inertia at any posture."""
    if joints := unresisted(model, rotors):
        raise singular(model, joints)


def unresisted(model: Model, rotors: Sequence[Scalar]) -> list[int]:
    """Return the joints (from 1) of a motion that meets no inertia at any posture; if none, [].

    Looked for in numbers, at a random posture. A model with run-time parameters is taken to have
    inertia everywhere.
    """
    import numpy as np  # the catalogue of functions is read without it, for --help

    try:
        model, inertias = model.map(_number), [_number(x) for x in rotors]
    except TypeError:
        return []
    q = [float(x) for x in np.random.default_rng(0).uniform(-3, 3, model.nv)]
    arm = posture(model, q, [(np.sin(x), np.cos(x)) for x in displacements(model, q)])
    M = np.array(joint_inertia(arm, inertias), dtype=float)
    felt = np.diag(M)
    light = felt <= LIGHTEST * felt.max()
    if not light.any():
        values, motions = np.linalg.eigh(M / np.sqrt(np.outer(felt, felt)))
        light = (np.abs(motions[:, 0]) > 1e-6) & (values[0] < DEPENDENT)
    return [int(i) + 1 for i in np.flatnonzero(light)]


def singular(model: Model, joints: Sequence[int] = ()) -> ValueError:
    """Return the error of forward dynamics for these unresisted joints, or for unknown ones."""
    where = "some joint" if not joints else f"joint {joints[0]}"
    if len(joints) > 1:
        where = f"a motion of the joints {', '.join(map(str, joints))}"
    links = "those links" if len(joints) > 1 else "that link"
    return ValueError(
        f"{model.name} has no forward dynamics: no inertia resists {where}; give {links} an "
        "inertia tensor (inertia), or the drive a rotor inertia (rotor_inertia)"
    )


def _number(x: Scalar) -> float:
    """Return the value of a constant. Raise TypeError for anything else."""
    return float(constant_value(x))
