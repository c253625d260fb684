"""How accurate a kernel is: its torques against the same dynamics in 50 digits.

The exact torques are Newton-Euler's for the model as it was given, decimals as rationals, at the
very numbers that the kernel gets. They share the textbook algorithm with the kernel, not the
graph, its base parameters, its sines and its rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import mpmath
import numpy as np
import numpy.typing as npt
import sympy as sp

from moro.algorithms.coordinates import displacements
from moro.algorithms.drives import Functions, drive_torques, spring_torques
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import posture
from moro.model import Model
from moro_codegen.kernel.kernel import Kernel

Array: TypeAlias = npt.NDArray[np.floating[Any]]

DIGITS = 50


def exact_tau(
    model: Model, q: Sequence[float], qd: Sequence[float], qdd: Sequence[float]
) -> list[Any]:
    """Return tau of one state as numbers of mpmath with 50 digits [N m or N].

    The model must have numbers only, no symbols.
    """
    with mpmath.workdps(DIGITS):
        precise = model.map(_number)
        x, xd, xdd = ([mpmath.mpf(float(number)) for number in row] for row in (q, qd, qdd))
        pairs = [(mpmath.sin(angle), mpmath.cos(angle)) for angle in displacements(precise, x)]
        rigid = joint_torques(posture(precise, x, pairs), xd, xdd)
        functions = Functions(mpmath.sign, mpmath.tanh, mpmath.exp)
        drives = drive_torques(precise, xd, xdd, functions)
        return list(map(sum, zip(rigid, drives, spring_torques(precise, x), strict=True)))


def tau_errors(kernel: Kernel, model: Model, q: Array, qd: Array, qdd: Array) -> Array:
    """Return the largest error of tau at each state, relative to its largest torque.

    States have shape (states, n) and the kernel's own type, so that it gets them unrounded.
    """
    errors = []
    for found, *state in zip(kernel.tau(q, qd, qdd), q, qd, qdd, strict=True):
        exact = exact_tau(model, *state)
        with mpmath.workdps(DIGITS):
            apart = [abs(mpmath.mpf(float(x)) - y) for x, y in zip(found, exact, strict=True)]
            errors.append(float(max(apart) / max(map(abs, exact))))
    return np.array(errors)


def sine_errors(found: Array, angles: Array, function: str) -> Array:
    """Return the errors of sines or cosines ("sin", "cos") in units in the last place."""
    exact_function = getattr(mpmath, function)
    errors = []
    for y, x in zip(found, angles, strict=True):
        with mpmath.workdps(DIGITS):
            exact = exact_function(mpmath.mpf(float(x)))
            unit = np.spacing(np.abs(found.dtype.type(float(exact))))
            errors.append(float(abs(mpmath.mpf(float(y)) - exact) / mpmath.mpf(float(unit))))
    return np.array(errors)


def _number(value: Any) -> Any:
    """Return a number of SymPy's in mpmath's precision."""
    number = sp.sympify(value)
    if number.is_Rational:
        return mpmath.mpf(int(number.p)) / int(number.q)
    return mpmath.mpf(sp.Float(number.evalf(DIGITS), DIGITS)._mpf_)
