"""What is to be said of any robot, or of the part of it that is meant."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from moro.formats.assembly.assembly import Assembly
from moro.model import Drive

#: of a drive: what is said of it, in which words
_SAID: tuple[tuple[str, str, Callable[[Drive], bool]], ...] = (
    ("friction", "damping and friction of", lambda x: bool(x.viscous or any(x.coulomb))),
    ("rotors", "inertia of what turns with", lambda x: bool(x.rotor_inertia)),
    ("springs", "springs of", lambda x: bool(x.stiffness)),
)


def notes(part: Assembly) -> Iterator[tuple[str, str]]:
    """Yield (of what, what): what stands still and has a mass, which joints have drives."""
    for link in part.links:
        mass = sum(body.mass for body in link.bodies)
        if link.parent is None and mass:
            yield "base", f"{link.name} stands still, with its {float(mass):.6g} kg"
    motions = [motion for link in part.links for motion in link.motions]
    for what, words, has in _SAID:
        if found := [motion.name for motion in motions if has(motion.drive)]:
            yield what, f"{words} {', '.join(found)}"
