"""Kinetic and potential energy, over any scalar. Only ``+ - *`` are asked of the scalars."""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.posture import Link, Posture, posture
from moro.algorithms.transport import Velocity, inertia_tensor, velocities
from moro.algorithms.vectors import add, cross, dot, scaled, times
from moro.model import Model, Scalar


def kinetic_energy(
    model: Model,
    q: Sequence[Scalar],
    qd: Sequence[Scalar],
    sincos: Sequence[tuple[Scalar, Scalar] | None],
) -> Scalar:
    """Return K = 1/2 qd^T M(q) qd, with that of the rotors [J].

    ``sincos[i]`` is the pair (sin, cos) of ``q_i + offset`` of a revolute joint, anything for a
    prismatic one. With arrays for scalars, many samples are computed at once.
    """
    rotors = [joint.rotor_inertia for joint in model.joints]
    return energy_of_motion(posture(model, q, sincos), rotors, qd)


def potential_energy(
    model: Model, q: Sequence[Scalar], sincos: Sequence[tuple[Scalar, Scalar] | None]
) -> Scalar:
    """Return P = - sum of m_i g . r_Ci, which is zero for masses at the origin of frame 0 [J]."""
    return energy_of_position(posture(model, q, sincos))


def energy_of_motion(arm: Posture, rotors: Sequence[Scalar], qd: Sequence[Scalar]) -> Scalar:
    """Return the kinetic energy of an arm in a posture."""
    links = zip(arm.links, velocities(arm, qd), strict=True)
    twice = sum(twice_body_energy(*pair) for pair in links)
    return (twice + sum(I * (rate * rate) for I, rate in zip(rotors, qd, strict=True))) / 2


def twice_body_energy(link: Link, velocity: Velocity) -> Scalar:
    """Return integral (v + omega x r)^2 dm = m v . v + omega . J omega + 2 h . (v x omega)."""
    (omega, v), body = velocity, link.body
    turning = dot(omega, times(inertia_tensor(body), omega))
    return body.m * dot(v, v) + turning + 2 * dot(body.h, cross(v, omega))


def energy_of_position(arm: Posture) -> Scalar:
    """Return the potential energy of an arm in a posture: -g . h, h the arm's first moment."""
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
