"""Frames, the Jacobian, centres of mass and their Jacobians."""

from __future__ import annotations

from collections.abc import Iterator

from moro.report.page import Block, Section, paragraph
from moro.report.writer import Writer

#: lines of the Jacobians of one link that are written out
_MAX_LINES = 24


def kinematics(writer: Writer) -> Iterator[Section]:
    """Yield the sections on positions and directions."""
    yield Section("Frames", list(_frames(writer)))
    yield Section("Jacobian", list(_jacobian(writer)))
    if "cm_positions" not in writer.model.not_set:
        yield Section("Centres of mass", list(_centres_of_mass(writer)))


def _frames(writer: Writer) -> Iterator[Block]:
    robot, joints = writer.robot, enumerate(writer.model.joints, 1)
    parents = {i: joint.parent + 1 for i, joint in joints if not joint.type.spins}
    for (i, parent), T in zip(parents.items(), robot.Ts, strict=True):
        yield from writer.transform(f"T_{{{writer.index(i, parent)}}}", T)
    if any(parents.values()):
        yield paragraph("Their products, the frames expressed in frame $0$:")
    for i in (i for i, parent in parents.items() if parent):
        yield from writer.transform(f"T_{{{writer.index(i, 0)}}}", robot.T_i0(i))
    numbers = {str(i) for i in writer.links}
    for frame in (x.name for x in writer.model.frames if x.name not in numbers):
        yield paragraph(f"Frame {frame}, expressed in frame $0$:")
        yield from writer.transform("T", robot.T_i0(frame))


def _jacobian(writer: Writer) -> Iterator[Block]:
    yield paragraph(
        r"Column $k$ is $(z_k \times (p - p_k), z_k)$ for a revolute joint, whose axis $z_k$ goes "
        r"through $p_k$, and $(z_k, 0)$ for a prismatic one. For the origin $p$ of the last frame, "
        "in frame $0$, the linear rows first:"
    )
    yield from writer.matrix("J", writer.robot.J)


def _centres_of_mass(writer: Writer) -> Iterator[Block]:
    robot = writer.robot
    yield paragraph(
        "The centres of mass in frame $0$ and the Jacobians of the links, by which "
        r"$v_i = J_{v_i} \dot{q}$ and $\omega_i = J_{\omega_i} \dot{q}$:"
    )
    omitted = []
    for i in writer.links:
        yield from writer.vector(f"r_{{C_{{{i}}}}}", robot.r_cm(i))
        linear, angular = f"J_{{v_{{{i}}}}}", rf"J_{{\omega_{{{i}}}}}"
        Jv, Jw = robot.Jv_cm_i(i), robot.Jw_cm_i(i)
        lines = writer.lines([*writer.entries(linear, Jv), *writer.entries(angular, Jw)])
        if lines <= _MAX_LINES:
            yield from writer.matrix(linear, Jv)
            yield from writer.matrix(angular, Jw)
        else:
            omitted.append(str(i))
    if omitted:
        yield paragraph(
            r"The columns of $J_{v_i}$ are $\partial r_{C_i} / \partial q_k$ and those of "
            r"$J_{\omega_i}$ the axes of the joints that turn; too long to print for link "
            f"{', '.join(omitted)}."
        )
