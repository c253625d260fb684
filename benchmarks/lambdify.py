"""Symbolic results as NumPy functions: ``mc.lambdify`` beside ``sympy.lambdify``.

Prints, for M and C of the packaged arms, the seconds to make the function, the microseconds of one
call and of a batch (CPU time, the fastest of several runs), and the ratios. SymPy's functions share
common subexpressions (``cse=True``); in a batch they return one array an entry, which is stacked
here, as a matrix for each sample is what is asked for.

    python benchmarks/lambdify.py [arm ...]
"""

import sys
import time

import numpy as np
import sympy as sp

import moro as mr
import moro_codegen as mc
from moro.abc import t

BATCH, RUNS = 4096, 15
ARMS = ("two_link", "stanford_arm", "puma560", "ur5")


def main(arms):
    """Print the table."""
    print(f"{'':18}{'make [s]':>28}{'one call [us]':>28}{f'batch of {BATCH} [us]':>28}")
    print(f"{'':18}" + f"{'sympy':>10}{'moro':>10}{'ratio':>8}" * 3)
    for arm in arms:
        robot = mr.load(arm)
        for name, matrix in (("M", robot.inertia_matrix()), ("C", robot.coriolis_matrix())):
            print(f"{arm + ' ' + name:18}" + "".join(map(_columns, compared(robot, matrix))))


def compared(robot, matrix):
    """Yield pairs of times, SymPy's and ours: to make the function, one call, a batch."""
    (ours, make), (theirs, their_make) = (
        timed(mc.lambdify, matrix, robot),
        timed(by_sympy, matrix, robot),
    )
    yield their_make, make
    rng = np.random.default_rng(0)
    states = rng.uniform(-3, 3, (2, BATCH, robot.dof))
    has_speed = "qd" in ours.__doc__
    batch = states[: 1 + has_speed]
    one = [x[0].copy() for x in batch]
    np.testing.assert_allclose(ours(*batch), theirs(*batch), atol=1e-9)
    for given, repeats in ((one, 200), (batch, 1)):
        best = np.full(2, np.inf)
        for _ in range(RUNS):
            for k, function in enumerate((theirs, ours)):
                start = time.process_time()
                for _ in range(repeats):
                    function(*given)
                best[k] = min(best[k], (time.process_time() - start) / repeats)
        yield tuple(best * 1e6)


def timed(make, *arguments):
    """Return what is made, and the seconds that took."""
    start = time.perf_counter()
    return make(*arguments), time.perf_counter() - start


def by_sympy(matrix, robot):
    """Return f(q[, qd]) by sympy.lambdify, of one state or of many."""
    rates = [q.diff(t) for q in robot.qs]
    plain = {x: sp.Dummy() for x in [*rates, *robot.qs]}  # derivatives first
    expressions = matrix.xreplace(plain)
    of_one = sp.lambdify(plain.values(), expressions, "numpy", cse=True)
    of_many = sp.lambdify(plain.values(), list(expressions), "numpy", cse=True)

    def function(q, qd=None):
        qd = np.zeros_like(q) if qd is None else qd
        if q.ndim == 1:
            return of_one(*qd, *q)
        columns = np.broadcast_arrays(*of_many(*qd.T, *q.T), q[:, 0])[:-1]
        return np.stack(columns, axis=-1).reshape(len(q), *matrix.shape)

    return function


def _columns(pair):
    theirs, ours = pair
    return f"{theirs:10.3g} {ours:9.3g} {theirs / ours:6.1f}x"


if __name__ == "__main__":
    main(sys.argv[1:] or ARMS)
