"""The contenders. Each module says how it is asked, in C (``loops``) and from Python.

A peer that is not installed, or does not work on this machine, is left out, and it is said why.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from types import ModuleType

#: moro first: what is compared is compared with it
MODULES = ("moro", "casadi", "pinocchio", "mujoco", "toolbox", "lambdify")


@dataclass(frozen=True)
class Peers:
    """The contenders that are there, and why others are not."""

    present: dict[str, ModuleType]
    absent: dict[str, str]

    @property
    def versions(self) -> dict[str, str]:
        """Names of packages and their versions."""
        return {k: v for module in self.present.values() for k, v in module.VERSIONS.items()}

    @property
    def flags(self) -> dict[str, str]:
        """What the compilers were told, for those that are compiled here."""
        return {
            name: " ".join(module.FLAGS)
            for name, module in self.present.items()
            if hasattr(module, "FLAGS")
        }


def find() -> Peers:
    """Return the peers of this environment."""
    found = {name: _imported(name) for name in MODULES}
    return Peers(
        {name: module for name, module in found.items() if isinstance(module, ModuleType)},
        {name: reason for name, reason in found.items() if isinstance(reason, str)},
    )


def _imported(name: str) -> ModuleType | str:
    """Return the module of a peer, or why there is none: its packages may raise anything."""
    try:
        return importlib.import_module(f"{__name__}.{name}")
    except Exception as error:
        return f"{type(error).__name__}: {error}"
