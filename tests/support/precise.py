"""Graphs evaluated in mpmath's precision, and derivatives by differences of 60-digit numbers."""

from fractions import Fraction

import mpmath
import numpy as np

from moro_codegen.graph.nodes import schedule

DIGITS = 60
STEP = mpmath.mpf(10) ** -20
CALLS = {"fabs": abs, "pow": mpmath.power}
OPERATIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "sign": mpmath.sign,
}


def evaluate(results, inputs):
    """Values of nodes; ``inputs`` maps input nodes to numbers."""
    values = dict(inputs)

    def value(node):
        if node.op != "const":
            return values[node]
        exact = Fraction(node.value)
        return mpmath.mpf(exact.numerator) / exact.denominator

    for node in schedule(results):
        name = node.value if node.op == "call" else None
        function = CALLS.get(name) or getattr(mpmath, name) if name else OPERATIONS[node.op]
        values[node] = function(*map(value, node.args))
    return [value(node) for node in results]


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
