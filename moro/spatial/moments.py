"""The inertial parameters of a body, as integrals over its mass."""

from __future__ import annotations

from dataclasses import dataclass

from moro.spatial.vectors import (
    Matrix,
    Scalar,
    Vector,
    add,
    dyad,
    product,
    scaled,
    sum_of,
    times,
    transpose,
)


@dataclass(frozen=True)
class Moments:
    """Integrals over the mass of a body, r from the frame's origin. They add up over bodies."""

    #: integral of dm [kg]
    m: Scalar
    #: integral of r dm [kg m]
    h: Vector = (0, 0, 0)
    #: integral of r r^T dm, which is tr(J)/2 1 - J for the tensor of inertia J [kg m^2]
    S: Matrix = ((0, 0, 0), (0, 0, 0), (0, 0, 0))

    @classmethod
    def of(cls, mass: Scalar, first_moment: Vector, inertia: Matrix) -> Moments:
        """Return the moments of a body with this tensor of inertia about the frame's origin."""
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = inertia
        half = (xx + yy + zz) / 2
        S = (half - xx, -xy, -xz), (-yx, half - yy, -yz), (-zx, -zy, half - zz)
        return cls(mass, first_moment, S)

    @property
    def inertia(self) -> Matrix:
        """J = tr(S) 1 - S, the tensor of inertia about the frame's origin."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.S
        return (yy + zz, -xy, -xz), (-xy, xx + zz, -yz), (-xz, -yz, xx + yy)

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.m + other.m, add(self.h, other.h), sum_of(self.S, other.S))

    def __sub__(self, other: Moments) -> Moments:
        S = scaled(-1, other.S[0]), scaled(-1, other.S[1]), scaled(-1, other.S[2])
        return self + Moments(-other.m, scaled(-1, other.h), S)

    def rotated(self, R: Matrix) -> Moments:
        """Return the moments after r -> R r."""
        return Moments(self.m, times(R, self.h), product(product(R, self.S), transpose(R)))

    def displaced(self, p: Vector) -> Moments:
        """Return the moments after r -> r + p."""
        h = add(self.h, scaled(self.m, p))
        return Moments(self.m, h, sum_of(self.S, sum_of(dyad(self.h, p), dyad(p, h))))
