"""Targets: what takes the functions of a robot to a place without moro.

A target is one object. To moro it is known by its line in ``moro_codegen.registry``, from outside
by ``register``; nothing else asks which one it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from moro.model import Model
from moro_codegen import registry
from moro_codegen.program import Program
from moro_codegen.proof.golden import Golden


@dataclass(frozen=True)
class Export:
    """What there is to export, and what its files say of it."""

    #: named by the prefix of all files and functions
    program: Program
    model: Model
    golden: Golden
    #: whether functions for many samples were asked for, in languages that have others
    batch: bool
    #: SHA-256 of the model
    model_hash: str
    #: what was written, to be asked for again: the end of a command line and of a call
    command: str
    call: str

    @property
    def name(self) -> str:
        """The prefix."""
        return self.program.name


class Target(ABC):
    """One way to take functions along."""

    #: what ``targets=`` and ``--target`` call it
    name: ClassVar[str]
    #: names that no exported function may have: generated code uses them itself
    reserved: frozenset[str] = frozenset()

    @abstractmethod
    def files(self, export: Export) -> Mapping[str, str | bytes]:
        """Return what all files hold, by path in the target's folder.

        Raise ValueError for what the target cannot express. The same export gives the same files.
        """


def register(target: Target) -> None:
    """Make a target known, to ``export`` and to the command.

    Raises ValueError if its name belongs to another.
    """
    registry.TARGETS.add(target)


def get(name: str) -> Target:
    """Return the target of a name. Raise ValueError if there is none."""
    found = registry.TARGETS.find(name)
    if not isinstance(found, Target):
        raise TypeError(f"{name} is no Target: {found!r}")
    return found
