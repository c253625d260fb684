"""The documentation tells the truth: every sample runs, every output is the one shown."""

from __future__ import annotations

import doctest
import importlib
import json
import pkgutil
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from sybil import Document, Example, Region, Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser

import moro
from docs import blocks
from docs.refresh import PAGES, write_file
from moro import Robot, load
from moro_codegen.backends import toolchain
from moro_codegen.program import generate

ROOT = Path(__file__).parent.parent
MODULES = ["moro", *(m.name for m in pkgutil.walk_packages(moro.__path__, "moro."))]

# a long line of output is shown as several
FLAGS = doctest.NORMALIZE_WHITESPACE


def write_robot_file(example: Example) -> None:
    """Put a robot file of a page where its samples find it, and see that it is right."""
    path = write_file(str(example.parsed))
    if not path.stem.startswith("broken"):
        load(path)


def write_source(example: Example) -> None:
    write_file(str(example.parsed))


def find_blocks(document: Document) -> Iterator[Region]:
    """Yield the formulas and tables that docs/refresh.py writes; not what takes time to measure."""
    for match in blocks.BLOCK.finditer(document.text):
        _, expression, shown, _ = match.groups()
        if not expression.startswith(blocks.TIMED):
            yield Region(match.start(), match.end(), (expression, shown), compare_block)


def find_needs(document: Document) -> Iterator[Region]:
    """Yield where a page needs what not everyone has: <!-- needs: numba, scipy -->."""
    for match in blocks.NEEDS.finditer(document.text):
        yield Region(match.start(), match.end(), match[1].split(", "), skip_without)


def skip_without(example: Example) -> None:
    for name in example.parsed:
        pytest.importorskip(name, reason=f"the rest of the page needs {name}, not installed here")


def compare_block(example: Example) -> None:
    expression, shown = example.parsed
    written = eval(expression, {**example.namespace, **blocks.NAMES})  # noqa: S307
    assert written == shown, "if what is written now is right: python -m docs.refresh"


SAMPLES = Sybil(
    [
        PythonCodeBlockParser(doctest_optionflags=FLAGS),
        CodeBlockParser("yaml", write_robot_file),
        CodeBlockParser("xml", write_robot_file),
        CodeBlockParser("c", write_source),
        CodeBlockParser("cpp", write_source),
        find_blocks,
        find_needs,
    ]
)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which no kernels are at first; pages that ask for the same one share it."""
    return tmp_path_factory.mktemp("cache")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_samples_of_a_page(
    page: Path, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if page.name == "control-loop.md" and sys.platform != "linux":
        pytest.skip("a loop by clock_nanosleep needs Linux")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    monkeypatch.setattr(toolchain, "LONG", 0)  # as long programs are: in half the time
    for example in SAMPLES.parse(page):
        example.evaluate()


def test_pages_have_samples() -> None:
    counts = {page.name: len(list(SAMPLES.parse(page))) for page in PAGES}
    assert counts["tutorial.md"] > 20
    assert counts["README.md"] > 3


@pytest.mark.parametrize("name", MODULES)
def test_samples_of_docstrings(name: str) -> None:
    module = importlib.import_module(name)
    assert doctest.testmod(module, optionflags=FLAGS).failed == 0


def test_a_wrong_output_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```python\n>>> 1 + 1\n3\n```\n")
    (example,) = SAMPLES.parse(page)
    with pytest.raises(AssertionError, match="3"):
        example.evaluate()


def test_operations_are_those_that_kernels_have() -> None:
    """If not: python -m benchmarks.operations --write, then python -m docs.refresh."""
    results = (ROOT / "benchmarks/results/operations.json").read_text(encoding="utf-8")
    *_, counts = (c for row, c in json.loads(results)["operations"].items() if row[0] == "+")
    for name, count in counts.items():
        ops = generate(load(name).model(), rigid=True).routines[0].ops
        assert [ops["add"] + ops["sub"] + ops["mul"], ops["sincos"]] == count


def test_names_lists_every_public_name_of_robot() -> None:
    text = (ROOT / "docs/names.md").read_text(encoding="utf-8")
    cells = re.findall(r"^\| (`[^|]+) \|", text, re.MULTILINE)
    listed = {name for cell in cells for name in re.findall(r"`(?:Robot\.)?(\w+)", cell)}
    public = {name for name in dir(Robot) if not name.startswith("_")}
    assert listed - {"Robot", "moro"} == public


def test_every_link_in_the_pages_leads_somewhere() -> None:
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"
