"""Line drawings of joints, axes and frames in space, projected to the page.

World axes: x to the right, y into the page, z up. The camera looks along y, from a little above.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch, Polygon, Wedge
from matplotlib.path import Path as Outline

#: what belongs to a link (a, alpha), what belongs to a joint (d, theta), and the rest
LINK, JOINT, INK, SOFT = "#0b5fa5", "#b8320a", "#1c1c1c", "#8a8a8a"
_BODY, _EDGE = "#e4e7ea", "#9aa0a6"
STYLE = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "svg.fonttype": "path",
    "svg.hashsalt": "moro",
}

X, Y, Z = np.eye(3)


def turned(v: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Return ``v`` turned about the unit vector ``axis`` by ``angle`` [rad]."""
    along = axis * (axis @ v)
    return along + np.cos(angle) * (v - along) + np.sin(angle) * np.cross(axis, v)


class Scene:
    """A drawing. Points and directions are vectors of the world; lengths of text are in points."""

    def __init__(self, width: float, height: float, elevation: float = 0.42, size: float = 15):
        mpl.rcParams.update(STYLE)
        self.figure = Figure(figsize=(width, height), facecolor="white")
        self.axes = self.figure.add_axes((0, 0, 1, 1))
        self.axes.set_aspect("equal")
        self.axes.axis("off")
        self.size = size
        s, c = np.sin(elevation), np.cos(elevation)
        self._camera = np.array([[1, 0, 0], [0, s, c]])
        self._towards_eye = np.array([0, -c, s])

    def flat(self, points: np.ndarray) -> np.ndarray:
        """Return the page coordinates of points of the world."""
        return np.asarray(points) @ self._camera.T

    def leftwards(self, direction: np.ndarray) -> np.ndarray:
        """Return the direction of unit length that is, on the page, square to and left of this."""
        x, y = self.flat(direction)
        across = np.array([-y, x]) / np.hypot(x, y)
        return across @ self._camera

    def line(self, *points: np.ndarray, color: str = INK, width: float = 1.1, dash=None) -> None:
        """Draw a line through points, with dashes (on, off, ...) if given."""
        style = (0, dash) if dash else "-"
        self.axes.plot(
            *self.flat(np.array(points)).T,
            color=color,
            lw=width,
            ls=style,
            solid_capstyle="round",
            zorder=3,
        )

    def axis(self, through: np.ndarray, direction: np.ndarray, low: float, high: float) -> None:
        """Draw the axis of a joint, dash-dotted."""
        ends = through + low * direction, through + high * direction
        self.line(*ends, color=SOFT, width=0.9, dash=(12, 3, 2, 3))

    def arrow(self, start, direction, color: str = INK, width: float = 1.9) -> np.ndarray:
        """Draw an arrow and return its tip."""
        tip = start + direction
        self._arrow(self.flat(np.array([start, tip])), "-|>", color, width, 15)
        return tip

    def measure(self, start, end, color: str) -> np.ndarray:
        """Draw a dimension line with a head at both ends; return its middle."""
        self._arrow(self.flat(np.array([start, end])), "<|-|>", color, 1.3, 11)
        return (start + end) / 2

    def turn(self, centre, start, axis, angle: float, radius: float, color: str) -> np.ndarray:
        """Draw an arc with a head, from direction ``start`` about ``axis``; return its middle."""
        angles = np.linspace(0, angle, 60)
        arc = np.array([centre + radius * turned(start, axis, x) for x in angles])
        self.axes.plot(*self.flat(arc[:-4]).T, color=color, lw=1.3, zorder=4)
        self._arrow(self.flat(arc[[-6, -1]]), "-|>", color, 1.3, 11)
        return arc[30]

    def text(self, at, text: str, dx: float = 0, dy: float = 0, color: str = INK, size=None):
        """Write at a point, shifted by (dx, dy) points on the page."""
        self.axes.annotate(
            text,
            self.flat(np.asarray(at)),
            (dx, dy),
            textcoords="offset points",
            ha="center",
            va="center",
            color=color,
            fontsize=size or self.size,
            annotation_clip=False,
            zorder=6,
        )

    def dot(self, at, color: str = INK, size: float = 5) -> None:
        """Mark a point."""
        self.axes.plot(*self.flat(at), "o", color=color, ms=size, zorder=5)

    def centre_of_mass(self, at, radius: float) -> None:
        """Mark a centre of mass."""
        x, y = self.flat(at)
        self.axes.add_patch(Circle((x, y), radius, fc="white", ec=INK, lw=1, zorder=5))
        for quarter in (0, 180):
            self.axes.add_patch(
                Wedge((x, y), radius, quarter, quarter + 90, fc=INK, lw=0, zorder=5)
            )

    def drum(self, centre, axis, radius: float, length: float, fill: str = _BODY) -> None:
        """Draw a joint: a cylinder about ``axis``."""
        u = np.cross(axis, self._towards_eye)
        u = u / np.linalg.norm(u)
        v = np.cross(axis, u)
        angles = np.linspace(0, 2 * np.pi, 91)
        rim = radius * (np.outer(np.cos(angles), u) + np.outer(np.sin(angles), v))
        near = axis * length / 2 * np.sign(axis @ self._towards_eye)
        half = rim[:46] if self._towards_eye @ rim[23] > 0 else rim[45:]
        self._fill(np.concatenate([half - near, half[::-1] + near]) + centre, fill)
        self._fill(rim + near + centre, fill)

    def bar(self, *points, thickness: float = 13) -> np.ndarray:
        """Draw a link: a thick Bezier curve of four points; return its middle."""
        outline = Outline(self.flat(np.array(points)), [1, 4, 4, 4])
        for width, color in ((thickness, _EDGE), (thickness - 2, _BODY)):
            self.axes.add_patch(
                PathPatch(outline, fill=False, lw=width, ec=color, capstyle="round", zorder=1)
            )
        return np.array([1, 3, 3, 1]) @ np.array(points) / 8

    def save(self, path: Path) -> None:
        """Write the drawing as SVG, trimmed, the same bytes every time."""
        self.figure.savefig(path, bbox_inches="tight", pad_inches=0.08, metadata={"Date": None})

    def _fill(self, points: np.ndarray, color: str = _BODY) -> None:
        self.axes.add_patch(Polygon(self.flat(points), fc=color, ec=_EDGE, lw=1, zorder=2))

    def _arrow(self, ends, style: str, color: str, width: float, head: float) -> None:
        self.axes.annotate(
            "",
            ends[1],
            ends[0],
            arrowprops={
                "arrowstyle": f"{style},head_width={head / 55:.3f},head_length={head / 24:.3f}",
                "color": color,
                "lw": width,
                "shrinkA": 0,
                "shrinkB": 0,
                "mutation_scale": 15,
                "joinstyle": "miter",
            },
            annotation_clip=False,
            zorder=4,
        )
