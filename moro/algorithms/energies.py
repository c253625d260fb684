"""Kinetic and potential energy, over any scalar. Only ``+ - *`` are asked of the scalars."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.posture import PosedLink, Posture, velocities
from moro.spatial.motion import Velocity
from moro.spatial.vectors import Scalar, add, cross, dot, scaled, times


def energy_of_motion(arm: Posture, rotors: Sequence[Scalar], qd: Sequence[Scalar]) -> Scalar:
    """Return K = 1/2 qd^T M(q) qd, with that of the rotors [J]."""
    links = zip(arm.links, velocities(arm, qd), strict=True)
    twice = sum(twice_body_energy(*pair) for pair in links)
    return (twice + sum(I * (rate * rate) for I, rate in zip(rotors, qd, strict=True))) / 2


def twice_body_energy(link: PosedLink, velocity: Velocity) -> Scalar:
    """Return integral (v + omega x r)^2 dm = m v . v + omega . J omega + 2 h . (v x omega)."""
    (omega, v), body = velocity, link.body
    turning = dot(omega, times(body.inertia, omega))
    return body.m * dot(v, v) + turning + 2 * dot(body.h, cross(v, omega))


def energy_of_position(arm: Posture) -> Scalar:
    """Return P = - sum of m_i g . r_Ci = -g . h, h the first moment of the arm [J].

    It is zero for masses at the origin of frame 0.
    """
    moments = [(link.body.m, link.body.h) for link in arm.links]
    total: Scalar = 0
    for i, link in reversed(list(enumerate(arm.links))):
        m, h = moments[i]
        h = add(link.rotate(h), scaled(m, link.p))
        if link.parent < 0:
            total = total - dot(arm.gravity, h)
        else:
            mass, moment = moments[link.parent]
            moments[link.parent] = mass + m, add(moment, h)
    return total
