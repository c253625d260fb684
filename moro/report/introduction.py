"""What is given: rows, bodies, drives, gravity, and the notation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import sympy as sp

from moro.formats.dh.description import Description
from moro.printing.markup import markup
from moro.printing.notation import Notation
from moro.printing.typeset import Formula, matrix, text
from moro.report.page import Block, Paragraph, Section, paragraph
from moro.report.writer import Writer

_PAIRS = ("xx", "yy", "zz", "xy", "xz", "yz")


def introduction(writer: Writer) -> Iterator[Section]:
    """Yield the section that describes the arm."""
    source = writer.source
    joints = _rows(writer, source) if isinstance(source, Description) else _joints(writer)
    yield Section("The arm", [*joints, *_bodies(writer), *_legend(writer)])


def _rows(writer: Writer, arm: Description) -> Iterator[Block]:
    proximal = arm.convention == "mdh"
    which, before = ("modified", "i-1") if proximal else ("standard", "i")
    yield paragraph(
        f"An arm with {arm.dof} joint{'s' if arm.dof > 1 else ''}, given by {which} "
        "Denavit-Hartenberg parameters. Frame $i$ is fixed to link $i$, frame $0$ to the base."
    )
    names: Sequence[str] = ("i", f"a_{{{before}}}", rf"\alpha_{{{before}}}", "d_i", r"\theta_i")
    yield from _table(writer, names, arm.dh_parameters)
    yield from _rotors(writer)
    yield paragraph(
        "Frame $i$ expressed in frame $i-1$, by turns $R$ and shifts $T$ about and along axes"
        + (r", with $a_{i-1}$ and $\alpha_{i-1}$ of the row before:" if proximal else ":")
    )
    order = r"R_x(\alpha) T_x(a) R_z(\theta) T_z(d)"
    if not proximal:
        order = r"R_z(\theta) T_z(d) T_x(a) R_x(\alpha)"
    general = writer.displayed(f"T_{{i,i-1}} = {order}", _transform(arm.convention))
    if general is not None:
        yield general


def _joints(writer: Writer) -> Iterator[Block]:
    model = writer.model
    n = len(model.joints)
    yield paragraph(
        f"A robot with {n} joint{'s' if n > 1 else ''}. Link $i$ is moved by joint $i$, about or "
        "along the $z$ axis of its frame, by $x_i$; $p_i$ is the link that carries it, $0$ the "
        "base."
    )
    rows = [(joint.parent + 1, model.displacement(joint)) for joint in model.joints]
    yield from _table(writer, ("i", "p_i", "x_i"), rows)


def _table(writer: Writer, names: Sequence[str], rows: Sequence[Any]) -> Iterator[Block]:
    """Yield what is given of each joint, its type, and the limits if there are any."""
    write, model = writer.write, writer.model
    numbered = zip(writer.links, rows, model.joints, strict=False)  # rows have no rotors
    lines = [[write(i), *map(write, row), [text(joint.type.name)]] for i, row, joint in numbered]
    heads: list[str | Formula] = [*names, [text("joint")]]
    if "joint_limits" in writer.source.assumed:
        yield from writer.table(heads, lines)
    elif model.is_coupled:
        yield from writer.table(heads, lines)
        limits = [[write(i), _limits(writer, i)] for i in writer.numbers]
        yield from writer.table(["i", [text("limits")]], limits)
    else:
        for i, line in zip(writer.numbers, lines, strict=True):
            line.append(_limits(writer, i))
        yield from writer.table([*heads, [text("limits")]], lines)


def _rotors(writer: Writer) -> Iterator[Block]:
    """Yield the rotors beside rows: what carries them, and how far they turn on it."""
    write, model = writer.write, writer.model
    spinning = [(i, x) for i, x in enumerate(model.joints, 1) if x.type.spins]
    if spinning:
        yield paragraph("Rotors, the links that carry them, and the angles that they turn there:")
        rows = [[write(i), write(x.parent + 1), write(model.displacement(x))] for i, x in spinning]
        yield from writer.table(["i", "p_i", "x_i"], rows)


def _limits(writer: Writer, i: int) -> Formula:
    """Return what is given of the range of coordinate i."""
    limits = writer.model.coordinates[i - 1].limits
    if not limits:
        return [text("not given")]
    lower, upper = map(writer.write, limits)
    variable = writer.write(writer.robot.q(i))
    return [*lower, *markup(r"\le"), *variable, *markup(r"\le"), *upper]


def _transform(convention: str) -> Any:
    """Return the transform of one row, in general."""
    a, alpha, d, theta = sp.symbols("a alpha d theta")
    c, s, ca, sa = sp.cos(theta), sp.sin(theta), sp.cos(alpha), sp.sin(alpha)
    entries = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d]]
    if convention == "mdh":
        entries = [[c, -s, 0, a], [s * ca, c * ca, -sa, -d * sa], [s * sa, c * sa, ca, d * ca]]
    write = Notation(short=False).formula
    return matrix([[write(x) for x in row] for row in [*entries, [0, 0, 0, 1]]])


def _bodies(writer: Writer) -> Iterator[Block]:
    given = writer.source.given
    masses: dict[str, Sequence[Any]] = {}
    if (values := given("masses")) is not None:
        masses["m_i"] = values
    if (centres := given("cm_positions")) is not None:
        masses |= {f"{x}_{{C_i}}": _component(centres, k) for k, x in enumerate("xyz")}
    if masses:
        yield paragraph("Masses, and centres of mass $r_{C_i}$ in frame $i$, as far as set:")
        yield from writer.columns(masses)
    if (inertias := given("inertia_tensors")) is not None:
        yield paragraph("Inertia tensors $I_i$ about the centres of mass, in axes of frame $i$:")
        places = {pair: ("xyz".index(pair[0]), "xyz".index(pair[1])) for pair in _PAIRS}
        tensors = {p: [I[at] for I in inertias] for p, at in places.items()}
        yield from writer.columns(
            {f"I_{{i,{p}}}": x for p, x in tensors.items() if p[0] == p[1] or any(x)}
        )
    coulomb = given("coulomb_friction")
    drives = {
        "I_{r_i}": given("rotor_inertias"),
        "b_i": given("viscous_friction"),
        "f_i^{+}": coulomb and _component(coulomb, 0),
        "f_i^{-}": coulomb and _component(coulomb, 1),
    }
    found = {name: values for name, values in drives.items() if values is not None}
    if found:
        yield paragraph(
            "Rotor inertia $I_{r_i}$ on the side of the link, viscous friction $b_i$, Coulomb "
            "friction $f_i^{+}$ where the joint moves forward and $f_i^{-}$ where backward, as far "
            "as they are set:"
        )
        yield from writer.columns(found)
    if (gravity := given("gravity")) is not None:
        yield paragraph("Gravitational acceleration in frame $0$:")
        yield from writer.vector("g_0", gravity)


def _component(vectors: Sequence[Any], k: int) -> list[Any]:
    return [vector[k] for vector in vectors]


def _legend(writer: Writer) -> Iterator[Block]:
    robot, write = writer.robot, writer.write
    parts: list[str | Formula] = []
    turning = [q for q, kind in zip(robot.qs, writer.model.types, strict=True) if kind.is_angle]
    if turning and writer.notation.short:
        long = Notation(robot.qs, short=False)
        parts.append("Sines and cosines are abbreviated: ")
        for x in (sp.sin(turning[0]), sp.cos(sp.Add(*turning[:2]))):
            parts += [[*write(x), *markup("="), *long.formula(x)], ", "]
        parts[-1] = ", and so on. "
    parts.append("Dots are derivatives with respect to time. Units are SI, angles in radians.")
    if writer.notation.rounded:
        parts.append(f" Numbers are rounded to {writer.notation.digits} digits.")
    yield Paragraph(parts)
    yield Paragraph(
        [
            "Matrices that are wider than the page are listed by their entries: those that are not "
            "zero, of transforms in the first three rows, of symmetric ones not below the diagonal."
        ]
    )
