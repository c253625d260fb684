"""The derivation of an arm's equations of motion, written out: ``robot.report("tex" | "html")``.

Sections: the arm as given, frames, Jacobians, energies, M, C and G, equations of motion. Entries
that are long are written in named constants (``moro.printing.collect``), long sums are broken into
lines, and what would still be longer than a reader wants is given by its formula.
"""

from __future__ import annotations

from moro.formats.source import Source
from moro.mechanics import Mechanics
from moro.printing.collect import Collector
from moro.report.dynamics import dynamics
from moro.report.introduction import introduction
from moro.report.kinematics import kinematics
from moro.report.page import PAGE_WIDTH, Format, Section, render
from moro.report.writer import Writer


def report(robot: Mechanics, source: Source, collector: Collector, target: Format) -> str:
    """Return the derivation in LaTeX ("tex") or as a self-contained page with MathML ("html").

    ``source`` is what the robot is made of; ``collector`` writes its results in named constants.
    What is not set is left out, and the report says so. ValueError for another format.
    """
    if target not in PAGE_WIDTH:
        raise ValueError(f'a report is "tex" or "html", not {target!r}')
    title = f"Equations of motion: {source.name}"
    writer = Writer(robot, source, collector, PAGE_WIDTH[target])
    return render(title, sections(writer), target)


def sections(writer: Writer) -> list[Section]:
    """Return the sections of the report."""
    derived = [*kinematics(writer), *dynamics(writer)]  # first: the legend says what was rounded
    return [*introduction(writer), *derived]
