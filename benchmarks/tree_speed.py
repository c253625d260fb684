"""Times of tau of robots in files, side by side: `python -m benchmarks.tree_speed FILE ...`.

moro's kernel, Pinocchio's rnea in C++, and CasADi's C of the same recursion, one call after the
other with the same rigid bodies: drives are left out, and coordinates that move several joints too,
which Pinocchio does not have. Times are of the processor, the best of many rounds, by turns.
"""

from __future__ import annotations

import argparse
import ctypes
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

import moro
import moro_codegen as mc
from benchmarks import native
from benchmarks.peers import pinocchio
from benchmarks.timing import interleaved, seconds_of
from moro.algorithms.coordinates import displacements
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import posture
from moro.model import Coordinate, Drive, Model

STOPWATCH = """
#include <time.h>
typedef void call(const double *, const double *, const double *, double *);
double seconds(call *f, const double *q, const double *v, const double *a, double *out, int n) {
  struct timespec x, y;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &x);
  for (int i = 0; i < n; ++i) f(q, v, a, out);
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &y);
  return (y.tv_sec - x.tv_sec) + 1e-9 * (y.tv_nsec - x.tv_nsec);
}
"""
WRAPPER = """
void tau(const double *q, const double *v, const double *a, double *out) {
  const double *arg[] = {q, v, a};
  double *res[] = {out};
  static double w[1 << 20];
  rnea(arg, res, 0, w, 0);
}
"""
CALLS, BATCH = 400, 4096


def main() -> None:
    """Print a line for each file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    print(f"{'robot':16} joints operations   moro  CasADi   ratio  Pinocchio   ratio  batch  [ns]")
    for path in parser.parse_args().files:
        print(line(path), flush=True)


def line(path: Path) -> str:
    """Return the figures of a robot. Raise ValueError where results differ."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = bare(moro.load(path).model())
    kernel = mc.compile(model)
    n = model.nv
    state = np.random.default_rng(0).uniform(-1, 1, (3, n))
    watch = native.library("watch", {"watch.c": STOPWATCH}).seconds
    watch.restype = ctypes.c_double
    out = {name: np.zeros(n) for name in ("moro", "CasADi", "Pinocchio")}
    functions = {
        "moro": ctypes.CDLL(str(kernel.library))[f"{kernel.name}_tau"],
        "CasADi": native.library("casadi_tree", {"rnea.c": by_casadi(model)}).tau,
    }

    def calls(name: str) -> Any:
        arguments = [_pointer(x) for x in (*state, out[name])]
        return lambda times: watch(functions[name], *arguments, CALLS * times)

    blocks = {name: calls(name) for name in functions}
    blocks["Pinocchio"] = by_pinocchio(model, state, out["Pinocchio"])
    times = {name: x.best * 1e9 for name, x in interleaved(blocks, CALLS).items()}
    expected = kernel.tau(*state)
    for name, found in out.items():
        if not np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()):
            raise ValueError(f"{name} differs for {path.name}: {np.abs(found - expected).max()}")
    many = np.random.default_rng(0).uniform(-1, 1, (3, BATCH, n))
    buffer = np.empty((BATCH, n))
    batch = interleaved({"": lambda k: _timed(lambda: kernel.tau(*many, out=buffer), k)}, BATCH)
    ops = sum(x for op, x in kernel.ops["tau"].items() if op != "sincos")
    ours, casadi, pin = (times[name] for name in ("moro", "CasADi", "Pinocchio"))
    return (
        f"{path.stem[:16]:16} {n:6} {ops:10} {ours:6.0f} {casadi:7.0f} {casadi / ours:7.1f}"
        f" {pin:10.0f} {pin / ours:7.1f} {batch[''].best * 1e9:6.0f}"
    )


def bare(model: Model) -> Model:
    """Return a model without drives, in which each coordinate moves one joint."""
    if model.is_coupled:
        joints = tuple(
            replace(joint, terms=((i, 1),), offset=0) for i, joint in enumerate(model.joints)
        )
        model = replace(model, joints=joints, coordinates=())
    coordinates = tuple(Coordinate(drive=Drive()) for _ in model.joints)
    return replace(model, coordinates=coordinates, name="bare")


def by_casadi(model: Model) -> str:
    """Return CasADi's C of the recursion."""
    numbers = model.map(float)
    q, v, a = (ca.SX.sym(name, model.nv) for name in "qva")
    x = ca.vertsplit(q)
    angles = displacements(numbers, x)
    arm = posture(numbers, x, [(ca.sin(angle), ca.cos(angle)) for angle in angles])
    tau = ca.vertcat(*joint_torques(arm, ca.vertsplit(v), ca.vertsplit(a)))
    function = ca.Function("rnea", [q, v, a], [ca.cse(tau)])
    generator = ca.CodeGenerator("rnea.c")
    generator.add(function)
    return generator.dump() + WRAPPER


def by_pinocchio(model: Model, state: Any, out: Any) -> Any:
    """Return Pinocchio's rnea of the same numbers, as blocks of calls."""
    made, numbers = pinocchio._library(), model.map(float)
    inertias, coms = [], []
    for body in numbers.bodies:
        m, h = body.mass, np.array(body.first_moment)
        c = h / m if m else h
        coms.append(c)
        inertias.append(np.array(body.inertia) - m * (c @ c * np.eye(3) - np.outer(c, c)))
    turns = [_turned(x.placement.R, x.offset * x.type.is_angle) for x in numbers.joints]
    handle = native.handle(
        made.arm_new,
        model.nv,
        np.array([joint.parent for joint in model.joints], dtype=np.int32),
        np.array([joint.type.is_angle for joint in model.joints], dtype=np.int32),
        np.array(turns),
        np.array([joint.placement.p for joint in numbers.joints]),
        np.array([body.mass for body in numbers.bodies]),
        np.array(coms),
        np.array(inertias),
        np.array(numbers.gravity),
    )
    rows = [np.tile(x, (CALLS, 1)) for x in state]
    result = np.zeros((CALLS, model.nv))
    ins = (ctypes.POINTER(ctypes.c_double) * 3)(*map(_pointer, rows))
    outs = (ctypes.POINTER(ctypes.c_double) * 1)(_pointer(result))

    def block(times: int, _kept: Any = rows) -> float:  # ins points to them
        seconds = _timed(lambda: made.tau_loop(handle, ctypes.c_size_t(CALLS), ins, outs), times)
        out[:] = result[0]
        return seconds

    return block


def _turned(R: Any, angle: float) -> Any:
    c, s = np.cos(angle), np.sin(angle)
    return np.array(R) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def _timed(call: Callable[[], object], times: int) -> float:
    """Return the processor seconds of some calls."""
    own, _ = seconds_of(lambda: [call() for _ in range(times)])
    return own


def _pointer(x: Any) -> Any:
    return x.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


if __name__ == "__main__":
    main()
