"""Names that become part of generated code: identifiers of C, C++ and Python alike."""

from __future__ import annotations

import keyword
import re
import unicodedata

#: characters of a name
MAX_LENGTH = 40

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

_C_KEYWORDS = """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor
    bool break case catch char char8_t char16_t char32_t class co_await co_return co_yield compl
    concept const const_cast consteval constexpr constinit continue decltype default delete do
    double dynamic_cast else enum explicit export extern false float for friend goto if inline int
    long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
    public reflexpr register reinterpret_cast requires restrict return short signed sizeof static
    static_assert static_cast struct switch synchronized template this thread_local throw true try
    typedef typeid typename typeof typeof_unqual union unsigned using virtual void volatile wchar_t
    while xor xor_eq
    """.split()  # noqa: SIM905 - a table of words


def fault(name: str) -> str | None:
    """Return what keeps ``name`` from being a name in generated code, or None."""
    if not _IDENTIFIER.fullmatch(name):
        return "is not a letter followed by letters, digits and `_`"
    if name in _C_KEYWORDS or keyword.iskeyword(name):
        return "is a keyword of C, C++ or Python"
    if len(name) > MAX_LENGTH:
        return f"has {len(name)} characters; a name has at most {MAX_LENGTH}"
    return None


def identifier(text: str, prefix: str = "robot") -> str:
    """Map any text to a name: accents go, whatever else cannot stand in a name becomes ``_``.

    ``prefix`` goes in front of a keyword or a digit: "5-axis" becomes "robot_5_axis".
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")
    if fault(name[:MAX_LENGTH]):
        name = f"{prefix}_{name}".strip("_")
    return name[:MAX_LENGTH].rstrip("_")
