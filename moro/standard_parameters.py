"""The standard inertial parameters of an arm: what its energies are linear in.

Each link has ten about the origin of its frame, along its axes: the inertia tensor XX, XY, XZ, YY,
YZ, ZZ (entries of the matrix, sign included), the first moments MX, MY, MZ and the mass M. A rotor
inertia IA comes on top. So

    K = sum_k p_k K_k(q, qd),    P = sum_k p_k P_k(q).

The frames are those of Khalil and Kleinfinger for both conventions: z_i along joint i, x_i along
the common normal to joint i + 1, the origin where they meet. (They are the frames of modified DH;
in standard DH, frame i before its shift along and its turn about x.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias

import sympy as sp

from moro.algorithms.vectors import add, product, times, transpose
from moro.chain import Chain, Row, Scalar, cross, dot
from moro.closed_form import Arm
from moro.model import Matrix, Vector
from moro.trig import Trig, TrigRing

TENSOR = {"XX": (0, 0), "XY": (0, 1), "XZ": (0, 2), "YY": (1, 1), "YZ": (1, 2), "ZZ": (2, 2)}
MOMENTS = {"MX": 0, "MY": 1, "MZ": 2}
#: those of a body
BODY = (*TENSOR, *MOMENTS, "M")
#: all of a link: its body, its rotor, viscous friction, Coulomb friction: half the sum of what
#: the two directions have, and half the difference
NAMES = (*BODY, "IA", "FV", "FC", "FD")

Functions: TypeAlias = "tuple[Scalar, Scalar]"


class Standard(NamedTuple):
    """One of ``NAMES`` of a link, counted from 0."""

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

    def __init__(self, arm: Arm, ring: Any, rates: Sequence[Scalar]):
        self.ring = ring
        self._chain = Chain(khalil_rows(arm), "mdh", ring, declare=False)
        self._rates = rates
        gravity = arm.gravity or (sp.Integer(0),) * 3
        self._velocities = self._chain.velocities(rates)
        self._heights = self._chain.along([ring.convert(x) for x in gravity])
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
        vw, w, g = (self._chain.in_frame(i, u) for u in (cross(v, w), w, g))
        tensor = {
            name: (w[j] * w[k] * half if j == k else w[j] * w[k], zero)
            for name, (j, k) in TENSOR.items()
        }
        moments = {name: (vw[j], -g[j]) for name, j in MOMENTS.items()}
        return {**tensor, **moments, "M": mass}


def values(arm: Arm, ring: TrigRing) -> dict[Standard, Trig]:
    """Return the standard parameters, those that are given, by Steiner's theorem."""
    found: dict[Standard, Trig] = {}
    given = (arm.masses, arm.cm_positions, arm.inertia_tensors)
    for i in range(len(arm.rows)) if all(given) else ():
        mass, cm, tensor = (x[i] for x in given if x)
        m, c, I = ring.convert(mass), vector(cm, ring), [vector(x, ring) for x in tensor]
        R, p = rotation_x(0, ring), vector((0, 0, 0), ring)
        if arm.convention == "dh":
            R, p = rotation_x(arm.rows[i].alpha, ring), vector((arm.rows[i].a, 0, 0), ring)
        body = Moments(m, vector((0, 0, 0), ring), complement((I[0], I[1], I[2]), ring.half))
        body = body.displaced(c).turned(R).displaced(p)
        found |= {Standard(i, name): x for name, x in body.parameters().items()}
    for i, rotor in enumerate(arm.rotor_inertias or ()):
        found[Standard(i, "IA")] = ring.convert(rotor)
    return found


def khalil_rows(arm: Arm) -> tuple[Row, ...]:
    """Return the arm's rows as modified DH: a and alpha of standard DH belong to the row after."""
    if arm.convention == "mdh":
        return arm.rows
    before = [(sp.Integer(0), sp.Integer(0)), *((row.a, row.alpha) for row in arm.rows[:-1])]
    return tuple(
        replace(row, a=a, alpha=alpha) for row, (a, alpha) in zip(arm.rows, before, strict=True)
    )


class Moments(NamedTuple):
    """The inertial parameters of a body as integrals of dm, r dm and r r^T dm."""

    m: Scalar
    h: Vector
    S: Matrix

    def turned(self, R: Matrix) -> Moments:
        """Return the moments along other axes, r -> R r."""
        return Moments(self.m, times(R, self.h), product(product(R, self.S), transpose(R)))

    def displaced(self, p: Vector) -> Moments:
        """Return the moments about the point -p, r -> r + p."""
        m, h, S = self
        moved = add(h, (m * p[0], m * p[1], m * p[2]))
        x, y, z = (
            tuple(S[i][j] + h[i] * p[j] + p[i] * moved[j] for j in range(3)) for i in range(3)
        )
        return Moments(m, moved, (x, y, z))

    def parameters(self) -> dict[str, Scalar]:
        """Return XX .. M."""
        I = complement(self.S, 1)
        tensor = {name: I[j][k] for name, (j, k) in TENSOR.items()}
        return {**tensor, **{name: self.h[j] for name, j in MOMENTS.items()}, "M": self.m}


def complement(A: Matrix, factor: Any) -> Matrix:
    """Return factor tr(A) 1 - A: by 1, the tensor of second moments; by 1/2, the way back."""
    trace = (A[0][0] + A[1][1] + A[2][2]) * factor
    x, y, z = (tuple(trace - A[j][k] if j == k else -A[j][k] for k in range(3)) for j in range(3))
    return x, y, z


def rotation_x(angle: Any, ring: TrigRing) -> Matrix:
    """Rx(angle)."""
    (s, c), one, zero = ring.sincos(sp.sympify(angle)), ring.one, ring.zero
    return (one, zero, zero), (zero, c, -s), (zero, s, c)


def rotation_z(angle: Any, ring: TrigRing) -> Matrix:
    """Rz(angle)."""
    (s, c), one, zero = ring.sincos(sp.sympify(angle)), ring.one, ring.zero
    return (c, -s, zero), (s, c, zero), (zero, zero, one)


def vector(components: Sequence[Any], ring: TrigRing) -> Vector:
    """Return three SymPy values as scalars of the ring."""
    x, y, z = map(ring.convert, components)
    return x, y, z
