"""Numbers of Pinocchio for the URDFs of the tests: `python -m benchmarks.urdf_reference`.

Writes a .json beside each .urdf in tests/reference/urdf. The joints that follow others are put
together here (``urdf_survey.Peer``); nothing of moro is used but the order of its coordinates.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import moro
from benchmarks.urdf_survey import Peer

FOLDER = Path(__file__).parents[1] / "tests" / "reference" / "urdf"
STATES = 4


def main() -> None:
    """Write the numbers of all files."""
    for path in sorted(FOLDER.glob("*.urdf")):
        robot = moro.load(path, as_written=True)
        peer = Peer(path, robot.joint_names)
        limits = np.clip(np.array(robot.joint_limits, dtype=float), -np.pi, np.pi)
        rng = np.random.default_rng(0)
        numbers = {
            "robot": path.name,
            "made_with": f"Pinocchio {pin.__version__}, by benchmarks/urdf_reference.py",
            "units": "SI",
            "joints": robot.joint_names,
            "states": [state(peer, limits, rng) for _ in range(STATES)],
        }
        path.with_suffix(".json").write_text(json.dumps(numbers, indent=1) + "\n")


def state(peer: Peer, limits: Any, rng: np.random.Generator) -> dict[str, Any]:
    """Return a random state, and what Pinocchio says of it."""
    q = rng.uniform(*limits.T)
    qd, qdd = rng.standard_normal((2, len(q)))
    frames = peer.frames(q)
    return {
        "q": q.tolist(),
        "qd": qd.tolist(),
        "qdd": qdd.tolist(),
        "tau": peer.tau(q, qd, qdd).tolist(),
        "bias": peer.tau(q, qd, 0 * qdd).tolist(),
        "M": peer.M(q).tolist(),
        "T": {name: T.tolist() for name, (T, _) in frames.items()},
        "J": {name: J.tolist() for name, (_, J) in frames.items()},
    }


if __name__ == "__main__":
    main()
