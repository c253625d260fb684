"""Files of robots, whole folders of them, against another program's reading of them.

The kernel of each: tau (with all that the file puts at the joints), bias, inertia matrix, forward
dynamics, pose and Jacobian of the tip, and the poses of all links and their Jacobians are compared
at random states, relative to the largest value of each. What is refused is listed with its reason.
Files that say the same are read once.
"""

from __future__ import annotations

import argparse
import ctypes
import hashlib
import subprocess
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import numpy as np

import moro
import moro_codegen as mc
from moro.algorithms.coordinates import displacements
from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.posture import posture, with_frame

FUNCTIONS = ("tau", "bias", "inertia_matrix", "forward_kinematics", "jacobian")
STATES = 8
STOPWATCH = """
#include <time.h>
typedef void tau(const double *, const double *, const double *, double *);
double best(tau *f, const double *q, const double *v, const double *a, double *out, int n) {
  double least = 1e9;
  for (int round = 0; round < 25; ++round) {
    struct timespec x, y;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &x);
    for (int i = 0; i < n; ++i) f(q, v, a, out);
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &y);
    double t = (y.tv_sec - x.tv_sec) * 1e9 + (y.tv_nsec - x.tv_nsec);
    if (t / n < least) least = t / n;
  }
  return least;
}
"""


@dataclass
class Line:
    """What the table says of a robot."""

    robot: str
    joints: int
    error: float
    worst: str
    operations: int
    made: float
    compiled: float
    call: float

    HEADINGS = (
        "robot",
        "joints",
        "error",
        "of",
        "operations",
        "load + generate",
        "compile",
        "call",
    )

    @property
    def cells(self) -> tuple[str, ...]:
        """The same as texts."""
        return (
            self.robot,
            str(self.joints),
            f"{self.error:.1e}",
            self.worst,
            str(self.operations),
            f"{self.made:.2f} s",
            f"{self.compiled:.1f} s",
            f"{self.call:.0f} ns",
        )


class Peer(Protocol):
    """Another program's model of a file, in the coordinates of moro's."""

    def tau(self, q: Any, qd: Any, qdd: Any) -> Any:
        """Return the torques, with all that acts at the coordinates."""

    def M(self, q: Any) -> Any:
        """Return the inertia matrix."""

    def frames(self, q: Any) -> dict[str, tuple[Any, Any]]:
        """Return pose and Jacobian of frames by their names."""


#: from a path, and whether decimals are taken as they are, to the robot and what makes its peer
Load: TypeAlias = Callable[[Path, bool], tuple[moro.Robot, Callable[[], Peer]]]


def run(description: str, pattern: str, load: Load) -> None:
    """Print the table of the command's folders, and what was refused."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--meant", action="store_true", help="read decimals as what they mean")
    parser.add_argument("--match", default="", help="only files with this in their path")
    given = parser.parse_args()
    refused: dict[str, list[str]] = {}
    print("| " + " | ".join(Line.HEADINGS) + " |\n|" + "---|" * len(Line.HEADINGS))
    for path in files(given.folders, pattern, given.match):
        line = surveyed_or_reason(path, not given.meant, load)
        if isinstance(line, str):
            refused.setdefault(_kind(line), []).append(f"{path.name}: {line.splitlines()[0]}")
        else:
            print("| " + " | ".join(line.cells) + " |", flush=True)
    for kind, reasons in refused.items():
        print(f"\nrefused, {kind}: {len(reasons)}")
        for reason in reasons[:12]:
            print(f"- {reason}")


def files(folders: Sequence[Path], pattern: str, match: str) -> Iterator[Path]:
    """Yield the files in folders that differ."""
    seen = set()
    for folder in folders:
        for path in sorted(folder.rglob(pattern)):
            digest = hashlib.sha256(path.read_bytes()).digest()
            if digest not in seen and match in str(path):
                seen.add(digest)
                yield path


def _kind(reason: str) -> str:
    for words in ("no joint that moves", "floating base", "xacro", "not XML"):
        if words in reason:
            return words
    return "what is wrong"


def surveyed_or_reason(path: Path, as_written: bool, load: Load) -> Line | str:
    """Return the line of a file, or why it is refused."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return surveyed(path, as_written, load)
    except (ValueError, RuntimeError) as error:
        return str(error).replace(str(path), path.name)


def surveyed(path: Path, as_written: bool, load: Load) -> Line:
    """Return the line of a file. Raises ValueError if it is refused."""
    start = time.process_time()
    robot, peer_of = load(path, as_written)
    mc.generate(robot)
    made = time.process_time() - start
    peer = peer_of()
    with tempfile.TemporaryDirectory() as folder:
        kernel = mc.compile(robot, functions=(*FUNCTIONS, *dynamics(robot)), directory=folder)
        errors = compared(robot, kernel, peer)
        only = mc.compile(robot, directory=folder)
        ops = only.ops["tau"]
        worst = max(errors, key=errors.__getitem__)
        return Line(
            path.stem,
            robot.dof,
            errors[worst],
            worst,
            sum(ops[kind] for kind in ("add", "sub", "mul", "div")),
            made,
            only.timings["compile"],
            nanoseconds(only),
        )


def dynamics(robot: Any) -> tuple[str, ...]:
    """Return the function forward_dynamics, unless M of the robot is singular everywhere."""
    try:
        mc.generate(robot, ("forward_dynamics",))
    except ValueError:
        return ()
    return ("forward_dynamics",)


def compared(robot: Any, kernel: Any, peer: Peer) -> dict[str, float]:
    """Return the largest error of each quantity, relative to its largest value."""
    rng = np.random.default_rng(0)
    limits = np.clip(np.array(robot.joint_limits, dtype=float), -np.pi, np.pi)
    model = robot.model().map(float)
    errors: dict[str, float] = {}

    def compare(what: str, found: Any, expected: Any, scale: float = 0.0) -> None:
        size = max(np.max(np.abs(expected), initial=0.0), scale) or 1.0
        error = float(np.max(np.abs(found - expected), initial=0.0)) / size
        errors[what] = max(errors.get(what, 0.0), error)

    for state in range(STATES):
        q = rng.uniform(*limits.T)
        qd, qdd = rng.standard_normal((2, robot.dof))
        tau, bias, M = peer.tau(q, qd, qdd), peer.tau(q, qd, 0 * qd), peer.M(q)
        compare("tau", kernel.tau(q, qd, qdd), tau)
        compare("bias", kernel.bias(q, qd), bias, np.max(np.abs(tau)))
        compare("M", kernel.inertia_matrix(q), M)
        if (
            "forward_dynamics" in kernel.ops and np.linalg.cond(M) < 1e12
        ):  # what tau - bias takes with the accelerations found
            found = kernel.forward_dynamics(q, qd, tau)
            size = np.max(np.abs(M) @ np.abs(found)) + np.max(np.abs(bias))
            compare("forward dynamics", M @ found + bias, tau, size)
        tip_T, tip_J = peer.frames(q)[robot.frames[-1]]
        compare("poses", kernel.forward_kinematics(q), tip_T)
        compare("Jacobians", kernel.jacobian(q), tip_J)
        if state < 2:
            for name, (T, J) in peer.frames(q).items():
                if name not in robot.frames:
                    continue
                own_T, own_J = frame(model, name, q)
                compare("poses", own_T, T)
                compare("Jacobians", own_J, J)
    return errors


def frame(model: Any, name: str, q: Any) -> tuple[Any, Any]:
    """Return pose and Jacobian of a frame by the recursive route."""
    place = next(x for x in model.frames if x.name == name)
    sincos = [(np.sin(x), np.cos(x)) for x in displacements(model, q)]
    arm = with_frame(posture(model, q, sincos), place.link, place.placement)
    pose = poses(arm)[-1]
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose.R, pose.p
    return T, np.array(frame_jacobian(arm), dtype=float)


def nanoseconds(kernel: Any) -> float:
    """Return the time of one call of tau in C."""
    n = kernel.dof
    q, v, a = np.random.default_rng(1).uniform(-1, 1, (3, n))
    out = np.empty(n)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "stopwatch.c"
        source.write_text(STOPWATCH)
        target = source.with_suffix(".so")
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", target, source], check=True)
        best = ctypes.CDLL(str(target)).best
    best.restype = ctypes.c_double
    function = getattr(ctypes.CDLL(str(kernel.library)), f"{kernel.name}_tau")
    pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in (q, v, a, out)]
    return float(best(function, *pointers, 2000))
