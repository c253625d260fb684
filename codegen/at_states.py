"""The formulas of the texts at states, as arrays: M, C and G of arms of any length.

In the axes of frame 0, with the Jacobians Jv of each link's centre of mass and Jw of its turning,

    M = sum of m Jv^T Jv + Jw^T I Jw,    I = R I_C R^T,    and the rotor inertias on the diagonal.

The Christoffel symbols are summed over qd before they are formed, which takes n^2 numbers and not
n^3: with p = M qd, where qd is held fixed,

    C_ij = sum_k c_ijk qd_k = 1/2 (dM_ij/dt + dp_i/dq_j - dp_j/dq_i).

Derivatives are those of dual numbers (``moro.dual``). A vector is three of them, each an array over
joints and states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from moro.chain import Vec, cross, dot
from moro.closed_form import Arm, ClosedForm, given
from moro.dual import Dual, DualRing

Array: TypeAlias = npt.NDArray[Any]

#: numbers of an array over joints, joints and states: more than fit into a cache take longer
BLOCK = 1 << 18


def block(n: int) -> int:
    """Return how many states of an arm with n joints are evaluated at once."""
    return max(1, BLOCK // n**2)


def matrices(
    arm: Arm, variables: Sequence[Any], values: Mapping[Any, Any], qd: Array
) -> tuple[Array, Array, Array]:
    """Return M, C (n, n, states) and G (n, states) of an arm.

    ``values`` gives the joint variables (states) and the other symbols; ``qd`` is (n, states). All
    may be complex.
    """
    form = ClosedForm(arm, DualRing(variables, values))
    joints = _Joints.of(form)
    M, C = (np.zeros((form.n, *qd.shape), np.result_type(qd, form.ring.one.value)) for _ in "MC")
    for i in range(form.n):
        own = slice(i + 1)  # link i does not feel the joints behind it
        factors, p = _link(form, i, joints.first(i + 1), qd[own])
        for u, v in factors:
            M[own, own] += _outer(u.value, v.value)
            rate = _outer(_rate(u, qd[own]), v.value) + _outer(u.value, _rate(v, qd[own]))
            C[own, own] += rate / 2
        C[own, own] += (np.swapaxes(p.gradient, 0, 1) - p.gradient) / 2
    for j, rotor in enumerate(arm.rotor_inertias or ()):
        M[j, j] += form.ring.convert(rotor).value
    return M, C, np.array([x.value for x in form.gravity_vector])


@dataclass(frozen=True)
class _Joints:
    """The axes of joints that turn (0 for the others), of those that slide, a point on each."""

    turning: Vec
    sliding: Vec
    anchors: Vec

    @classmethod
    def of(cls, form: ClosedForm) -> _Joints:
        turns = np.array([[float(row.kind == "r")] for row in form.arm.rows])
        axes, anchors = _over_joints(form.chain.axes), _over_joints(form.chain.anchors)
        return cls([z * turns for z in axes], [z * (1 - turns) for z in axes], anchors)

    def first(self, count: int) -> _Joints:
        """Return the first joints."""

        def part(v: Vec) -> Vec:
            return [Dual(x.value[:count], x.gradient[:count, :count]) for x in v]

        return _Joints(part(self.turning), part(self.sliding), part(self.anchors))


def _link(
    form: ClosedForm, i: int, joints: _Joints, qd: Array
) -> tuple[list[tuple[Dual, Dual]], Dual]:
    """Return what link i adds: pairs (u, v) of M = sum of u v^T, and p = M qd with qd fixed."""
    convert, chain, arm, count = form.ring.convert, form.chain, form.arm, len(qd)
    mass = convert(given(arm.masses)[i]).value
    com = [convert(x) for x in given(arm.cm_positions)[i]]
    tensor = [[convert(x) for x in row] for row in given(arm.inertia_tensors)[i]]
    point = [_alike(x, count) for x in chain.point_in_base(i, com)]
    I = [[_alike(x, count) for x in row] for row in chain.tensor_in_base(i, tensor)]
    arms = [x - y for x, y in zip(point, joints.anchors, strict=True)]
    Jw = joints.turning
    Jv = [x + y for x, y in zip(cross(Jw, arms), joints.sliding, strict=True)]
    v, w = ([_along(x, qd) for x in J] for J in (Jv, Jw))
    p = dot(Jv, [x * mass for x in v]) + dot(Jw, [dot(row, w) for row in I])
    pairs = [(x * mass, x) for x in Jv] + [(x, dot(row, Jw)) for x, row in zip(Jw, I, strict=True)]
    return pairs, p


# -- dual numbers over joints and states: value (joints, states), gradient (by, joints, states) ----


def _over_joints(vectors: Sequence[Vec]) -> Vec:
    """Return one vector for those of all joints."""
    return [
        Dual(np.stack([x.value for x in same]), np.stack([x.gradient for x in same], axis=1))
        for same in zip(*vectors, strict=True)
    ]


def _alike(x: Dual, count: int) -> Dual:
    """Return a number that is the same for all joints, with the derivatives by the first ones."""
    return Dual(x.value[np.newaxis], x.gradient[:count, np.newaxis])


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
