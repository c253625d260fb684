"""For what kind of machine a library was compiled, by the first bytes of its file."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from moro_codegen import _runtime

#: what e_machine of ELF calls machines, and the processor types of Mach-O
ELF = {3: "x86", 21: "PowerPC64", 40: "Arm", 62: "x86-64", 183: "AArch64", 243: "RISC-V"}
MACH_O = {0x01000007: "x86-64", 0x0100000C: "AArch64"}


def kind_of(library: bytes) -> str | None:
    """Return for what machines a library is, by the first bytes of its file; None: it is not told.

    Libraries for several kinds at once, which macOS has, do not tell.
    """
    if library.startswith(b"\x7fELF"):
        number = int.from_bytes(library[18:20], "little" if library[5] == 1 else "big")
        return f"{ELF.get(number, f'machine {number}')} in ELF, {32 * library[4]} bits"
    if library.startswith(b"\xcf\xfa\xed\xfe"):
        number = int.from_bytes(library[4:8], "little")
        return f"{MACH_O.get(number, f'processor {number}')} under macOS"
    return None


@cache
def own_kind() -> str | None:
    """Return for what machines this Python's own extensions are."""
    return kind_of(Path(_runtime.__file__).read_bytes()[:64])
