"""MJCFs, whole folders of them, against MuJoCo: `python -m benchmarks.mjcf_survey FOLDER ...`.

Each file is loaded ``as_written`` (benchmarks/survey.py) and compiled by MuJoCo as it is, with all
its shapes. A robot that moves freely is held at the body that does, the one that carries most: it
is loaded with that as its root, and the free joint is taken out of MuJoCo's specification. Contacts
and constraints are switched off in MuJoCo; what equalities couple is put together here (x = A q +
b), and dry friction added, which is a constraint there. What acts from outside (gravcomp, fluids)
is switched off. Files that are parts of others, which MuJoCo does not read by themselves, are
listed with what it says.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import moro
from benchmarks import survey
from moro.formats.mjcf.specification import bodies, name_all
from moro.io import RobotFileError

FREE, BALL = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL
BITS = mujoco.mjtDisableBit


def main() -> None:
    """Print the table, and what was refused."""
    mujoco.set_mju_user_warning(lambda text: None)
    survey.run(__doc__.splitlines()[0], "*.xml", load)


def load(path: Path, as_written: bool) -> tuple[moro.Robot, Callable[[], Peer]]:
    """Return the robot of a file, held where it moves freely, and what makes MuJoCo's model."""
    try:
        robot, root = moro.load(path, as_written=as_written), None
    except RobotFileError as error:
        if "moves freely" not in str(error):
            raise
        root = _floating(path)
        robot = moro.load(path, root=root, as_written=as_written)
    return robot, partial(Peer, path, robot.joint_names, root)


def _floating(path: Path) -> str:
    """Return the body that moves freely and carries most others."""
    spec = mujoco.MjSpec.from_file(str(path))
    name_all(spec)
    free = {joint.parent.name: joint.parent for joint in spec.joints if joint.type == FREE}
    return max(free, key=lambda name: len([*bodies(free[name])]))


class Peer:
    """MuJoCo's model of a file, in the coordinates of moro's."""

    def __init__(self, path: Path, names: Sequence[str], root: str | None = None) -> None:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = False
        name_all(spec)
        whole = spec.compile()
        if root is not None:
            for key in list(spec.keys):
                spec.delete(key)
            for joint in list(spec.body(root).joints):
                if joint.type == FREE:
                    spec.delete(joint)
        self.model = model = spec.compile()
        self.root = root
        _as_in(whole, model)
        model.body_gravcomp[:] = model.opt.density = model.opt.viscosity = 0
        off = int(model.opt.disableflags)
        rubs = not off & (int(BITS.mjDSBL_CONSTRAINT) | int(BITS.mjDSBL_FRICTIONLOSS))
        couples = not off & (int(BITS.mjDSBL_CONSTRAINT) | int(BITS.mjDSBL_EQUALITY))
        model.opt.disableflags |= int(BITS.mjDSBL_CONSTRAINT)
        self.friction = model.dof_frictionloss * rubs
        self.data = mujoco.MjData(model)
        self.A, self.b = self._coordinates(names, couples)

    def _coordinates(self, names: Sequence[str], couples: bool) -> tuple[Any, Any]:
        """Return A and b of qpos - qpos0 = A q + b, for all degrees of freedom."""
        m = self.model
        tied = {}
        for k in range(m.neq if couples else 0):
            if not m.eq_active0[k]:
                continue
            first, second, (a0, a1) = m.eq_obj1id[k], m.eq_obj2id[k], m.eq_data[k][:2]
            if m.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT:
                tied.setdefault(first, (second, a0, a1))
            elif m.eq_type[k] == mujoco.mjtEq.mjEQ_TENDON and m.tendon_num[first] == 2:
                wraps = slice(m.tendon_adr[first], m.tendon_adr[first] + 2)
                (x, y), (c, d) = m.wrap_objid[wraps], m.wrap_prm[wraps]
                tied.setdefault(y, (x, a0 / d, -c / d))
        A, b = np.zeros((m.nv, len(names))), np.zeros(m.nv)
        for k in range(m.njnt):
            if m.jnt_type[k] in (FREE, BALL):
                continue
            at, ratio, offset = k, 1.0, 0.0
            while at in tied and at >= 0:
                other, a0, a1 = tied[at]
                offset, ratio, at = offset + ratio * a0, ratio * a1 * (other >= 0), other
            name = m.joint(at).name if at >= 0 else ""
            if name in names:
                A[m.jnt_dofadr[k], names.index(name)] = ratio
                offset -= ratio * m.qpos0[m.jnt_qposadr[at]]
            elif at == k:
                offset = 0.0  # not in the part that is meant: it does not count
            b[m.jnt_dofadr[k]] = offset
        return A, b

    def _set(self, q: Any) -> None:
        m, x = self.model, self.A @ q + self.b
        self.data.qpos[:] = m.qpos0
        for k in range(m.njnt):
            if m.jnt_type[k] not in (FREE, BALL):
                self.data.qpos[m.jnt_qposadr[k]] += x[m.jnt_dofadr[k]]

    def tau(self, q: Any, qd: Any, qdd: Any) -> Any:
        """Return the torques of the coordinates, with dry friction."""
        self._set(q)
        self.data.qvel[:], self.data.qacc[:] = self.A @ qd, self.A @ qdd
        mujoco.mj_inverse(self.model, self.data)
        rubbing = self.friction * np.sign(self.data.qvel)
        return self.A.T @ (self.data.qfrc_inverse + rubbing)

    def M(self, q: Any) -> Any:
        """Return the inertia matrix of the coordinates."""
        self._set(q)
        mujoco.mj_forward(self.model, self.data)
        M = np.zeros((self.model.nv, self.model.nv))
        try:
            mujoco.mj_fullM(self.model, self.data, M)
        except TypeError:  # before MuJoCo 4
            mujoco.mj_fullM(self.model, M, self.data.qM)
        return self.A.T @ M @ self.A

    def frames(self, q: Any) -> dict[str, tuple[Any, Any]]:
        """Return pose and Jacobian of every body's frame and every site's, from the root."""
        m, d = self.model, self.data
        self._set(q)
        mujoco.mj_kinematics(m, d)
        mujoco.mj_comPos(m, d)
        base = np.eye(4)
        if self.root is not None:
            base = _pose(d.body(self.root))
        found = {}
        for kind, count, jacobian in (
            ("body", m.nbody, mujoco.mj_jacBody),
            ("site", m.nsite, mujoco.mj_jacSite),
        ):
            for k in range(count):
                jacp, jacr = np.zeros((2, 3, m.nv))
                jacobian(m, d, jacp, jacr, k)
                turned = np.vstack([base[:3, :3].T @ jacp, base[:3, :3].T @ jacr])
                place = getattr(d, kind)(k)
                name = getattr(m, kind)(k).name
                name += "_site" * (name in found)
                found[name] = np.linalg.inv(base) @ _pose(place), turned @ self.A
        return found


def _as_in(whole: Any, held: Any) -> None:
    """Give joints the springs and dampers of the whole: springdamper depends on what moves."""
    for k in range(held.njnt):
        other = whole.joint(held.joint(k).name)
        held.jnt_stiffness[k] = other.stiffness[0]
        held.dof_damping[held.jnt_dofadr[k]] = other.damping[0]


def _pose(place: Any) -> Any:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = place.xmat.reshape(3, 3), place.xpos
    return T


if __name__ == "__main__":
    main()
