"""The torques as a linear function of the bodies' inertial parameters, over any scalar.

Atkeson, An & Hollerbach 1986; Khalil & Dombre 2002 (ch. 12). The wrench that moves a body is linear
in its parameters. What joint j bears of it is zeta . n + lambda . f, where (zeta, lambda) is the
velocity that the joint gives to the body's frame per unit of its own; so it is joints that are
carried outwards, two vectors each, and not the ten wrenches of every body inwards. Only ``+ - *``
are asked of the scalars.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from moro.algorithms.coordinates import generalized
from moro.algorithms.newton_euler import forward_motion
from moro.algorithms.posture import Posture
from moro.algorithms.reference_motion import reference_motions
from moro.spatial.motion import REST, Motion, ReferenceMotion, Velocity
from moro.spatial.transform import velocity_in_link
from moro.spatial.vectors import Matrix, Scalar, Vector, add, cross, dot, times, transpose

#: the parameters of a body, in order: inertia about the origin of the joint's frame, first moment,
#: mass
PARAMETERS = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")


def body_regressor(arm: Posture, qd: Sequence[Scalar], qdd: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rows of Y(q, qd, qdd) (n x 10 n), M qdd + C qd + G = Y p.

    p holds the ``PARAMETERS`` of body after body, in the frame of its joint.
    """
    return _rows(arm, [(x, inertia_moments(x)) for x in forward_motion(arm, qd, qdd)])


def reference_regressor(
    arm: Posture, qd: Sequence[Scalar], qd_r: Sequence[Scalar], qdd_r: Sequence[Scalar]
) -> list[list[Scalar]]:
    """Return the rows of Y(q, qd, qd_r, qdd_r) (n x 10 n), M qdd_r + C qd_r + G = Y p.

    C is that of the Christoffel symbols (``moro.algorithms.reference_motion``).
    """
    motions = reference_motions(arm, qd, qd_r, qdd_r)
    return _rows(arm, [(x, reference_moments(x)) for x in motions])


def _rows(
    arm: Posture, motions: Iterable[tuple[Motion | ReferenceMotion, tuple[Vector, ...]]]
) -> list[list[Scalar]]:
    """Return the rows of Y for motions, with the moments per unit of the tensors."""
    size = len(PARAMETERS)
    Y: list[list[Scalar]] = [[0] * (size * len(arm.links)) for _ in arm.links]
    for i, ((motion, moments), columns) in enumerate(zip(motions, joint_columns(arm), strict=True)):
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
    return _moments(motion.U, motion.alpha, (x * y, x * z, y * z))


def reference_moments(motion: ReferenceMotion) -> tuple[Vector, ...]:
    """Return axial(U S) per unit of XX, XY, XZ, YY, YZ and ZZ, with S = tr(J)/2 1 - J."""
    (_, Uxy, Uxz), (Uyx, _, Uyz), (Uzx, Uzy, _) = motion.U
    axial = (Uzy - Uyz) / 2, (Uxz - Uzx) / 2, (Uyx - Uxy) / 2
    return _moments(motion.U, axial, ((Uyx + Uxy) / 2, (Uxz + Uzx) / 2, (Uzy + Uyz) / 2))


def _moments(U: Matrix, axial: Vector, products: Vector) -> tuple[Vector, ...]:
    """Return them for a U whose antisymmetric part is that of ``axial``.

    ``products`` are its symmetric part, xy, xz and yz.
    """
    (ax, ay, az), (xy, xz, yz) = axial, products
    (Uxx, Uxy, Uxz), (Uyx, Uyy, Uyz), (Uzx, Uzy, Uzz) = U
    return (
        (ax, xz, -xy),
        (-Uzx, Uzy, Uxx - Uyy),
        (Uyx, Uzz - Uxx, -Uyz),
        (-yz, ay, xy),
        (Uyy - Uzz, -Uxy, Uxz),
        (yz, -xz, az),
    )
