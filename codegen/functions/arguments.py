"""Arguments of functions, taken and given: names, shapes, units, frames."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

#: a dimension is a number, "n" for that of joints, or "p" for that of run-time parameters
Shape: TypeAlias = tuple[str | int, ...]

#: what functions of a frame call it, unless another is asked for (``at_frame``)
LAST = "the last frame"


@dataclass(frozen=True)
class Argument:
    """An input or output array: row-major, components of ``shape``."""

    name: str
    shape: Shape
    unit: str
    #: what it is, with the frame it is expressed in
    description: str

    @property
    def sizes(self) -> tuple[int, ...]:
        """The shape, where it is in numbers."""
        return tuple(int(n) for n in self.shape)

    @property
    def size(self) -> int:
        """The number of components."""
        return math.prod(self.sizes)


# -- what several functions take or return ---------------------------------------------------------

Q = Argument("q", ("n",), "rad or m", "joint positions")
QD = Argument("qd", ("n",), "rad/s or m/s", "joint velocities")
QDD = Argument("qdd", ("n",), "rad/s^2 or m/s^2", "joint accelerations")
TAU = Argument(
    "tau", ("n",), "N m or N", "joint torques, about the joint axes (forces, along them)"
)
QD_R = Argument("qd_r", ("n",), "rad/s or m/s", "reference joint velocities")
QDD_R = Argument("qdd_r", ("n",), "rad/s^2 or m/s^2", "reference joint accelerations")
V = Argument("v", ("n",), "SI", "a vector over the joints")
WRENCH = Argument(
    "wrench",
    (6,),
    "N, N m",
    f"force, then moment about the origin of {LAST}, on its link; in frame 0",
)
M = Argument("M", ("n", "n"), "kg m^2 to kg", "inertia matrix, symmetric")
C = Argument("C", ("n", "n"), "N m s to N s/m", "Coriolis matrix")
G = Argument("G", ("n",), "N m or N", "torques (forces) against gravity")
J = Argument("J", (6, "n"), "m/rad, 1", f"(v, omega) of {LAST} = J qd; in frame 0")
