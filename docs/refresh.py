"""Put the real output of every sample into the pages: python -m docs.refresh [PAGE ...].

And the formulas and tables of blocks.py; a PAGE may be a notebook, in which outputs are kept.
tests/test_docs.py and test_notebooks.py check that pages and output agree. Look at what changed
before you commit it.
"""

from __future__ import annotations

import doctest
import io
import os
import re
import sys
import tempfile
import textwrap
import traceback
from collections.abc import Iterator
from contextlib import redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from docs.blocks import BLOCK, NAMES, NEEDS, ROOT

#: what has samples
PAGES = (
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/howto").glob("*.md")),
)

#: characters of a line of output that fit on a page
WIDTH = 90
#: what is run as a whole
NOTEBOOKS = tuple(sorted((ROOT / "docs/notebooks").glob("*.ipynb")))

_SAMPLE = re.compile(r"^```(python|yaml|xml|c|cpp)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_PART = re.compile(f"{_SAMPLE.pattern}|{BLOCK.pattern}", re.MULTILINE | re.DOTALL)


def refreshed(text: str, names: dict[str, Any] | None = None) -> str:
    """Return a page with the output of its samples as it is now, ``names`` as they leave them."""
    names = {} if names is None else names
    names["__name__"] = "__main__"

    def part(match: re.Match[str]) -> str:
        language, code, begin, expression, _, end = match.groups()
        if expression:
            return f"{begin}{eval(expression, {**names, **NAMES})}{end}"  # noqa: S307 - our own pages
        if language != "python":
            write_file(code)
            return match[0]
        return f"```python\n{''.join(_samples(code, names))}```"

    end = _within_reach(text)
    return _PART.sub(part, text[:end]) + text[end:]


def _within_reach(text: str) -> int:
    """Return where a page begins to need what is not installed: it stays as it is from there."""
    for match in NEEDS.finditer(text):
        for name in match[1].split(", "):
            if find_spec(name) is None:
                print(f"the rest of the page needs {name}, not installed here", file=sys.stderr)
                return match.start()
    return len(text)


def write_file(text: str) -> Path:
    """Put a file of a page, named in its first line, where its samples find it."""
    name = re.match(r"(?:#|/\*|<!--) (\S+\.\w+)", text)
    path = Path(name[1] if name else "robot.yaml")
    path.write_text(text, encoding="utf-8")
    return path


def _samples(code: str, names: dict[str, Any]) -> Iterator[str]:
    for part in doctest.DocTestParser().parse(code):
        if isinstance(part, str):
            yield part
            continue
        first, *rest = part.source.splitlines()
        yield f">>> {first}\n" + "".join(f"... {line}\n" for line in rest)
        yield "".join(f"{line}\n" for line in _wrapped(_output(part.source, names)))


def _output(source: str, names: dict[str, Any]) -> str:
    printed = io.StringIO()
    with redirect_stdout(printed):
        try:
            exec(compile(source, "<sample>", "single"), names)  # noqa: S102 - our own pages
        except Exception as error:
            print("Traceback (most recent call last):\n    ...")
            print(*traceback.format_exception_only(error), sep="", end="")
    return printed.getvalue()


def _wrapped(text: str) -> Iterator[str]:
    for line in text.splitlines():
        if len(line) <= WIDTH or set(line) <= set("- "):
            yield line or "<BLANKLINE>"
        else:
            yield from textwrap.wrap(
                line,
                WIDTH,
                subsequent_indent="    ",
                break_long_words=False,
                break_on_hyphens=False,
            )


def executed(notebook: Path) -> str:
    """Return a notebook with its outputs as they are now, and nothing of when and where."""
    import nbformat
    from nbclient import NotebookClient
    from traitlets.config import Config

    found = nbformat.read(notebook, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        # figures have the same date and names inside every time
        (Path(folder) / "matplotlibrc").write_text("svg.hashsalt: moro\n", encoding="utf-8")
        NotebookClient(
            found,
            resources={"metadata": {"path": folder}},
            record_timing=False,
            timeout=300,
            config=Config({"KernelManager": {"transport": "ipc", "ip": f"{folder}/kernel"}}),
        ).execute(env={**os.environ, "SOURCE_DATE_EPOCH": "0"})
    for cell in found.cells:
        if cell.cell_type == "code":  # lines that said what was waited for are empty by now
            cell.outputs = [x for x in cell.outputs if x.get("data") != {"text/plain": ""}]
    found.metadata.language_info = {"name": "python"}
    return f"{nbformat.writes(found)}\n"


def main() -> None:
    """Refresh the pages that are named, or all."""
    here = Path.cwd()
    pages = [Path(name).resolve() for name in sys.argv[1:]] or [*PAGES, *NOTEBOOKS]
    for page in pages:
        if page.suffix == ".ipynb":
            page.write_text(executed(page), encoding="utf-8")
            continue
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)  # where samples find the robot files of their page
            page.write_text(refreshed(text), encoding="utf-8")
            os.chdir(here)


if __name__ == "__main__":
    main()
