"""A program as a Cython extension: a folder that ``pip install`` builds and that needs NumPy only.

The functions are those of the C source, which is part of the extension. Python calls them with
arrays, other Cython code through the .pxd, without the interpreter's lock.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moro_codegen import calls
from moro_codegen._runtime import Library
from moro_codegen.backends import Backend, Folder, Opened, c_text, extension
from moro_codegen.backends.c import BACKEND as C
from moro_codegen.backends.c import require_kind, require_sound, signed, unsigned
from moro_codegen.backends.toolchain import Compiler
from moro_codegen.emit.describe import argument_lines, conventions, docstring
from moro_codegen.emit.render import render

if TYPE_CHECKING:
    from moro_codegen.functions.arguments import Argument
    from moro_codegen.program import Program, Routine

#: as kernels in C are built, for any processor; no -std, so that products and sums fuse
FLAGS = "-O3 -fno-math-errno -fno-tree-slp-vectorize"


class Cython(Backend):
    """A package that can be installed without moro, and its extension."""

    name = "cython"
    #: what Cython and the module call something else, besides the words of C and Python
    reserved = frozenset(
        """
        cdef cpdef ctypedef cimport include nogil gil api public readonly by DEF IF ELIF ELSE NULL
        bint object size_t ptrdiff_t cnp np cython len list tuple zip isinstance type
        TypeError ValueError NotImplemented functions calls
        """.split()  # noqa: SIM905
    )

    def emit(self, program: Program) -> dict[str, str]:
        """Return the files of the package's folder."""
        return {f"{outside(program.name)}/{path}": text for path, text in emit(program).items()}

    def signed(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts, with a function in the C source that returns the key."""
        return signed(texts, _source(name), name, key)

    def unsigned(self, texts: Mapping[str, str], name: str, key: str) -> dict[str, str]:
        """Return the texts without that function."""
        return unsigned(texts, _source(name), name, key)

    def compiler(self, operations: int, arch: str) -> Compiler:
        """Return the C compiler, as that of the C backend."""
        return C.compiler(operations, arch)

    def made_with(self, compiler: Compiler) -> dict[str, Any]:
        """Return also the versions of Cython and setuptools."""
        return compiler.as_json() | extension.tools()

    def build(self, compiler: Compiler, folder: Path, name: str) -> None:
        """Build the extension."""
        extension.build(compiler, folder / outside(name), package(name))

    def loaded(self, folder: Path, name: str) -> Path:
        """Return the path of the extension."""
        return extension.library(folder / outside(name) / package(name))

    def open(self, folder: Folder, content: bytes) -> Opened:
        """Open the extension."""
        path = self.loaded(folder.path, folder.name)
        require_kind(content, path)
        library = Library(str(path))
        key = library.text(f"{folder.name}_key")
        source, header = path.with_name("functions.pyx"), path.with_name(f"{folder.name}.h")
        return Opened(source, self._functions(library, path, folder), key, header, path)

    def _functions(
        self, library: Library, path: Path, folder: Folder
    ) -> Iterator[tuple[str, Callable[..., Any]]]:
        require_sound(library, path, folder.name)
        module = extension.load(path)
        for name, s in folder.signatures.items():
            run, direct = getattr(module, f"_{name}_of_arrays"), getattr(module, name)
            yield name, s.calls.function(run, "\n".join(docstring(s)), direct)


def outside(name: str) -> str:
    """Return the name of the folder of a robot's package, inside that of the kernel."""
    return f"{name}_cython"


def package(name: str) -> str:
    """Return the name of the package of a robot: ``import puma560_kernel``."""
    return f"{name}_kernel"


def _source(name: str) -> str:
    return f"{outside(name)}/{package(name)}/{name}.c"


def emit(program: Program, made: Sequence[str] = ()) -> dict[str, str]:
    """Return the texts of all files, by path in the folder; ``made`` says more of their origin.

    Raise ValueError for float32.
    """
    if program.scalar != "double":
        raise ValueError("the Cython backend computes in double precision only")
    inside = package(program.name)
    holes = {
        "name": program.name,
        "package": inside,
        "title": f"{program.name}: dynamics of a robot arm with {program.dof} joints",
        "notes": [*made, "", *conventions(program)] if made else conventions(program),
        "flags": FLAGS,
        "tested": bool(made),
        "calls_source": inspect.getsource(calls),
        "routines": [_holes(program, routine) for routine in program.routines],
    }
    files = {
        "pyproject.toml": "cython_pyproject.toml.jinja",
        "setup.py": "cython_setup.py.jinja",
        "README.md": "cython_readme.md.jinja",
        f"{inside}/__init__.py": "cython_init.py.jinja",
        f"{inside}/__init__.pxd": "cython_init.pxd.jinja",
        f"{inside}/calls.py": "cython_calls.py.jinja",
        f"{inside}/functions.pyx": "cython_functions.pyx.jinja",
        f"{inside}/functions.pxd": "cython_functions.pxd.jinja",
    }
    texts = {path: render(template, **holes) for path, template in files.items()}
    return texts | {f"{inside}/{name}": text for name, text in c_text.emit(program).items()}


def _holes(program: Program, routine: Routine) -> dict[str, object]:
    """Return what the templates say of one routine."""
    signature = program.signature(routine)
    inputs, outputs = signature.inputs, signature.outputs
    return {
        "name": routine.function.name,
        "call": ", ".join(a.name for a in routine.inputs),
        "operands": [_array(a) for a in inputs],
        "outputs": [_array(a) for a in outputs],
        "returned": ", ".join(a.name for a in outputs),
        "calls": signature.calls,
        "doc": docstring(signature),
        "all_arguments": argument_lines([*inputs, *outputs]),
        **_prototypes(inputs, outputs),
    }


def _array(a: Argument) -> dict[str, object]:
    """Return what the templates say of an array: its strides are those of contiguous rows."""
    sizes = a.sizes
    strides = [math.prod(sizes[k:]) for k in range(len(sizes) + 1)]
    return {"name": a.name, "shape": sizes, "size": a.size, "strides": strides}


def _prototypes(inputs: Sequence[Argument], outputs: Sequence[Argument]) -> dict[str, str]:
    """Return types and names of what the C functions take, for one sample and for a batch."""
    single: list[tuple[str, str]] = []
    batch = [("size_t ", "_count")]
    for k, a in enumerate((*inputs, *outputs)):
        pointer = ("const double *" if k < len(inputs) else "double *", f"_a{k}")
        single.append(pointer)
        batch += [pointer, *(("ptrdiff_t ", f"_s{k}_{i}") for i in range(1 + len(a.shape)))]
    return {
        "single": ", ".join(type_.strip() for type_, _ in single),
        "single_names": ", ".join(name for _, name in single),
        "single_parameters": ", ".join(type_ + name for type_, name in single),
        "batch": ", ".join(type_.strip() for type_, _ in batch),
        "batch_names": ", ".join(name for _, name in batch),
        "batch_parameters": ", ".join(type_ + name for type_, name in batch),
    }


BACKEND = Cython()
