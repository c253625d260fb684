"""Draw the figures of the how-tos, of what their samples have computed.

python -m docs.figures.howto [PAGE ...] runs the samples and writes *.svg beside this file.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from docs.figures.scene import INK, JOINT, LINK, SOFT, STYLE
from docs.refresh import refreshed

_HERE = Path(__file__).parent
_PAGES = _HERE.parent / "howto"
_PALE = "#d5d8db"


def computed_torque(x: dict[str, Any]) -> Figure:
    """Draw the error of joint 4 with the right model and with a wrong one, and what is expected."""
    figure, (axes,) = _axes(1, 6.4, 3.0)
    degrees = np.degrees(1)
    axes.plot(x["times"], degrees * x["sagging"][:, 3], color=JOINT)
    axes.plot(x["times"], degrees * x["errors"][:, 3], color=LINK, lw=2)
    axes.plot(x["times"][::3], degrees * x["expected"][::3], ".", color=INK, ms=4)
    _label(axes, 0.62, 0.10, "right model, and the curve of theory (dots)", LINK)
    _label(axes, 0.62, 0.42, "half a kilogram that the model does not know", JOINT)
    axes.set(xlabel="time [s]", ylabel="error of joint 4 [°]", xlim=(0, 2))
    return figure


def operational_space(x: dict[str, Any]) -> Figure:
    """Draw the arm on its way around the circle, in both postures."""
    figure, both = _axes(2, 7.2, 3.6)
    for axes, y, title in zip(both, x["ways"], ("elbow up", "elbow down"), strict=True):
        axes.plot(*x["wanted"].T, color=SOFT, lw=1, ls=(0, (4, 3)))
        for k in range(0, 101, 5):
            angles = np.cumsum(y[k, :3])
            ends = np.cumsum([0.5, 0.4, 0.3] * np.exp(1j * angles))
            joints = np.concatenate([[0], ends])
            axes.plot(joints.real, joints.imag, color=LINK, lw=1.3, alpha=0.12 + 0.6 * k / 100)
            axes.plot(ends[-1].real, ends[-1].imag, ".", color=JOINT, ms=5)
        axes.plot(0, 0, "o", color=INK, ms=5)
        axes.set(title=title, aspect="equal", xlim=(-0.15, 1.1), ylim=(-0.5, 0.8), xlabel="x [m]")
    both[0].set_ylabel("y [m]")
    return figure


def contact(x: dict[str, Any]) -> Figure:
    """Draw the residuals of shoulder and elbow, and the torques of the pull."""
    figure, (axes,) = _axes(1, 6.4, 3.0)
    for joint, color, name, height in ((1, LINK, "shoulder", 0.25), (2, JOINT, "elbow", 0.75)):
        axes.plot(x["times"], x["pulls"][:, joint], color=color, lw=0.9, ls=(0, (4, 3)))
        axes.plot(x["times"], x["residuals"][:, joint], color=color)
        _label(axes, 0.30, height, name, color)
    axes.set(xlabel="time [s]", ylabel="residual [N m]", xlim=(0, 1))
    return figure


def simulation(x: dict[str, Any]) -> Figure:
    """Draw the angle of the second link of all pendulums."""
    figure, (axes,) = _axes(1, 6.4, 3.2)
    angles = x["paths"][::2, ::8, 1].T
    shades = mpl.colors.LinearSegmentedColormap.from_list("shades", [LINK, _PALE, JOINT])
    for k, path in enumerate(angles.T):
        axes.plot(np.arange(len(path)) * 0.02, path, color=shades(k / angles.shape[1]), lw=0.6)
    axes.set(xlabel="time [s]", ylabel="$q_2$ [rad]", xlim=(0, 5))
    return figure


def trajectory_optimisation(x: dict[str, Any]) -> Figure:
    """Draw angles and torques of the swing."""
    figure, (left, right) = _axes(2, 7.2, 3.0)
    times = x["dt"] * np.arange(x["N"] + 1)
    for k, color in enumerate((LINK, JOINT)):
        left.plot(times, x["states"][k], color=color)
        right.stairs(x["torques"][k], times, color=color, lw=1.4, baseline=None)
        _label(left, *((0.60, 0.30) if k == 0 else (0.55, 0.78)), f"$q_{k + 1}$", color)
    for bound in (-10, 10):
        right.axhline(bound, color=SOFT, lw=0.8, ls=(0, (4, 3)))
    left.set(xlabel="time [s]", ylabel="angle [rad]", xlim=(0, times[-1]))
    right.set(xlabel="time [s]", ylabel="torque [N m]", xlim=(0, times[-1]))
    return figure


def identification(x: dict[str, Any]) -> Figure:
    """Draw how far each estimate is off, in units of its spread."""
    figure, (axes,) = _axes(1, 6.4, 2.8)
    apart = (x["p"] - x["truth"]) / x["spread"]
    axes.axhspan(-2, 2, color="#eef0f2", lw=0)
    axes.axhspan(-1, 1, color="#dde1e5", lw=0)
    axes.axhline(0, color=SOFT, lw=0.8)
    axes.plot(np.arange(1, len(apart) + 1), apart, "o", color=LINK, ms=4)
    axes.set(xlabel="base parameter", ylabel="(estimate − truth) / spread", ylim=(-3.5, 3.5))
    axes.set_xlim(0, len(apart) + 1)
    return figure


_FIGURES: dict[str, Callable[[dict[str, Any]], Figure]] = {
    "computed-torque": computed_torque,
    "operational-space": operational_space,
    "contact": contact,
    "identification": identification,
    "simulation": simulation,
    "trajectory-optimisation": trajectory_optimisation,
}


def _axes(count: int, width: float, height: float) -> tuple[Figure, list[Axes]]:
    """Return a figure with axes side by side."""
    mpl.rcParams.update({**STYLE, "font.size": 12, "axes.edgecolor": SOFT, "axes.linewidth": 0.8})
    figure = Figure(figsize=(width, height), facecolor="white", layout="constrained")
    found = [figure.add_subplot(1, count, k + 1) for k in range(count)]
    for axes in found:
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(color=SOFT)
    return figure, found


def _label(axes: Axes, x: float, y: float, text: str, color: str) -> None:
    """Write at a place of the axes, from 0 to 1."""
    axes.text(x, y, text, color=color, transform=axes.transAxes, ha="center", va="center")


def main() -> None:
    """Run the pages that are named, or all, and write their figures."""
    for page in sys.argv[1:] or _FIGURES:
        names: dict[str, Any] = {}
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            refreshed((_PAGES / f"{page}.md").read_text(encoding="utf-8"), names)
            os.chdir(_HERE)
        path = _HERE / f"{page.replace('-', '_')}.svg"
        _FIGURES[page](names).savefig(path, metadata={"Date": None, "Creator": "moro"})


if __name__ == "__main__":
    main()
