"""Trajectories: a kernel's step, again and again, for one start or many side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]
#: torques for the number of the step and the state at its beginning
Controller: TypeAlias = Callable[[int, Array, Array], ArrayLike]


def rollout(
    step: Callable[..., Any],
    q: ArrayLike,
    qd: ArrayLike,
    tau: ArrayLike | Controller,
    dt: ArrayLike,
    steps: int | None,
    dtype: Any,
    **options: Any,
) -> tuple[Array, Array]:
    """Return q and qd at the beginning and after every step, (..., steps + 1, n)."""
    start = [np.asarray(x, dtype) for x in (q, qd)]
    if callable(tau):
        if steps is None:
            raise TypeError("where tau is a function, rollout needs the number of steps: steps=100")
        controller, many, samples = tau, steps, ()
    else:
        torques = np.asarray(tau, dtype)
        if torques.ndim < 2:
            raise ValueError(
                f"tau has shape {torques.shape}: a row of torques for every step, (..., steps, n)"
            )
        if steps not in (None, torques.shape[-2]):
            raise ValueError(f"steps is {steps}, but tau has rows for {torques.shape[-2]}")
        many, samples = torques.shape[-2], (*torques.shape[:-2], torques.shape[-1])

        def controller(k: int, _q: Array, _qd: Array) -> ArrayLike:
            row: Array = torques[..., k, :]
            return row

    shape = np.broadcast_shapes(*(x.shape for x in start), samples)
    places, rates = (np.empty((many + 1, *shape), dtype) for _ in range(2))
    places[0], rates[0] = start
    dt = np.asarray(dt, dtype)
    for k in range(many):
        here = places[k], rates[k]
        # new results: with out= a call that returns two does not go straight to C
        places[k + 1], rates[k + 1] = step(*here, controller(k, *here), dt, **options)
    return np.moveaxis(places, 0, -2), np.moveaxis(rates, 0, -2)
