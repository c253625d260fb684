"""moro-codegen: what it takes, what it does, what it shows."""

from moro_codegen.cli.command import main

__all__ = ["main"]
