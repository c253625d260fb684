"""The C functions of a kernel for whoever calls C from Python: addresses, ctypes, capsules.

They are the functions for one state, ``void f(const double *q, ..., double *tau)``: results behind
inputs, run-time parameters as the last input, arrays of the kernel's type in a row. Nothing is
checked.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from moro_codegen.signature import Signature

#: by the functions' names
Calls: TypeAlias = dict[str, Any]

_REALS: dict[str, Any] = {"float64": ctypes.c_double, "float32": ctypes.c_float}
#: texts that capsules point to
_SIGNATURES: dict[str, Any] = {}


def functions(library: Path, name: str, key: str, signatures: Mapping[str, Signature]) -> Calls:
    """Return the functions of a robot's library as ctypes calls them, the interpreter unlocked.

    Raise ValueError if the library there is not that of the kernel with this key.
    """
    opened = ctypes.CDLL(str(library))
    said = ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(opened, f"{name}_key")))
    if said.decode() != key:
        raise ValueError(f"{library} has been replaced by another kernel's: open that one")
    found = {}
    for function, s in signatures.items():
        call = opened[f"{name}_{function}"]
        call.argtypes = [ctypes.POINTER(_REALS[s.dtype])] * (len(s.inputs) + len(s.outputs))
        call.restype = None
        found[function] = call
    return found


def address(function: Any) -> int:
    """Return the address of a function of ctypes."""
    value = ctypes.cast(function, ctypes.c_void_p).value
    assert value is not None  # noqa: S101 - a function that was found
    return value


def capsule(function: Any, s: Signature) -> Any:
    """Return a PyCapsule of a function; its name is its type: "void (const double *, double *)"."""
    real = "double" if s.dtype == "float64" else "float"
    arguments = [f"const {real} *"] * len(s.inputs) + [f"{real} *"] * len(s.outputs)
    text = f"void ({', '.join(arguments)})"
    # a capsule does not copy its name
    name = _SIGNATURES.setdefault(text, ctypes.create_string_buffer(text.encode()))
    pointer, chars = ctypes.c_void_p, ctypes.c_char_p
    new = ctypes.PYFUNCTYPE(ctypes.py_object, pointer, chars, pointer)
    make = new(("PyCapsule_New", ctypes.pythonapi))
    return make(address(function), ctypes.cast(name, chars), None)
