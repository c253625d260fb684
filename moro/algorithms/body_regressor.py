"""The torques as a linear function of the bodies' inertial parameters, over any scalar.

Atkeson, An & Hollerbach 1986; Khalil & Dombre 2002 (ch. 12). The wrench that moves a body is linear
in its parameters. What joint j bears of it is zeta . n + lambda . f, where (zeta, lambda) is the
velocity that the joint gives to the body's frame per unit of its own; so it is joints that are
carried outwards, two vectors each, and not the ten wrenches of every body inwards. Only ``+ - *``
are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Sequence

from moro.algorithms.coordinates import generalized
from moro.algorithms.newton_euler import forward_motion
from moro.algorithms.posture import Posture
from moro.spatial.motion import REST, Motion, Velocity
from moro.spatial.transform import velocity_in_link
from moro.spatial.vectors import Scalar, Vector, add, cross, dot, times, transpose

#: the parameters of a body, in order: inertia about the origin of the joint's frame, first moment,
#: mass
PARAMETERS = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")


def body_regressor(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of Y(q, qd, qdd) (n x 10 n), M qdd + C qd + G = Y p.

    p holds the ``PARAMETERS`` of body after body, in the frame of its joint.
    """
    size = len(PARAMETERS)
    Y: list[list[Scalar]] = [[0] * (size * len(arm.links)) for _ in arm.links]
    moving = zip(forward_motion(arm, qd, qdd), joint_columns(arm), strict=True)
    for i, (motion, columns) in enumerate(moving):
        moments = inertia_moments(motion)
        for j, (zeta, lamda) in columns.items():
            of_inertia = [dot(zeta, n) for n in moments]
            # lambda . U h + zeta . (h x a)
            of_moment = add(times(transpose(motion.U), lamda), cross(motion.a, zeta))
            of_mass = dot(lamda, motion.a)
            Y[j][size * i : size * (i + 1)] = [*of_inertia, *of_moment, of_mass]
    borne = (generalized(arm.links, column, arm.nv) for column in zip(*Y, strict=True))
    return [list(row) for row in zip(*borne, strict=True)]


def joint_columns(arm: Posture) -> list[dict[int, Velocity]]:
    """Return for every link the velocity, in its frame, per unit of every joint that moves it."""
    found: list[dict[int, Velocity]] = []
    for i, link in enumerate(arm.links):
        outer = found[link.parent] if link.parent >= 0 else {}
        columns = {j: velocity_in_link(link, column) for j, column in outer.items()}
        found.append({**columns, i: link.type.moved(REST, 1)})
    return found


def inertia_moments(motion: Motion) -> tuple[Vector, ...]:
    """Return the moment J alpha + omega x J omega per unit of XX, XY, XZ, YY, YZ and ZZ."""
    x, y, z = motion.omega
    ax, ay, az = motion.alpha
    (Uxx, Uxy, Uxz), (Uyx, Uyy, Uyz), (Uzx, Uzy, Uzz) = motion.U
    return (
        (ax, x * z, -(x * y)),
        (-Uzx, Uzy, Uxx - Uyy),
        (Uyx, Uzz - Uxx, -Uyz),
        (-(y * z), ay, x * y),
        (Uyy - Uzz, -Uxy, Uxz),
        (y * z, -(x * z), az),
    )
