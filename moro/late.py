"""Names of a package that are imported when they are first asked for."""

import sys
from collections.abc import Callable, Mapping
from pkgutil import resolve_name
from typing import Any


def late(
    package: str, homes: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package; ``homes`` says where its names are."""
    there = vars(sys.modules[package])

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = there[name] = resolve_name(homes[name])
        return value

    return find, lambda: sorted({*there, *homes})
