"""Energies, M, C, G and the equations of motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from moro.abc import t
from moro.printing.equations import Equation
from moro.printing.markup import markup
from moro.printing.typeset import PLUS, Formula
from moro.report.page import Aligned, Block, Paragraph, Section, paragraph
from moro.report.writer import Writer

#: an entry of M or G with more operations than this makes the report name constants
_LONG_ENTRY = 40
#: lines per link and per equation that are written out
_MAX_ENERGY, _MAX_EQUATION = 4, 8
#: lines per entry of M, and lines of M, up to which C is written by entries, or at all
_MAX_SHORT, _MAX_INERTIA = 2, 400

_NEEDED = ("masses", "cm_positions", "inertia_tensors", "gravity")


@dataclass(frozen=True)
class Terms:
    """M, G and P as the report writes them, in named constants or without."""

    M: Any
    G: Any
    P: Any
    constants: Mapping[Any, Any]
    #: whether names are used
    named: bool
    #: lines that M takes
    lines: int


def dynamics(writer: Writer) -> Iterator[Section]:
    """Yield the sections on the dynamics, or one that says what is missing for it."""
    robot = writer.robot
    missing = [name for name in _NEEDED if name in writer.model.not_set]
    if missing:
        words = f"Not derived, because these are not set: {', '.join(missing)}."
        yield Section("Dynamics", [Paragraph([words])])
        return
    if any(q.is_Symbol for q in robot.qs):
        words = "Not derived: a joint variable that is a plain symbol has no velocity."
        yield Section("Dynamics", [Paragraph([words])])
        return
    terms = _terms(writer)
    if terms.constants:
        names = paragraph("Combinations of lengths, masses and inertias in what follows:")
        yield Section("Constants", [names, writer.definitions(terms.constants)])
    yield Section("Energies", list(_energies(writer, terms)))
    yield Section("Inertia matrix", list(_inertia(writer, terms)))
    yield Section("Coriolis and centrifugal terms", list(_coriolis(writer, terms)))
    yield Section("Gravity and friction", list(_gravity(writer, terms)))
    yield Section("Equations of motion", list(_equations(writer, terms)))


def _terms(writer: Writer) -> Terms:
    robot = writer.robot
    M, G, P = robot.inertia_matrix(), robot.gravity_vector(), robot.potential_energy()
    named = any(x.count_ops() > _LONG_ENTRY for x in (*M, *G))
    constants: dict[Any, Any] = {}
    if named:
        collector = writer.collector
        inertia, potential = collector.inertia_matrix(), collector.potential_energy()
        M, G, P = inertia.matrix, collector.gravity_vector().matrix, potential.matrix[0]
        constants = {**inertia.constants, **potential.constants}
    return Terms(M, G, P, constants, named, writer.lines(writer.entries("M", M)))


def _is_short(writer: Writer, terms: Terms) -> bool:
    return terms.lines <= _MAX_SHORT * writer.robot.dof**2


def _energies(writer: Writer, terms: Terms) -> Iterator[Block]:
    robot, few = writer.robot, _MAX_ENERGY * writer.robot.dof
    yield paragraph(
        "Energies of link $i$, kinetic and potential, with the rotation $R_{i0}$ of frame $i$:"
    )
    kinetic = r"\frac{1}{2} m_i v_i^T v_i + \frac{1}{2} \omega_i^T R_{i0} I_i R_{i0}^T \omega_i"
    potential = "-m_i g_0^T r_{C_i}"
    yield Aligned([_formula("K_i", kinetic), _formula("P_i", potential)])
    P = [writer.equation(f"P_{{{i}}}", robot.link_potential_energy(i)) for i in writer.links]
    total = [_formula("K", r"\frac{1}{2} \dot{q}^T M \dot{q}")]
    if _is_short(writer, terms):
        K = [writer.equation(f"K_{{{i}}}", robot.link_kinetic_energy(i)) for i in writer.links]
        named = writer.collector.kinetic_energy().matrix[0] if terms.named else None
        total = [writer.equation("K", named or robot.kinetic_energy())]
        if writer.lines(K) <= few:
            yield Aligned(K)
    if writer.lines(P) <= few:
        yield Aligned(P)
    rotors = ", and the rotors" if "rotor_inertias" not in writer.model.not_set else ""
    yield paragraph(f"All links{rotors} together:")
    yield Aligned([*total, writer.equation("P", terms.P)])


def _inertia(writer: Writer, terms: Terms) -> Iterator[Block]:
    rotors = "rotor_inertias" not in writer.model.not_set
    yield paragraph(
        "$M$ is symmetric, the sum over all links of "
        r"$m_i J_{v_i}^T J_{v_i} + J_{\omega_i}^T R_{i0} I_i R_{i0}^T J_{\omega_i}$"
        + (", with the rotor inertias on its diagonal:" if rotors else ":")
    )
    yield from writer.matrix("M", terms.M)


def _coriolis(writer: Writer, terms: Terms) -> Iterator[Block]:
    yield paragraph(
        r"With Christoffel symbols $c_{ijk} = \frac{1}{2} (\partial M_{ij} / \partial q_k + "
        r"\partial M_{ik} / \partial q_j - \partial M_{jk} / \partial q_i)$, entries of $C$ are "
        r"$C_{ij} = \sum_{k} c_{ijk} \dot{q}_k$."
    )
    robot = writer.robot
    if _is_short(writer, terms):
        C = robot.coriolis_matrix(collect=terms.named)
        yield from writer.matrix("C", C.matrix if terms.named else C)
    elif terms.lines > _MAX_INERTIA:
        yield paragraph("For this arm they are too long to print.")
    else:
        symbols = writer.collector.christoffel_symbols()
        yield Aligned(list(_christoffel(writer, symbols)))
        yield paragraph(
            "Beside $c_{ikj} = c_{ijk}$, all others are zero. Entries that are not zero:"
        )
        yield Aligned(list(_coriolis_entries(writer, symbols)))


def _christoffel(writer: Writer, symbols: Mapping[Any, Any]) -> Iterator[Equation]:
    """Christoffel symbols, each value written once, up to its sign."""
    written: dict[Any, Any] = {}
    for indices, value in symbols.items():
        name = sp.Symbol(f"c_{{{writer.index(*indices)}}}")
        known = written.get(value, -written[-value] if -value in written else None)
        written.setdefault(value, name)
        yield Equation(writer.write(name), writer.write(value if known is None else known))


def _coriolis_entries(writer: Writer, symbols: Mapping[Any, Any]) -> Iterator[Equation]:
    for i in writer.numbers:
        for j in writer.numbers:
            terms = []
            for k in writer.numbers:
                indices = (i, min(j, k), max(j, k))
                if indices in symbols:
                    name = sp.Symbol(f"c_{{{writer.index(*indices)}}}")
                    terms.append(name * writer.robot.q_dot(k))
            if terms:
                yield writer.equation(f"C_{{{writer.index(i, j)}}}", sp.Add(*terms))


def _gravity(writer: Writer, terms: Terms) -> Iterator[Block]:
    robot = writer.robot
    yield paragraph(r"$G_i = \partial P / \partial q_i$:")
    yield from writer.vector("G", terms.G)
    if _has_friction(writer):
        yield paragraph("Friction, viscous and Coulomb:")
        friction = robot.friction_vector()
        numbered = zip(writer.numbers, friction, strict=True)
        yield Aligned([writer.equation(f"F_{{{i}}}", x) for i, x in numbered])


def _equations(writer: Writer, terms: Terms) -> Iterator[Block]:
    robot = writer.robot
    form = r"M \ddot{q} + C \dot{q} + G" + (" + F" if _has_friction(writer) else "")
    yield paragraph(rf"${form} = \tau$, row by row:")
    names = [rf"\tau_{{{i}}}" for i in writer.numbers]
    if _is_short(writer, terms):
        model = robot.dynamic_model(collect=terms.named)
        lefts = model.matrix if terms.named else [equation.lhs for equation in model]
        explicit = [writer.equation(name, x) for name, x in zip(names, lefts, strict=True)]
        if writer.lines(explicit) <= _MAX_EQUATION * robot.dof:
            yield Aligned(explicit)
            return
    rows = (_row(writer, terms, i) for i in writer.numbers)
    yield Aligned([Equation(markup(name), row) for name, row in zip(names, rows, strict=True)])


def _row(writer: Writer, terms: Terms, i: int) -> Formula:
    """Return row i of M qdd + C qd + G + F in names of the entries."""
    robot, found = writer.robot, []
    for j in writer.numbers:
        at = writer.index(min(i, j), max(i, j))
        if terms.M[i - 1, j - 1] != 0:
            found.append(sp.Symbol(f"M_{{{at}}}") * robot.q_dot(j).diff(t))
    found += [sp.Symbol(f"C_{{{writer.index(i, j)}}}") * robot.q_dot(j) for j in writer.numbers]
    if terms.G[i - 1] != 0:
        found.append(sp.Symbol(f"G_{{{i}}}"))
    if _has_friction(writer):
        found.append(sp.Symbol(f"F_{{{i}}}"))
    row = writer.write(found[0])
    for term in found[1:]:
        row += [PLUS, *writer.write(term)]
    return row


def _has_friction(writer: Writer) -> bool:
    return not {"viscous_friction", "coulomb_friction"} <= writer.model.not_set


def _formula(left: str, right: str) -> Equation:
    return Equation(markup(left), markup(right))
