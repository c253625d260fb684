"""MuJoCo in C, from its wheel's library, and from Python: everything but rigid bodies switched off.

Two ways: the four steps that inverse dynamics takes (``mj_kinematics``, ``mj_comPos``,
``mj_comVel``, ``mj_rne``), and ``mj_inverse``, which its documentation names.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from benchmarks.arms import Arm
from benchmarks.native import LIBRARIES, SOURCES, Loop, handle, library
from benchmarks.tasks import Call, Task

STEPS, INVERSE = "MuJoCo, mj_rne", "MuJoCo, mj_inverse"

VERSIONS = {"mujoco": mujoco.__version__}


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield a function of MuJoCo's, as calls."""
    made = _library()
    if task.name == "tau":
        yield Loop(STEPS, task, made.tau_loop, _handle(arm), owner=made)
        yield Loop(INVERSE, task, made.tau_inverse_loop, _handle(arm), owner=made)
    elif task.name == "inertia_matrix":
        yield Loop("MuJoCo, mj_makeM", task, made.inertia_matrix_loop, _handle(arm), owner=made)


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield mj_inverse through MuJoCo's own Python bindings."""
    made = model(arm)
    data = mujoco.MjData(made)
    qpos, qvel, qacc, result = data.qpos, data.qvel, data.qacc, data.qfrc_inverse

    def inverse(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        qpos[:], qvel[:], qacc[:] = q, qd, qdd
        mujoco.mj_inverse(made, data)
        return result

    yield Call(INVERSE, inverse)


def model(arm: Arm) -> mujoco.MjModel:
    """Return MuJoCo's model of an arm.

    The compiler refuses bodies without mass or inertia, which published data have: it gets others,
    and the true ones are put into the compiled model.
    """
    _library()
    chain = arm.chain
    spec = mujoco.MjSpec()
    spec.option.gravity = chain.gravity
    off = mujoco.mjtDisableBit
    spec.option.disableflags = int(
        off.mjDSBL_CONSTRAINT | off.mjDSBL_CONTACT | off.mjDSBL_SPRING | off.mjDSBL_DAMPER
        | off.mjDSBL_ACTUATION | off.mjDSBL_SENSOR
    )  # fmt: skip
    body = spec.worldbody
    for i, revolute in enumerate(chain.revolute):
        body = body.add_body(name=f"link{i + 1}", pos=chain.p[i], quat=_quaternion(chain.R[i]))
        kind = mujoco.mjtJoint.mjJNT_HINGE if revolute else mujoco.mjtJoint.mjJNT_SLIDE
        body.add_joint(type=kind, axis=[0, 0, 1])
        body.mass, body.inertia, body.explicitinertial = 1, [1, 1, 1], True
    made = spec.compile()
    for i in range(chain.dof):
        principal, axes = np.linalg.eigh(chain.inertia[i])
        axes[:, 2] *= np.sign(np.linalg.det(axes))
        made.body_mass[i + 1] = chain.mass[i]
        made.body_inertia[i + 1] = principal
        made.body_ipos[i + 1] = chain.com[i]
        made.body_iquat[i + 1] = _quaternion(axes)
    # what the compiler derived from the others (mj_setConst also factorizes M, singular or not)
    made.body_sameframe[:] = made.body_simple[:] = 0
    made.body_subtreemass[:] = np.cumsum(made.body_mass[::-1])[::-1]
    return made


def _quaternion(R: np.ndarray) -> np.ndarray:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(R).ravel())
    return quaternion


def build() -> None:
    """Compile what is not there yet."""
    _library()


@lru_cache(maxsize=1)
def _library() -> Any:
    folder = Path(mujoco.__file__).parent
    shared = next(folder.glob("libmujoco*"))
    made = library(
        "mujoco",
        {"mujoco.c": (SOURCES / "mujoco.c").read_text()},
        flags=("-isystem", str(folder / "include")),
        link=(str(shared), f"-Wl,-rpath,{folder}"),
    )
    made.quiet()
    return made


@lru_cache(maxsize=64)
def _handle(arm: Arm) -> Any:
    LIBRARIES.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(repr(arm.robot.model()).encode()).hexdigest()[:16]
    file = LIBRARIES / f"{arm.label}-{key}.mjb"
    mujoco.mj_saveModel(model(arm), str(file), None)
    return handle(_library().arm_new, str(file).encode())
