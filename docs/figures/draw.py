"""Draw the figures of the documentation: python docs/figures/draw.py writes *.svg beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scene import INK, JOINT, LINK, SOFT, Scene, X, Y, Z, turned

_HERE = Path(__file__).parent


def standard() -> Scene:
    """Draw the standard (distal) convention: frame i at the end of link i."""
    scene = Scene(7, 5)
    a, alpha, d, theta = 3.9, 0.8, 1.9, 1.1
    x = turned(X, Z, 0.5)  # along the common normal, from axis i to axis i + 1
    z = turned(Z, x, alpha)
    origin = np.zeros(3)
    foot = origin + d * Z
    end = foot + a * x
    before = turned(x, Z, -theta)
    _arm(scene, (origin - 1.5 * Z, Z), (end - 2.2 * z, z), ("i-1", "i", "i+1"), (28, -8))
    _axis(scene, origin, Z, -2.5, 4.3, "i")
    _axis(scene, end, z, -3.3, 3.3, "i+1")

    _frame(scene, origin, (before, 1.5), (Z, 1.3), "i-1", (6, -13), (-20, 0), (-20, -10))
    _frame(scene, end, (x, 1.6), (z, 1.8), "i", (13, 2), (14, -4), (8, -15))
    scene.line(foot, end, color=LINK, width=1.7)
    scene.text((foot + end) / 2, "$a_i$", dx=-4, dy=12, color=LINK)
    _length(scene, origin, foot, 0.8 * scene.leftwards(Z), JOINT, "$d_i$", (-11, 0))
    _angle(scene, foot, before, Z, theta, 1.15, JOINT, r"$\theta_i$", (14, -3))
    _angle(scene, end, Z, x, alpha, 1.25, LINK, r"$\alpha_i$", (5, 12))
    return scene


def modified() -> Scene:
    """Draw the modified (proximal) convention: frame i at the joint that moves link i."""
    scene = Scene(7, 5)
    a, alpha, d, theta = 4.9, 0.75, 3.4, 1.0
    x = turned(X, Z, -0.6)  # along the common normal, from axis i - 1 to axis i
    z = turned(Z, x, alpha)
    origin = np.zeros(3)
    foot = origin + a * x
    end = foot + d * z
    _arm(scene, (origin - 2.3 * Z, Z), (foot - 1.7 * z, z), ("i-2", "i-1", "i"), (0, -19))
    _axis(scene, origin, Z, -3.3, 2.6, "i-1")
    _axis(scene, foot, z, -2.8, 6.3, "i")

    _frame(scene, origin, (x, 1.55), (Z, 1.3), "i-1", (8, 13), (-20, 0), (-20, -2))
    _frame(scene, end, (turned(x, z, theta), 1.6), (z, 1.8), "i", (13, 2), (-14, -2), (-16, -4))
    scene.line(origin, foot, color=LINK, width=1.7)
    _length(scene, origin, foot, -0.75 * scene.leftwards(x), LINK, "$a_{i-1}$", (-5, -12))
    scene.line(foot, end, color=JOINT, width=1.7)
    scene.text((foot + end) / 2, "$d_i$", dx=-11, dy=-7, color=JOINT)
    _angle(scene, end, x, z, theta, 1.0, JOINT, r"$\theta_i$", (14, 0))
    _angle(scene, foot, Z, x, alpha, 1.05, LINK, r"$\alpha_{i-1}$", (30, 5))
    return scene


def two_link() -> Scene:
    """Draw the planar arm with two revolute joints, with its frames in either convention."""
    scene = Scene(9, 4, elevation=np.pi / 2, size=14)
    q1, q2, l1, lc1, l2 = 0.42, 0.8, 4.2, 2.6, 3.4
    for base, distal in ((-4.3 * X, True), (4.3 * X, False)):
        u = turned(X, Z, q1)
        v = turned(u, Z, q2)
        elbow = base + l1 * u
        tip = elbow + l2 * v
        scene.bar(base, base, elbow, elbow, thickness=22)
        scene.bar(elbow, elbow, tip, tip, thickness=22)
        for joint in (base, elbow):
            scene.drum(joint, Z, 0.3, 0, fill="white")
        scene.centre_of_mass(base + lc1 * u, 0.17)
        scene.text(base + lc1 * u, "$C_1$", dx=-12, dy=15)

        _plane_frame(scene, base, X, "0", (10, 0), (0, 9))
        if distal:
            _plane_frame(scene, elbow, u, "1", (12, 3), (-12, 4))
            _plane_frame(scene, tip, v, "2", (12, 3), (-11, 4))
            vector, start = r"$r_{C_1} = (l_{c1}-l_1,\ 0,\ 0)$", elbow
        else:
            _plane_frame(scene, base, u, "1", (2, -17), (-12, 4), length=3.7)
            _plane_frame(scene, elbow, v, "2", (20, -3), (-11, 4))
            vector, start = r"$r_{C_1} = (l_{c1},\ 0,\ 0)$", base
            scene.text(tip, "tip", dy=17, color=SOFT, size=12)

        down = turned(u, Z, -np.pi / 2)
        _length(scene, base, elbow, 1.8 * down, SOFT, "$l_1$", (5, -10))
        _length(scene, base, base + lc1 * u, 1.1 * down, SOFT, "$l_{c1}$", (5, -10))
        scene.arrow(start, base + lc1 * u - start, LINK, width=2.4)
        name = "standard (dh)" if distal else "modified (mdh)"
        scene.text(base + 2.2 * X + 5.0 * Y, name)
        scene.text(base + 3.0 * X - 2.0 * Y, vector, color=LINK)
    return scene


def _plane_frame(scene: Scene, origin, x, index: str, x_shift, y_shift, length=1.5) -> None:
    """Draw a frame of which z points at the reader; ``length`` is that of its x axis."""
    y = turned(x, Z, np.pi / 2)
    for name, arrow, shift in (("x", length * x, x_shift), ("y", 1.5 * y, y_shift)):
        scene.text(scene.arrow(origin, arrow, width=1.5), f"${name}_{index}$", *shift)


def _arm(scene: Scene, first, second, links, shift) -> None:
    """Draw two joints, (centre, axis) each, and the three links that they hold together."""
    (p, u), (r, v) = first, second
    before, between, after = (rf"link ${name}$" for name in links)
    scene.bar(p - 3.0 * X - 0.6 * Z, p - 2 * X - 0.6 * Z, p - 1.2 * X, p)
    middle = scene.bar(p, p + 2.4 * X - 0.3 * Z, r - 1.2 * X - 1.3 * Z, r)
    scene.bar(r, r + 1.2 * X, r + 1.6 * X - 0.6 * Z, r + 2.6 * X - 0.6 * Z)
    scene.drum(p, u, 0.42, 1.0)
    scene.drum(r, v, 0.42, 1.0)
    scene.text(p - 2.5 * X - 0.6 * Z, before, dy=-18, color=SOFT, size=13)
    scene.text(middle, between, *shift, color=SOFT, size=13)
    scene.text(r + 2.1 * X - 0.6 * Z, after, dy=-18, color=SOFT, size=13)


def _axis(scene: Scene, through, direction, low: float, high: float, joint: str) -> None:
    """Draw the axis of a joint, with its name."""
    scene.axis(through, direction, low, high)
    scene.text(through + high * direction, rf"joint ${joint}$", dy=11, color=SOFT, size=13)


def _frame(scene: Scene, origin, x, z, index: str, x_shift, z_shift, o_shift) -> None:
    """Draw the x and z axes, (direction, length) each, and the origin of a frame."""
    for name, (direction, length), shift in (("x", x, x_shift), ("z", z, z_shift)):
        scene.text(scene.arrow(origin, length * direction), f"${name}_{{{index}}}$", *shift)
    scene.dot(origin)
    scene.text(origin, f"$o_{{{index}}}$", *o_shift)


def _angle(scene: Scene, centre, start, axis, angle, radius, color, text, shift) -> None:
    """Draw an angle from a dashed line along ``start``."""
    scene.line(centre, centre + 1.35 * radius * start, color=INK, width=0.9, dash=(4, 3))
    at = scene.turn(centre, start, axis, angle, radius, color)
    scene.text(at, text, *shift, color=color)


def _length(scene: Scene, low, high, beside, color, text, shift) -> None:
    """Draw a length beside the line that it measures."""
    for end in (low, high):
        scene.line(end, end + 1.15 * beside, color=color, width=0.6)
    at = scene.measure(low + beside, high + beside, color)
    scene.text(at, text, *shift, color=color)


def main() -> None:
    """Write every figure."""
    for draw in (standard, modified, two_link):
        draw().save(_HERE / f"{draw.__name__}.svg")


if __name__ == "__main__":
    main()
