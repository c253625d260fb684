"""SymPy's lambdify of the closed-form equations of motion: what SymPy alone offers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import sympy as sp

from benchmarks.arms import Arm
from benchmarks.native import Loop
from benchmarks.tasks import Call, Task
from moro_codegen.benchmark import LAMBDIFY_TERMS, lambdify_tau
from moro_codegen.proof.verification import SymbolicRoute

NAME = "SymPy lambdify"

VERSIONS = {"sympy": sp.__version__}


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield nothing: it is Python."""
    return
    yield


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield tau, where its closed form is short enough for SymPy to print and Python to compile."""
    route = SymbolicRoute(arm.robot)
    if route.is_closed_form and route.terms <= LAMBDIFY_TERMS:
        yield Call(NAME, lambdify_tau(arm.robot), prepare=_numbers)


def _numbers(*state: np.ndarray) -> list[float]:
    """Return a state as plain floats, which is what ``math`` is fastest with."""
    return np.concatenate(state).tolist()
