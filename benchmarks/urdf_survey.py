"""URDFs, whole folders of them, against Pinocchio: `python -m benchmarks.urdf_survey FOLDER ...`.

Each file is loaded ``as_written`` (benchmarks/survey.py). Pinocchio's model has every joint by
itself; what mimics is put together here: tau = A^T tau_i, M = A^T M_i A.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import moro
from benchmarks import survey
from moro.formats.xml import parse


def main() -> None:
    """Print the table, and what was refused."""
    survey.run(__doc__.splitlines()[0], "*.urdf", load)


def load(path: Path, as_written: bool) -> tuple[moro.Robot, Callable[[], Peer]]:
    """Return the robot of a file, and what makes Pinocchio's model of it."""
    robot = moro.load(path, as_written=as_written)
    return robot, partial(Peer, path, robot.joint_names)


class Peer:
    """Pinocchio's model of a file, in the coordinates of moro's."""

    def __init__(self, path: Path, names: Sequence[str]) -> None:
        with contextlib.redirect_stdout(None):
            self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        self.planar = [x.idx_v for x in self.model.joints if x.nv == 3]
        self.A, self.b, self.damping, self.friction = self._coordinates(path, names)

    def _coordinates(self, path: Path, names: Sequence[str]) -> tuple[Any, ...]:
        """Return A and b of x = A q + b for Pinocchio's velocities, and their friction."""
        elements = {x.attributes["name"]: x for x in parse(path.read_bytes()).all("joint")}

        def of(joint: str, tag: str) -> dict[str, str] | None:
            return next((x.attributes for x in elements[joint].all(tag)), None)

        n = self.model.nv
        A, b, damping, friction = np.zeros((n, len(names))), np.zeros(n), np.zeros(n), np.zeros(n)
        for k, name in enumerate(self.model.names):
            if k == 0:
                continue
            i, nv = self.model.joints[k].idx_v, self.model.joints[k].nv
            for key, to in (("damping", damping), ("friction", friction)):
                to[i : i + nv] = float((of(name, "dynamics") or {}).get(key, 0))
            if nv == 3:
                for j, x in enumerate(("x", "y", "theta")):
                    A[i + j, names.index(f"{name}_{x}")] = 1
                continue
            ratio, offset, at = 1.0, 0.0, name
            while (mimic := of(at, "mimic")) is not None:
                offset += ratio * float(mimic.get("offset", 0))
                ratio *= float(mimic.get("multiplier", 1))
                at = mimic["joint"]
            if ratio and at in names:
                A[i, names.index(at)] = ratio
            b[i] = offset
        return A, b, damping, friction

    def configuration(self, q: Any) -> Any:
        """Return Pinocchio's configuration."""
        x = self.A @ q + self.b
        found = pin.neutral(self.model)
        for joint in list(self.model.joints)[1:]:
            i, k, nq, nv = joint.idx_v, joint.idx_q, joint.nq, joint.nv
            if nq == nv:
                found[k : k + nq] = x[i : i + nv]
            else:
                angle = x[i + nv - 1]
                found[k : k + nv - 1] = x[i : i + nv - 1]
                found[k + nq - 2 : k + nq] = np.cos(angle), np.sin(angle)
        return found

    def velocities(self, q: Any, qd: Any, qdd: Any) -> tuple[Any, Any, Any]:
        """Return S, v = S qd, a = S qdd + dS/dt qd: Pinocchio's planar joints are in body axes."""
        S, rate = self.A.copy(), np.zeros_like(self.A)
        for i, theta in ((i, (self.A @ q + self.b)[i + 2]) for i in self.planar):
            c, s, turning = np.cos(theta), np.sin(theta), (self.A @ qd)[i + 2]
            S[i : i + 2] = np.array([[c, s], [-s, c]]) @ self.A[i : i + 2]
            rate[i : i + 2] = turning * np.array([[-s, c], [-c, -s]]) @ self.A[i : i + 2]
        return S, S @ qd, S @ qdd + rate @ qd

    def tau(self, q: Any, qd: Any, qdd: Any) -> Any:
        """Return the torques of the coordinates, with friction."""
        S, v, a = self.velocities(q, qd, qdd)
        rigid = pin.rnea(self.model, self.data, self.configuration(q), v, a)
        rate = self.A @ qd
        return S.T @ rigid + self.A.T @ (self.damping * rate + self.friction * np.sign(rate))

    def M(self, q: Any) -> Any:
        """Return the inertia matrix of the coordinates."""
        S = self.velocities(q, 0 * q, 0 * q)[0]
        M = pin.crba(self.model, self.data, self.configuration(q))
        return S.T @ (np.triu(M) + np.triu(M, 1).T) @ S

    def frames(self, q: Any) -> dict[str, tuple[Any, Any]]:
        """Return pose and Jacobian of every link's frame."""
        at, S = self.configuration(q), self.velocities(q, 0 * q, 0 * q)[0]
        pin.computeJointJacobians(self.model, self.data, at)
        pin.updateFramePlacements(self.model, self.data)
        found = {}
        for k, frame in enumerate(self.model.frames):
            if frame.type == pin.FrameType.BODY:
                J = pin.getFrameJacobian(self.model, self.data, k, pin.LOCAL_WORLD_ALIGNED)
                found[frame.name] = self.data.oMf[k].homogeneous.copy(), J @ S
        return found


if __name__ == "__main__":
    main()
