"""The backends and targets there are, by name; each is imported when it is first asked for.

What requests and ``--help`` need to know of them is here; neither loads any of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pkgutil import resolve_name
from typing import Protocol


class Registered(Protocol):
    """What is asked of a backend or target before there is a program for it."""

    @property
    def name(self) -> str:
        """What ``backend=``, ``targets=`` and the command call it."""

    @property
    def reserved(self) -> frozenset[str]:
        """Names that no function may have, because generated code uses them itself."""


class Registry:
    """What there is of one kind, by name."""

    def __init__(self, kind: str, homes: Mapping[str, str]) -> None:
        """``homes`` says where each is, ``package.module:NAME``, until it is imported."""
        self.kind = kind
        self._known: dict[str, Registered | str] = dict(homes)

    def names(self) -> tuple[str, ...]:
        """Return the names of all."""
        return tuple(self._known)

    def add(self, one: Registered) -> None:
        """Make one known. Raise ValueError if its name belongs to another."""
        if one.name in self._known:
            raise ValueError(f"there is a {self.kind} {one.name!r} already")
        self._known[one.name] = one

    def remove(self, name: str) -> None:
        """Forget one that was added."""
        del self._known[name]

    def find(self, name: str) -> Registered:
        """Return one, imported if need be. Raise ValueError if there is none of this name."""
        if name not in self._known:
            raise ValueError(f"{self.kind} must be {either(self._known)}, not {name!r}")
        found = self._known[name]
        if isinstance(found, str):
            loaded: Registered = resolve_name(found)
            found = self._known[name] = loaded
        return found


BACKENDS = Registry(
    "backend",
    {
        "c": "moro_codegen.backends.c:BACKEND",
        "cython": "moro_codegen.backends.cython:BACKEND",
        "numpy": "moro_codegen.backends.numpy:BACKEND",
    },
)

TARGETS = Registry(
    "target",
    {
        "c": "moro_codegen.targets.c:TARGET",
        "cpp": "moro_codegen.targets.cpp:TARGET",
        "python": "moro_codegen.targets.python:TARGET",
        "cython": "moro_codegen.targets.cython:TARGET",
        "casadi": "moro_codegen.targets.casadi:TARGET",
        "fmu": "moro_codegen.targets.fmu:TARGET",
    },
)


def reserved() -> frozenset[str]:
    """Return the names that some backend's code uses itself."""
    return frozenset[str]().union(*(BACKENDS.find(name).reserved for name in BACKENDS.names()))


def either(names: Iterable[str]) -> str:
    """Return ``"c", "cython" or "numpy"``."""
    *most, last = [f'"{name}"' for name in names]
    return f"{', '.join(most)} or {last}" if most else last
