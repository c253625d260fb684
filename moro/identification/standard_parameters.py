"""The standard inertial parameters of an arm: what its energies are linear in.

Each link has ten about the origin of its frame, along its axes: the inertia tensor XX, XY, XZ, YY,
YZ, ZZ (entries of the matrix, sign included), the first moments MX, MY, MZ and the mass M. A rotor
inertia IA comes on top. So

    K = sum_k p_k K_k(q, qd),    P = sum_k p_k P_k(q).

Link i's frame is that of its joint in the model. Made of DH rows, these are the frames of Khalil
and Kleinfinger for both conventions: z_i along joint i, x_i along the common normal to joint i + 1,
the origin where they meet. (They are the frames of modified DH; in standard DH, frame i before its
shift along and its turn about x.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import sympy as sp

from moro.closed_form import Geometry
from moro.model import Model
from moro.scalars.ring import Ring
from moro.scalars.trig import Trig, TrigRing
from moro.spatial.moments import Moments
from moro.spatial.vectors import Matrix, Scalar, Vector, cross, dot

TENSOR = {"XX": (0, 0), "XY": (0, 1), "XZ": (0, 2), "YY": (1, 1), "YZ": (1, 2), "ZZ": (2, 2)}
MOMENTS = {"MX": 0, "MY": 1, "MZ": 2}
#: those of a body
BODY = (*TENSOR, *MOMENTS, "M")
#: what of a robot must be set for the bodies to be known
BODIES = frozenset({"masses", "cm_positions", "inertia_tensors"})
#: of a link, and of a coordinate its drive (``base_parameters.drive_coefficients``): rotor,
#: viscous friction, Coulomb's, Stribeck's, spring
NAMES = (*BODY, "IA", "FV", "FC", "FD", "FS", "FE", "KQ", "KR")

Functions: TypeAlias = "tuple[Scalar, Scalar]"


class Standard(NamedTuple):
    """One of ``NAMES`` of a link, or of a coordinate (its drive), counted from 0."""

    link: int
    name: str

    @property
    def symbol(self) -> Any:
        """Its symbol, XX_1 say, counted from 1."""
        return sp.Symbol(f"{self.name}_{self.link + 1}")

    @property
    def place(self) -> tuple[int, int]:
        """What to sort by: from the base to the tip."""
        return self.link, NAMES.index(self.name)


class Energies:
    """The functions (K_k, P_k) of the standard parameters, over any ring, as they are asked for.

    With v the velocity of a frame's origin r, w the angular velocity and g gravity, all along the
    link's axes,

        K = 1/2 w^T I w + h . (v x w) + 1/2 m v . v + 1/2 IA qd^2,    P = -m g . r - h . g.
    """

    def __init__(self, model: Model, ring: Ring, rates: Sequence[Scalar]):
        self.ring = ring
        self._geometry = Geometry(model, ring)
        self._rates = rates
        self._velocities = self._geometry.velocities(rates)
        self._heights = self._geometry.along(vector(model.gravity, ring))
        self._bodies: list[dict[str, Functions]] = []

    def of(self, parameter: Standard) -> Functions:
        """Return (K_k, P_k) of a parameter."""
        i, name = parameter
        if name == "IA":
            return self._rates[i] * self._rates[i] * self.ring.half, self.ring.zero
        while len(self._bodies) <= i:
            self._bodies.append(self._next_body())
        return self._bodies[i][name]

    def _next_body(self) -> dict[str, Functions]:
        i, half, zero = len(self._bodies), self.ring.half, self.ring.zero
        (v, w), (height, g) = next(self._velocities), next(self._heights)
        mass = dot(v, v) * half, -height
        vw, w, g = (self._geometry.in_link(i, u) for u in (cross(v, w), w, g))
        tensor = {
            name: (w[j] * w[k] * half if j == k else w[j] * w[k], zero)
            for name, (j, k) in TENSOR.items()
        }
        moments = {name: (vw[j], -g[j]) for name, j in MOMENTS.items()}
        return {**tensor, **moments, "M": mass}


def values(model: Model, ring: TrigRing) -> dict[Standard, Trig]:
    """Return the standard parameters, those that are given."""
    found: dict[Standard, Trig] = {}
    for i, body in enumerate(model.bodies if BODIES.isdisjoint(model.not_set) else ()):
        moments = Moments.of(
            ring.convert(body.mass),
            vector(body.first_moment, ring),
            matrix(body.inertia, ring),
        )
        found |= {Standard(i, name): x for name, x in parameters(moments).items()}
    for j, x in enumerate(model.coordinates if "rotor_inertias" not in model.not_set else ()):
        found[Standard(j, "IA")] = ring.convert(x.drive.rotor_inertia)
    return found


def parameters(moments: Moments) -> dict[str, Scalar]:
    """Return XX .. M of a body."""
    J = moments.inertia
    tensor = {name: J[j][k] for name, (j, k) in TENSOR.items()}
    return {**tensor, **{name: moments.h[j] for name, j in MOMENTS.items()}, "M": moments.m}


def matrix(rows: Matrix, ring: Ring) -> Matrix:
    """Return a matrix of SymPy values as scalars of the ring."""
    x, y, z = (vector(row, ring) for row in rows)
    return x, y, z


def vector(components: Sequence[Any], ring: Ring) -> Vector:
    """Return three SymPy values as scalars of the ring."""
    x, y, z = map(ring.convert, components)
    return x, y, z
