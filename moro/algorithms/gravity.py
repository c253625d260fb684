"""Gravity torques from the first moments of what each joint carries, over any scalar.

A joint holds the weight of all that it carries, about its axis if it turns, along it if it slides.
With the mass m and the first moment h, about the origin of the frame of link i, of link i and all
it carries as one rigid body, and g in the axes of the link, that is

    G_i = z . (g x h)    or    G_i = -m g . z,

two products, or one, for a joint. g is turned outwards and h is handed inwards, R h + m p: no
forces and moments, as Newton-Euler at rest has them. Only ``+ - *`` are asked of the scalars.
"""

from __future__ import annotations

from moro.algorithms.coordinates import generalized
from moro.algorithms.posture import Posture
from moro.spatial.motion import Wrench
from moro.spatial.vectors import Scalar, Vector, add, cross, scaled


def gravity_torques(arm: Posture) -> list[Scalar]:
    """Return G(q), the torques (forces) that hold the arm at rest [N m or N]."""
    links = arm.links
    weights: list[Vector] = []
    for link in links:
        g = arm.gravity if link.parent < 0 else weights[link.parent]
        weights.append(link.rotate_back(g))
    moments = [(link.body.m, link.body.h) for link in links]
    borne: list[Scalar] = [0] * len(links)
    for i, link in reversed(list(enumerate(links))):
        m, h = moments[i]
        x, y, z = weights[i]
        weight = -x, -y, -z
        borne[i] = link.type.along(Wrench(scaled(m, weight), cross(h, weight)))
        if link.parent >= 0:
            mass, moment = moments[link.parent]
            carried = add(link.rotate(h), scaled(m, link.p))
            moments[link.parent] = mass + m, add(moment, carried)
    return generalized(links, borne, arm.nv)
