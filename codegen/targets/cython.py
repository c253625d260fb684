"""Cython: a package that pip builds and installs, and other Cython code calls."""

from __future__ import annotations

from moro_codegen.backends import c_text, cython
from moro_codegen.targets import Export, Target
from moro_codegen.targets.python import made, test


class Cython(Target):
    """The folder of a package, with its test."""

    name = "cython"
    reserved = cython.BACKEND.reserved | c_text.RESERVED

    def files(self, export: Export) -> dict[str, str]:
        """Return the package, and a test beside it."""
        package = cython.package(export.name)
        files = cython.emit(export.program, made(export))
        return files | {f"tests/test_{export.name}.py": test(export, package)}


TARGET = Cython()
