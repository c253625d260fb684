"""What is installed here: whose ``moro`` it is, and what a report of a fault has to name."""

from __future__ import annotations

import sys
from importlib.util import find_spec


def _require_moro() -> None:
    """Raise ImportError if the ``moro`` that Python finds is not the one that belongs here.

    PyPI has another project of that name. Where both are installed, the one installed last has
    overwritten files of the first, and removing either removes files of both.
    """
    try:
        from moro import Model  # noqa: F401 - what only ours has
    except ImportError as error:
        if error.name != "moro":
            raise
        raise ImportError(
            f"`import moro` finds {_place()}, not the package that comes with moro-codegen: "
            "another project is called moro, and the two cannot share an environment. Install "
            "moro-codegen in one of its own, or here in place of the other:\n"
            "  pip uninstall moro moro-codegen\n"
            "  pip install moro-codegen",
            name="moro",
        ) from None


def versions() -> str:
    """Return the versions of everything that shapes a kernel, a line each."""
    import platform
    from importlib import metadata

    import moro
    from moro_codegen.backends.toolchain import ToolchainError, find_compiler

    try:
        compiler = find_compiler().version
    except ToolchainError as error:
        compiler = str(error).splitlines()[0]
    packages = ", ".join(f"{name} {metadata.version(name)}" for name in ("numpy", "sympy"))
    return "\n".join(
        [
            f"moro-codegen {moro.__version__} in {_place()}",
            f"Python {platform.python_version()}, {packages}",
            f"{platform.platform()}, {platform.machine()}, {compiler}",
        ]
    )


def _place() -> str:
    """Return where Python finds moro."""
    if spec := find_spec("moro"):
        return ", ".join(spec.submodule_search_locations or [str(spec.origin)])
    return f"nothing in {', '.join(sys.path)}"


_require_moro()
