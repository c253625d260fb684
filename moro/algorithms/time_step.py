"""One step in time of an arm with dry friction, over any scalar.

The semi-implicit Euler step finds the velocity v at its end from the impulses of the step h:

    (M + h D + h^2 K) v = b - p,    b = M qd + h (tau - C qd - G - friction + D qd),

with M, C, G, springs and smooth friction at its beginning. The slopes D of the friction and the
stiffnesses K of the springs take these two to its end. The impulse p of dry friction is what is
needed to stop a joint, up to h times its magnitude: p_i between -h c_i and h c_i, at the bound that
opposes v_i unless v_i = 0 (Moreau 1988). That determines v, as the minimum of a convex function,
which ``SWEEPS`` of projected Gauss-Seidel approach. They start from the impulses that would stop
every joint, where these are within bounds: if all are, then v is 0 exactly, so that an arm at rest
stays where it is. ``+ - *`` and divisions are asked of the scalars, and ``clamped``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from moro.spatial.vectors import Scalar

#: of Gauss-Seidel, for joints that stick while others slide
SWEEPS = 6


def velocities_after(
    inverse: Sequence[Sequence[Scalar]],
    impulse: Sequence[Scalar],
    bounds: Sequence[tuple[Scalar, Scalar] | None],
    clamped: Callable[[Scalar, Scalar, Scalar], Scalar],
) -> list[Scalar]:
    """Return v = A (b - p) for A = ``inverse``, b = ``impulse``, and p of dry friction.

    ``bounds`` are (lower, upper) of p_i, None where there is no dry friction; ``clamped(x, lower,
    upper)`` is the number between the two that is nearest to x.
    """
    dry = {i: bound for i, bound in enumerate(bounds) if bound is not None}
    p = {i: clamped(impulse[i], *bound) for i, bound in dry.items()}
    left = [b - p[i] if i in p else b for i, b in enumerate(impulse)]
    v = [sum(a * x for a, x in zip(row, left, strict=True)) for row in inverse]
    reciprocals = {i: 1 / inverse[i][i] for i in dry}
    for _ in range(SWEEPS):
        for i, bound in dry.items():
            new = clamped(p[i] + reciprocals[i] * v[i], *bound)
            change, p[i] = new - p[i], new
            v = [x - row[i] * change for x, row in zip(v, inverse, strict=True)]
    return v
