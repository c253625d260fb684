"""What drives add to the torques of the rigid bodies: rotor inertia, friction and springs.

Everything is at the generalized coordinates [N m or N].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from moro.model import Drive, Model
from moro.spatial.vectors import Scalar


class Functions(NamedTuple):
    """What friction asks of the scalars besides ``+ - *``: of NumPy's, of a graph's, ..."""

    #: -1, 0 or 1
    sign: Callable[[Scalar], Scalar]
    tanh: Callable[[Scalar], Scalar]
    exp: Callable[[Scalar], Scalar]


def drive_torques(
    model: Model, qd: Sequence[Scalar], qdd: Sequence[Scalar], functions: Functions
) -> tuple[Scalar, ...]:
    """Return rotor_inertia qdd + friction(qd) at every coordinate."""
    return tuple(
        x.drive.rotor_inertia * acceleration + friction(x.drive, rate, functions)
        for x, rate, acceleration in zip(model.coordinates, qd, qdd, strict=True)
    )


def friction(drive: Drive, qd: Scalar, functions: Functions) -> Scalar:
    """Return viscous qd + s (coulomb + (static - coulomb) exp(-(qd / stribeck_velocity)^2)).

    Coulomb's and Stribeck's terms have two directions, which ``directed`` tells apart by s.
    """
    s, (forward, backward) = step(drive, qd, functions), drive.coulomb
    total = drive.viscous * qd + directed(forward, backward, s)
    if drive.static is not None:
        more = directed(drive.static[0] - forward, drive.static[1] - backward, s)
        total = total + more * stribeck(drive, qd, functions)
    return total


def step(drive: Drive, qd: Scalar, functions: Functions) -> Scalar:
    """Return s, which is sign(qd), or tanh(qd / width)."""
    return functions.sign(qd) if drive.width is None else functions.tanh(qd / drive.width)


def stribeck(drive: Drive, qd: Scalar, functions: Functions) -> Scalar:
    """Return exp(-(qd / stribeck_velocity)^2)."""
    v = qd / drive.stribeck_velocity
    return functions.exp(-(v * v))


def directed(forward: Scalar, backward: Scalar, s: Scalar) -> Scalar:
    """Return (p + n)/2 s + (p - n)/2 s^2: p for s = 1, -n for s = -1, 0 for s = 0."""
    return s * ((forward + backward) / 2 + (forward - backward) / 2 * s)


def spring_torques(model: Model, q: Sequence[Scalar]) -> tuple[Scalar, ...]:
    """Return stiffness (q - rest) at every coordinate, the gradient of the springs' energy."""
    return tuple(
        x.drive.stiffness * (position - x.drive.rest)
        for x, position in zip(model.coordinates, q, strict=True)
    )


def spring_energy(model: Model, q: Sequence[Scalar]) -> Scalar:
    """Return the sum of stiffness/2 (q - rest)^2 [J]."""
    stretched = ((x.drive, qi - x.drive.rest) for x, qi in zip(model.coordinates, q, strict=True))
    return sum(drive.stiffness * (x * x) for drive, x in stretched) / 2
