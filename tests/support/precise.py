"""Derivatives of graphs by differences of 60-digit numbers."""

import mpmath
import numpy as np

from moro_codegen.graph.precise import evaluate

DIGITS = 60
STEP = mpmath.mpf(10) ** -20


def differences(results, inputs, variables):
    """d results_i / d variables_j by central differences, as an array of floats."""
    columns = []
    with mpmath.workdps(DIGITS):
        for variable in variables:
            here = mpmath.mpf(inputs[variable])
            above = evaluate(results, {**inputs, variable: here + STEP})
            below = evaluate(results, {**inputs, variable: here - STEP})
            columns.append([float((a - b) / (2 * STEP)) for a, b in zip(above, below, strict=True)])
    return np.array(columns).T.reshape(len(results), len(columns))
