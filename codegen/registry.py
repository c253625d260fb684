"""The backends there are, by name; each is imported when it is first asked for.

What requests and ``--help`` need to know of backends is here; neither loads any of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from pkgutil import resolve_name
from typing import NamedTuple, Protocol


class Registered(Protocol):
    """What is asked of a backend before there is a program for it."""

    @property
    def name(self) -> str:
        """What ``backend=`` calls it."""

    @property
    def language(self) -> str:
        """What ``--emit`` calls the sources that it writes."""

    @property
    def reserved(self) -> frozenset[str]:
        """Names that no function may have, because generated code uses them itself."""


class Home(NamedTuple):
    """Where a backend is that has not been imported."""

    name: str
    language: str
    place: str


_BACKENDS: dict[str, Registered | Home] = {
    home.name: home
    for home in (
        Home("c", "c", "moro_codegen.backends.c:BACKEND"),
        Home("cython", "cython", "moro_codegen.backends.cython:BACKEND"),
        Home("numpy", "python", "moro_codegen.backends.numpy:BACKEND"),
    )
}


def names() -> tuple[str, ...]:
    """Return the names of all backends."""
    return tuple(_BACKENDS)


def languages() -> dict[str, str]:
    """Return the languages that sources can be written in, each with its backend's name."""
    return {backend.language: name for name, backend in _BACKENDS.items()}


def add(backend: Registered) -> None:
    """Make a backend known. Raise ValueError if its name or language belongs to another."""
    other = languages().get(backend.language)
    if backend.name in _BACKENDS or other is not None:
        raise ValueError(f"there is a backend {other or backend.name!r} already")
    _BACKENDS[backend.name] = backend


def remove(name: str) -> None:
    """Forget a backend that was added."""
    del _BACKENDS[name]


def find(name: str) -> Registered:
    """Return a backend, imported if need be. Raise ValueError if there is none of this name."""
    if name not in _BACKENDS:
        raise ValueError(f"backend must be {either(_BACKENDS)}, not {name!r}")
    found = _BACKENDS[name]
    if isinstance(found, Home):
        loaded: Registered = resolve_name(found.place)
        found = _BACKENDS[name] = loaded
    return found


def reserved() -> frozenset[str]:
    """Return the names that some backend's code uses itself."""
    return frozenset[str]().union(*(find(name).reserved for name in _BACKENDS))


def either(names: Iterable[str]) -> str:
    """Return ``"c", "cython" or "numpy"``."""
    *most, last = [f'"{name}"' for name in names]
    return f"{', '.join(most)} or {last}"
