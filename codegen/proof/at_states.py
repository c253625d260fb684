"""The formulas of the texts at states, as arrays: M, C and G of robots of any length.

In the axes of frame 0, with the Jacobians Jv of the origin of each link's frame and Jw of its
turning, the first moment h and the tensor J about this origin,

    M = sum of Jv^T (m Jv + Jw x h) + Jw^T (J Jw + h x Jv),    and the rotors on the diagonal.

The Christoffel symbols are summed over qd before they are formed, which takes n^2 numbers and not
n^3: with p = M qd, where qd is held fixed,

    C_ij = sum_k c_ijk qd_k = 1/2 (dM_ij/dt + dp_i/dq_j - dp_j/dq_i).

Derivatives are those of dual numbers (``moro.scalars.dual``). A vector is three of them, each an
array over joints and states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from moro.closed_form import ClosedForm
from moro.model import Frame, Model, Placement
from moro.scalars.dual import Dual, DualRing
from moro.spatial.motion import REST
from moro.spatial.vectors import Vector, add, cross, difference_of, dot, product, times, transpose

Array: TypeAlias = npt.NDArray[Any]

#: numbers of an array over joints, joints and states: more than fit into a cache take longer
BLOCK = 1 << 18


def block(n: int) -> int:
    """Return how many states of an arm with n joints are evaluated at once."""
    return max(1, BLOCK // n**2)


def matrices(model: Model, values: Mapping[Any, Any], qd: Array) -> tuple[Array, Array, Array]:
    """Return M, C (n, n, states) and G (n, states) of a model.

    ``values`` gives the joint variables (states) and the other symbols; ``qd`` is (n, states). All
    may be complex.
    """
    form = ClosedForm(model, DualRing(model.qs, values))
    joints, A = _Joints.of(form), _ratios(form)
    M, C = (np.zeros((form.n, *qd.shape), np.result_type(qd, form.ring.one.value)) for _ in "MC")
    for i in range(len(model.bodies)):
        moving, carrying = model.moving(i), sorted([i, *model.ancestors(i)])
        own = np.ix_(moving, moving)  # link i does not feel other joints
        ratios = A[np.ix_(moving, carrying)] if model.is_coupled else None
        factors, p = _link(form, i, joints.some(carrying, moving), ratios, qd[moving], moving)
        for u, v in factors:
            M[own] += _outer(u.value, v.value)
            rate = _outer(_rate(u, qd[moving]), v.value) + _outer(u.value, _rate(v, qd[moving]))
            C[own] += rate / 2
        C[own] += (np.swapaxes(p.gradient, 0, 1) - p.gradient) / 2
    for j, x in enumerate(model.coordinates):
        M[j, j] += form.ring.convert(x.drive.rotor_inertia).value
    return M, C, np.array([x.value for x in form.gravity_vector])


@dataclass(frozen=True)
class _Joints:
    """How fast joints turn about and slide along their axes, and a point on each axis."""

    turning: Vector
    sliding: Vector
    anchors: Vector

    @classmethod
    def of(cls, form: ClosedForm) -> _Joints:
        rates = [joint.type.moved(REST, 1) for joint in form.model.joints]
        turns, slides = (
            np.array([x[2] for x in both], float)[:, np.newaxis]
            for both in zip(*rates, strict=True)
        )
        z, anchors = map(_over_joints, (form.geometry.axes, form.geometry.anchors))
        return cls((z[0] * turns, z[1] * turns, z[2] * turns),
                   (z[0] * slides, z[1] * slides, z[2] * slides), anchors)  # fmt: skip

    def some(self, chosen: Sequence[int], moving: Sequence[int]) -> _Joints:
        """Return some of the joints, with the derivatives by some coordinates."""

        def part(v: Vector) -> Vector:
            x, y, z = (Dual(x.value[chosen], x.gradient[np.ix_(moving, chosen)]) for x in v)
            return x, y, z

        return _Joints(part(self.turning), part(self.sliding), part(self.anchors))


def _link(
    form: ClosedForm,
    i: int,
    joints: _Joints,
    ratios: Array | None,
    qd: Array,
    moving: Sequence[int],
) -> tuple[list[tuple[Dual, Dual]], Dual]:
    """Return what link i adds: pairs (u, v) of M = sum of u v^T, and p = M qd with qd fixed.

    ``joints`` are those that carry the link; ``ratios``, coordinates by joints, are A^T (None: 1).
    """

    def alike(v: Vector) -> Vector:
        x, y, z = (_alike(component, moving) for component in v)
        return x, y, z

    def given(v: Vector) -> Vector:
        x, y, z = map(form.ring.convert, v)
        return alike((x, y, z))

    body = form.model.bodies[i]
    mass = form.ring.convert(body.mass).value
    (x, y, z), origin = form.geometry.pose(Frame("", i, Placement()))
    (a, b, c), R = body.inertia, (alike(x), alike(y), alike(z))
    h, J = times(R, given(body.first_moment)), (given(a), given(b), given(c))
    J = product(product(R, J), transpose(R))
    Jw = joints.turning
    Jv = add(cross(Jw, difference_of(alike(origin), joints.anchors)), joints.sliding)
    if ratios is not None:
        Jv, Jw = (_in_coordinates(v, ratios) for v in (Jv, Jw))

    def momenta(v: Vector, w: Vector) -> tuple[Vector, Vector]:
        """Return linear and angular momentum, m v + w x h and J w + h x v."""
        linear = v[0] * mass, v[1] * mass, v[2] * mass
        return add(linear, cross(w, h)), add(times(J, w), cross(h, v))

    linear, angular = momenta(Jv, Jw)
    v, w = ((_along(x, qd), _along(y, qd), _along(z, qd)) for x, y, z in (Jv, Jw))
    f, n = momenta(v, w)
    return list(zip((*Jv, *Jw), (*linear, *angular), strict=True)), dot(Jv, f) + dot(Jw, n)


def _ratios(form: ClosedForm) -> Array:
    """Return A^T over the states (coordinates, joints, states)."""
    A = np.zeros((form.n, len(form.model.joints), *form.ring.one.value.shape))
    for k, row in enumerate(form.geometry.terms):
        for j, ratio in row:
            A[j, k] = ratio if isinstance(ratio, int) else ratio.value.real
    return A


# -- dual numbers over joints and states: value (joints, states), gradient (by, joints, states) ----


def _over_joints(vectors: Sequence[Vector]) -> Vector:
    """Return one vector for those of all joints."""
    x, y, z = (
        Dual(np.stack([x.value for x in same]), np.stack([x.gradient for x in same], axis=1))
        for same in zip(*vectors, strict=True)
    )
    return x, y, z


def _in_coordinates(v: Vector, ratios: Array) -> Vector:
    """Return the columns of a Jacobian over coordinates, from those over joints."""
    x, y, z = (
        Dual(
            np.einsum("jks,ks->js", ratios, x.value), np.einsum("jks,gks->gjs", ratios, x.gradient)
        )
        for x in v
    )
    return x, y, z


def _alike(x: Dual, moving: Sequence[int]) -> Dual:
    """Return a number that is the same for all joints, with the derivatives by some of them."""
    return Dual(x.value[np.newaxis], x.gradient[moving][:, np.newaxis])


def _along(x: Dual, qd: Array) -> Dual:
    """Return the sum over joints of x_k qd_k, with qd held fixed."""
    value = np.einsum("ks,ks->s", x.value, qd)
    return Dual(value[np.newaxis], np.einsum("gks,ks->gs", x.gradient, qd)[:, np.newaxis])


def _rate(x: Dual, qd: Array) -> Array:
    """Return dx/dt."""
    rate: Array = np.einsum("gks,gs->ks", x.gradient, qd)
    return rate


def _outer(u: Array, v: Array) -> Array:
    product: Array = u[:, np.newaxis] * v[np.newaxis]
    return product
