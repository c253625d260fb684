"""Pinocchio in C++, compiled from the headers in its wheel, and from Python.

Only headers are used: so it is compiled for the processor at hand, as moro's kernels are. (Linked
against the wheel's libraries, which are not, it would have to be compiled without that.)
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks import native
from benchmarks.arms import Arm
from benchmarks.native import CXX, SOURCES, Loop, handle, library
from benchmarks.tasks import Call, Task

NAME = "Pinocchio"

VERSIONS = {"pin": pin.__version__}

_FLAGS = (
    "-std=c++17",
    "-DNDEBUG",
    "-w",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
FLAGS = (*native.FLAGS, *_FLAGS)


def loops(arm: Arm, task: Task) -> Iterator[Loop]:
    """Yield a function of Pinocchio's, as calls."""
    made = _library()
    yield Loop(NAME, task, getattr(made, f"{task.name}_loop"), _handle(arm), owner=made)


def python_calls(arm: Arm) -> Iterator[Call]:
    """Yield rnea through Pinocchio's own Python bindings."""
    chain, model = arm.chain, pin.Model()
    for i, revolute in enumerate(chain.revolute):
        kind = pin.JointModelRZ() if revolute else pin.JointModelPZ()
        joint = model.addJoint(i, kind, pin.SE3(chain.R[i], chain.p[i]), f"joint{i + 1}")
        body = pin.Inertia(float(chain.mass[i]), chain.com[i], chain.inertia[i])
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    model.gravity = pin.Motion(np.concatenate([chain.gravity, np.zeros(3)]))
    data = model.createData()
    yield Call(NAME, lambda q, qd, qdd: pin.rnea(model, data, q, qd, qdd))


def build() -> None:
    """Compile what is not there yet."""
    _library()


@lru_cache(maxsize=1)
def _library() -> Any:
    include = _prefix() / "include"
    flags = (*_FLAGS, "-isystem", str(include), "-isystem", str(include / "eigen3"))
    text = (SOURCES / "pinocchio.cpp").read_text()
    return library("pinocchio", {"pinocchio.cpp": text}, compiler=CXX, flags=flags)


@lru_cache(maxsize=64)
def _handle(arm: Arm) -> Any:
    chain = arm.chain
    return handle(
        _library().arm_new,
        chain.dof,
        np.arange(-1, chain.dof - 1, dtype=np.int32),
        np.array(chain.revolute, dtype=np.int32),
        chain.R,
        chain.p,
        chain.mass,
        chain.com,
        chain.inertia,
        chain.gravity,
    )


def _prefix() -> Path:
    """Return the folder of the wheel's headers."""
    place = Path(pin.__file__)
    for folder in place.parents:
        if (folder / "include" / "pinocchio").is_dir():
            return folder
    raise FileNotFoundError(f"no headers of Pinocchio around {place}")
