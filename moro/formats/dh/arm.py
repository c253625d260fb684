"""What is given of an arm by rows of DH parameters, as exact values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from moro.model import JointType


@dataclass(frozen=True)
class Row:
    """One row of a DH table: SymPy constants, and what the joint moves by, added to one of them.

    That adds to ``theta`` of a joint that turns, and to ``d`` of one that slides.
    """

    a: Any
    alpha: Any
    d: Any
    theta: Any
    #: (joint variable, ratio): most often the one variable of the row, and 1
    terms: tuple[tuple[Any, Any], ...]
    type: JointType

    @property
    def moved(self) -> tuple[Any, Any]:
        """D and theta as they are written, with joint variables."""
        by = sum(ratio * variable for variable, ratio in self.terms)
        return (self.d, self.theta + by) if self.type.is_angle else (self.d + by, self.theta)


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
    #: of drives, one for each joint variable
    rotor_inertias: tuple[Any, ...] | None = None
    viscous_friction: tuple[Any, ...] | None = None
    coulomb_friction: tuple[tuple[Any, Any], ...] | None = None
    #: None for joints without
    joint_limits: tuple[tuple[Any, Any] | None, ...] | None = None
    #: of the rows, "" where they have none; or of none
    link_names: tuple[str, ...] = ()
    joint_names: tuple[str, ...] = ()
    #: (inertia about its axis, turns for one of the joint) of the rotor of each row, or None
    rotors: tuple[tuple[Any, Any] | None, ...] | None = None

    @property
    def variables(self) -> dict[Any, int]:
        """The joint variables, in the order in which rows have them, and the first row of each."""
        found: dict[Any, int] = {}
        for i, row in enumerate(self.rows):
            for variable, _ in row.terms:
                found.setdefault(variable, i)
        return found
