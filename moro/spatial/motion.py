"""Motions and wrenches, in the axes of the frame they belong to."""

from __future__ import annotations

from typing import NamedTuple

from moro.spatial.vectors import Matrix, Vector


class Velocity(NamedTuple):
    """Velocity of a link; or its acceleration, or either per unit of a joint's."""

    #: angular, of the link
    omega: Vector
    #: linear, of the origin of its frame
    v: Vector


REST = Velocity((0, 0, 0), (0, 0, 0))


class Motion(NamedTuple):
    """Velocity and acceleration of a link; the point r of it accelerates by a + U r."""

    #: angular velocity [rad/s]
    omega: Vector
    #: angular acceleration [rad/s^2]
    alpha: Vector
    #: [alpha]x + [omega]x [omega]x
    U: Matrix
    #: linear acceleration of the frame's origin minus gravity [m/s^2]
    a: Vector


class ReferenceMotion(NamedTuple):
    """A link that moves, and the velocity that it should have: reference v_r + omega_r x r.

    As the link moves, the reference velocity of its point r changes at the rate a + U r. Where the
    reference is the velocity itself, this is ``Motion``.
    """

    #: angular velocity [rad/s]
    omega: Vector
    #: angular reference velocity omega_r [rad/s]
    reference: Vector
    #: rate of omega_r [rad/s^2]
    alpha: Vector
    #: [alpha]x + [omega_r]x [omega]x
    U: Matrix
    #: rate of the reference velocity of the frame's origin, minus gravity [m/s^2]
    a: Vector


class Wrench(NamedTuple):
    """Force and moment about the frame's origin."""

    f: Vector
    n: Vector
