"""Text of others - names, summaries, units, meanings - in the places where emitted code holds it.

One function a kind of place. A string literal of Python is ``repr``; lines of comments in Python,
Cython and TOML need to be ``printable`` only.
"""

from __future__ import annotations


def printable(text: str) -> str:
    """Return text as one line that shows what it is.

    Line ends, control characters, those that turn the direction of writing and halves of surrogate
    pairs are written as Python's strings write them.
    """
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def c_comment(line: str) -> str:
    """Return a line for a comment of C between ``/*`` and ``*/``: it ends and nests none.

    ``??/`` would be a backslash, and one at the end of the line joins it with the next.
    """
    line = printable(line).replace("??", "? ?").replace("*/", "* /").replace("/*", "/ *")
    line = f"{line} ." if line.rstrip().endswith("\\") else line
    return f"{line} " if line.endswith(("*", "/")) else line


def c_string(text: str) -> str:
    """Return text as a string literal of C: its UTF-8, byte by byte where it is not plain."""
    plain = "".join(
        chr(x) if 32 <= x < 127 and chr(x) not in '"\\?' else f"\\{x:03o}"
        for x in text.encode("utf-8", "backslashreplace")
    )
    return f'"{plain}"'


def python_docstring(line: str) -> str:
    """Return a line for a docstring between ``\"\"\"``, which reads as the line itself."""
    line = printable(line).replace("\\", "\\\\")
    inside = line.rstrip('"')
    return inside.replace('"""', '\\"\\"\\"') + '\\"' * (len(line) - len(inside))
