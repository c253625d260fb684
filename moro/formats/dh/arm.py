"""What is given of an arm by rows of DH parameters, as exact values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from moro.model import JointType


@dataclass(frozen=True)
class Row:
    """One row of a DH table: SymPy constants, and the joint variable added to one of them.

    The variable adds to ``theta`` of a joint that turns, and to ``d`` of one that slides.
    """

    a: Any
    alpha: Any
    d: Any
    theta: Any
    variable: Any
    type: JointType


@dataclass(frozen=True)
class Arm:
    """An arm as it is given: SymPy values throughout. What is not set is None."""

    rows: tuple[Row, ...]
    convention: str
    masses: tuple[Any, ...] | None = None
    #: r_Ci in frame i
    cm_positions: tuple[tuple[Any, ...], ...] | None = None
    #: I_Ci in the axes of frame i
    inertia_tensors: tuple[tuple[tuple[Any, ...], ...], ...] | None = None
    #: in frame 0
    gravity: tuple[Any, ...] | None = None
    rotor_inertias: tuple[Any, ...] | None = None
    viscous_friction: tuple[Any, ...] | None = None
    coulomb_friction: tuple[tuple[Any, Any], ...] | None = None
    #: None for joints without
    joint_limits: tuple[tuple[Any, Any] | None, ...] | None = None
