"""Generalized momentum, and what changes it besides torques, recursively, over any scalar.

p = M qd, and by the equations of motion with the Christoffel symbols' C, where dM/dt = C + C^T,

    dp/dt = tau + C(q, qd)^T qd - G(q) - friction,

which is what observers of disturbances integrate (De Luca & Mattone 2003, De Luca et al. 2006).
Joint i gives the point r of a body the velocity r'_i per unit of its own, so with the linear and
angular momentum (f, n) of all that it moves, about the origin of its frame,

    p_i = integral r'_i . dr/dt dm,    (C^T qd)_i = integral d r'_i/dt . dr/dt dm,

the first is what the joint bears of (f, n), the second zeta . n + lambda . f with
``moro.algorithms.coriolis``'s rates of the axis. Only ``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import generalized
from moro.algorithms.posture import Posture, velocities
from moro.spatial.moments import Moments
from moro.spatial.motion import Velocity, Wrench
from moro.spatial.transform import wrench_in_parent
from moro.spatial.vectors import Scalar, add, cross, scaled, times

#: no swirl: the velocity of the points is that of the links
NONE = (0, 0, 0)


def joint_momentum(arm: Posture, rotors: Sequence[Scalar], qd: Sequence[Scalar]) -> list[Scalar]:
    """Return p = M(q) qd, with that of the rotors [N m s or N s]."""
    carried = composite_momenta(arm, velocities(arm, qd))
    borne = (link.type.along(x) for link, x in zip(arm.links, carried, strict=True))
    p = generalized(arm.links, borne, arm.nv)
    return [x + rotor * rate for x, rotor, rate in zip(p, rotors, qd, strict=True)]


def transposed_coriolis_product(arm: Posture, qd: Sequence[Scalar]) -> list[Scalar]:
    """Return C(q, qd)^T qd, the gradient of the kinetic energy by q [N m or N]."""
    motion = velocities(arm, qd)
    carried = composite_momenta(arm, motion)
    shares = (
        link.type.against(velocity, momentum, NONE)
        for link, velocity, momentum in zip(arm.links, motion, carried, strict=True)
    )
    return generalized(arm.links, shares, arm.nv)


def composite_momenta(arm: Posture, motion: Sequence[Velocity]) -> list[Wrench]:
    """Return for every link the linear and angular momentum of it and all it carries."""
    total = [body_momentum(link.body, v) for link, v in zip(arm.links, motion, strict=True)]
    for i, link in reversed(list(enumerate(arm.links))):
        if link.parent >= 0:
            (f, n), onto = wrench_in_parent(link, total[i]), total[link.parent]
            total[link.parent] = Wrench(add(onto.f, f), add(onto.n, n))
    return total


def body_momentum(body: Moments, velocity: Velocity) -> Wrench:
    """Return m v + omega x h and J omega + h x v, about the frame's origin."""
    omega, v = velocity
    f = add(scaled(body.m, v), cross(omega, body.h))
    return Wrench(f, add(times(body.inertia, omega), cross(body.h, v)))
