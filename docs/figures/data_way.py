"""Draw the way of the data: python docs/figures/data_way.py writes data_way.svg beside it."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch
from scene import INK, JOINT, LINK, SOFT, STYLE

#: what is drawn in each place: (x, y), a title, the folder, and what happens there
READERS = (
    ((1.6, 9.2), "DH rows", "moro/formats/dh", ""),
    ((4.4, 9.2), "robot.yaml", "moro/formats/yaml", ""),
)
MODEL = ((3.0, 7.5), "Model", "moro/model", "joints, bodies, frames, parameters, limits, gravity")
SYMBOLIC = (
    ((1.0, 5.6), "closed forms", "moro/closed_form", "over a ring of moro/scalars"),
    ((1.0, 3.9), "results on paper", "moro/printing, moro/report", "M, C, G, L, equations"),
)
RECURSIVE = (
    ((5.0, 5.6), "algorithms", "moro/algorithms", "over any scalar, at a posture"),
    ((5.0, 4.4), "graph", "codegen/graph", "equal operations are one"),
    ((5.0, 3.2), "program", "codegen/passes, program", "the fewest operations"),
    ((5.0, 2.0), "kernel", "codegen/backends, kernel", "C, Cython, NumPy"),
)
PROOF = ((3.0, 0.7), "verify", "codegen/proof", "both routes at the same states")
WIDTH, HEIGHT = 2.35, 0.82


def draw() -> Figure:
    """Return the picture."""
    mpl.rcParams.update(STYLE)
    figure = Figure(figsize=(6.6, 8.2), facecolor="white")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(-0.5, 6.5)
    axes.set_ylim(0, 10)
    axes.axis("off")
    for reader in READERS:
        _box(axes, *reader, SOFT)
        _arrow(axes, reader[0], MODEL[0])
    _box(axes, *MODEL, INK, wide=1.75)
    for stages, color in ((SYMBOLIC, LINK), (RECURSIVE, JOINT)):
        before = MODEL[0]
        for stage in stages:
            _box(axes, *stage, color)
            _arrow(axes, before, stage[0])
            before = stage[0]
    _box(axes, *PROOF, INK, wide=1.3)
    _arrow(axes, RECURSIVE[-1][0], PROOF[0])
    _arrow(axes, SYMBOLIC[0][0], PROOF[0], aside=0.65 * WIDTH)
    axes.text(1.0, 6.35, "symbolic route", ha="center", color=LINK, size=12, style="italic")
    axes.text(5.0, 6.35, "recursive route", ha="center", color=JOINT, size=12, style="italic")
    return figure


def _box(axes: Axes, at, title: str, folder: str, what: str, color: str, wide: float = 1.0) -> None:
    """Draw a box with its title, its folder, and what happens there."""
    (x, y), width = at, WIDTH * wide
    corner = x - width / 2, y - HEIGHT / 2
    box = FancyBboxPatch(corner, width, HEIGHT, "round,pad=0,rounding_size=0.12", lw=1.2)
    box.set(facecolor="white", edgecolor=color, zorder=2)
    axes.add_patch(box)
    lines = [(title, 13, INK), (folder, 9.5, color), *((x, 9, SOFT) for x in what.splitlines())]
    step = HEIGHT / (len(lines) + 0.6)
    for k, (text, size, ink) in enumerate(lines):
        top = y + HEIGHT / 2 - step * (k + 0.75)
        axes.text(x, top, text, ha="center", va="center", size=size, color=ink, zorder=3)


def _arrow(axes: Axes, start, end, aside: float = 0.0) -> None:
    """Draw an arrow from box to box; ``aside``: round what is in between, to the left side."""
    (x, y), (u, v) = start, end
    tail, head = (x, y - HEIGHT / 2), (u, v + HEIGHT / 2)
    style = "arc3,rad=0"
    if aside:
        tail, head, style = (x - WIDTH / 2, y), (u - aside, v), "arc3,rad=0.4"
    arrow = FancyArrowPatch(tail, head, arrowstyle="-|>", mutation_scale=11, lw=1.1)
    arrow.set(color=INK, connectionstyle=style, zorder=1)
    axes.add_patch(arrow)


if __name__ == "__main__":
    draw().savefig(Path(__file__).parent / "data_way.svg", metadata={"Date": None})
