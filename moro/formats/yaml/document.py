"""YAML to a plain tree that remembers its lines and the source text of every value.

A reader of events instead of ``yaml.safe_load``, because a robot file needs what that drops: the
line of each key, decimals as they were typed, keys given twice. The bounds below hold while
reading, so that a hostile file costs no more than a good one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn, TypeAlias

import yaml

from moro.formats.errors import Problem

#: bytes of a file
MAX_SIZE = 4_000_000
#: entries of a list; the longest one in a robot file is its list of links
MAX_ITEMS = 300
#: values in a file, with those that aliases repeat counted each time
MAX_VALUES = 20_000
#: characters of a key
MAX_KEY = 100
#: lists and mappings inside each other; a robot file needs 7
MAX_NESTING = 10


@dataclass(frozen=True)
class Scalar:
    """A single value: its source text, and what YAML takes it for: "str", "bool", "null", ...

    Or a value of Python's, which stands in no line.
    """

    text: str
    kind: str
    line: int | None
    size: int = 1
    value: Any = None


class Table(dict[str, Any]):
    """A YAML mapping; ``lines`` has the line of each key."""

    def __init__(self, line: int | None) -> None:
        super().__init__()
        self.line = line
        self.lines: dict[str, int | None] = {}
        self.size = 1


class List(list[Any]):
    """A YAML sequence."""

    def __init__(self, line: int | None) -> None:
        super().__init__()
        self.line = line
        self.size = 1


Node: TypeAlias = Scalar | Table | List


class DocumentError(Exception):
    """Text that is not one YAML document within the bounds."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.message)
        self.problem = problem


def compose(text: str) -> tuple[Node, list[Problem]]:
    """Return the tree of the one document in ``text``, and the keys that it gives twice.

    Raises DocumentError where there is no tree: text that is not YAML, or is beyond a bound.
    """
    reader = _Reader(text)
    try:
        return reader.document(), reader.problems
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise DocumentError(_explained(error, text)) from None


def place(tree: Node, location: tuple[int | str, ...]) -> tuple[int | None, str]:
    """Return the line and the name, such as ``links[2].mass``, of the node at ``location``.

    Steps that the tree does not have are left out, but for the last: a missing key is named too.
    """
    node, line, field = tree, tree.line, ""
    for step in location:
        if isinstance(node, Table) and step in node:
            line, node = node.lines[str(step)], node[str(step)]
            field = _dotted(field, str(step))
        elif isinstance(node, List) and isinstance(step, int) and step < len(node):
            node = node[step]
            line = node.line
            field = f"{field}[{step + 1}]"
        elif isinstance(node, Table) and step == location[-1]:
            field = _dotted(field, str(step))
    return line, field


def tree_of(value: Any) -> Node:
    """Return mappings, lists and values of Python's as the tree of a document without lines."""
    if isinstance(value, Mapping):
        table = Table(None)
        for key, part in value.items():
            table[str(key)] = tree_of(part)
            table.lines[str(key)] = None
        return table
    if getattr(value, "shape", None) and hasattr(value, "tolist"):
        shape, value = value.shape, value.tolist()
        if len(shape) == 2 and 1 in shape:  # a column or a row of SymPy
            value = [x for row in value for x in row]
    if isinstance(value, (list, tuple)):
        entries = List(None)
        entries.extend(map(tree_of, value))
        return entries
    if value is None:
        return Scalar("~", "null", None)
    if isinstance(value, str):
        return Scalar(value, "str", None)
    return Scalar(str(value), "bool" if isinstance(value, bool) else "value", None, value=value)


def _dotted(field: str, key: str) -> str:
    return f"{field}.{key}" if field else key


def _refuse(line: int | None, field: str, message: str) -> NoReturn:
    raise DocumentError(Problem(line, field, message))


class _Reader:
    """Turns the parser's events into a tree, one method per kind of node."""

    def __init__(self, text: str) -> None:
        self.events: Iterator[Any] = iter(yaml.parse(text, Loader=yaml.SafeLoader))
        self.resolver: Any = yaml.resolver.Resolver()
        self.anchors: dict[str, Node | None] = {}  # None while the node is being read
        self.problems: list[Problem] = []

    def document(self) -> Node:
        next(self.events)  # the stream starts
        event = next(self.events)
        if isinstance(event, yaml.StreamEndEvent):
            _refuse(1, "", "the file is empty; expected `links:` with one entry for each joint")
        tree = self.node(next(self.events), "", 0)
        next(self.events)  # the document ends
        event = next(self.events)
        if not isinstance(event, yaml.StreamEndEvent):
            _refuse(_line(event), "", "a second document starts here (`---`); a file holds one arm")
        return tree

    def node(self, event: Any, field: str, depth: int) -> Node:
        line = _line(event)
        if isinstance(event, yaml.AliasEvent):
            return self.alias(event.anchor, line, field)
        if event.tag is not None:
            _refuse(line, field, f"tags such as `{_tag(event.tag)}` are not read; leave it out")
        if depth > MAX_NESTING:
            _refuse(line, field, f"lists and mappings are nested deeper than {MAX_NESTING} levels")
        if event.anchor is not None:
            self.anchors[event.anchor] = None
        node: Node
        if isinstance(event, yaml.ScalarEvent):
            node = Scalar(event.value, self.kind(event), line)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self.list(line, field, depth)
        else:
            node = self.table(line, field, depth)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def alias(self, name: str | None, line: int, field: str) -> Node:
        if name is None or name not in self.anchors:
            _refuse(line, field, f"`*{name}` repeats `&{name}`, which is not above it in the file")
        node = self.anchors[name]
        if node is None:
            _refuse(line, field, f"`*{name}` stands inside of `&{name}` itself")
        return node

    def kind(self, event: yaml.ScalarEvent) -> str:
        tag = self.resolver.resolve(yaml.ScalarNode, event.value, event.implicit)
        return str(tag).rpartition(":")[2]

    def list(self, line: int, field: str, depth: int) -> List:
        node = List(line)
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            if len(node) == MAX_ITEMS:
                _refuse(
                    line,
                    field,
                    f"a list of more than {MAX_ITEMS} entries; an arm has 1 to {MAX_ITEMS} links",
                )
            item = self.node(event, f"{field}[{len(node) + 1}]", depth + 1)
            node.append(item)
            self.grow(node, item, field)
        return node

    def table(self, line: int, field: str, depth: int) -> Table:
        node = Table(line)
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            key, key_line = self.key(event, field)
            value = self.node(next(self.events), _dotted(field, key), depth + 1)
            self.grow(node, value, field)
            if key in node:
                first = node.lines[key]
                self.problems.append(
                    Problem(key_line, _dotted(field, key), f"given twice; first in line {first}")
                )
                continue
            node[key] = value
            node.lines[key] = key_line
        return node

    def key(self, event: Any, field: str) -> tuple[str, int]:
        line = _line(event)
        if not isinstance(event, yaml.ScalarEvent) or event.tag is not None:
            _refuse(line, field, "a key is a plain name, followed by `:` and its value")
        if len(event.value) > MAX_KEY:
            _refuse(line, field, f"a key of more than {MAX_KEY} characters")
        if event.value == "<<":
            _refuse(line, field, "`<<` (merging) is not read; write the fields out")
        return event.value, line

    def grow(self, node: Table | List, part: Node, field: str) -> None:
        node.size += part.size
        if node.size > MAX_VALUES:
            _refuse(
                node.line,
                field,
                f"more than {MAX_VALUES} values, those that aliases (`*name`) repeat counted each"
                f" time; an arm has at most {MAX_ITEMS} links",
            )


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1


def _tag(tag: str) -> str:
    return tag.replace("tag:yaml.org,2002:", "!!")


#: what the parser says, and what it most often means in a robot file
_HINTS = [
    (r"'\\t'", "a tab; indent with spaces"),
    (
        r"mapping values are not allowed",
        "a `:` too many, or a line not indented like those above",
    ),
    (r"found '[])}]'", "a closing bracket without an opening one"),
    (r"expected <block end>", "this line is not indented like those above it"),
    (r"unexpected end of stream", "a quoted text is not closed"),
    (r"expected ',' or '\]'", "a list is not closed with `]`"),
    (r"expected ',' or '}'", "a mapping in braces is not closed with `}`"),
    (r"could not find expected ':'", "a line that is neither `key: value` nor the entry of a list"),
    (r"cannot start any token", "a value that starts like this needs quotes"),
]


def _explained(error: Exception, text: str) -> Problem:
    """Return what the YAML parser complains of, in the words of someone who types a robot file."""
    if isinstance(error, yaml.reader.ReaderError):
        line = text.count("\n", 0, error.position) + 1
        return Problem(line, "", f"not YAML: the character {_code(error.character)} is not text")
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    if mark is None:  # an escape beyond Unicode, "\\UFFFFFFFF", comes out as a bare ValueError
        return Problem(None, "", f"not YAML: {error}")
    said = str(getattr(error, "problem", error))
    if re.search("mapping values|could not find", said) and (glued := _glued(text, mark.line)):
        line, key = glued
        return Problem(line, "", f"not YAML: a space is missing after `{key}`")
    hint = next((hint for pattern, hint in _HINTS if re.search(pattern, said)), "")
    message = f"not YAML: {hint} ({said})" if hint else f"not YAML: {said}"
    start = getattr(error, "context_mark", None)
    if start is not None and start.line < mark.line:
        message += f"; look from line {start.line + 1} on"
    return Problem(mark.line + 1, "", message)


def _glued(text: str, line: int) -> tuple[int, str] | None:
    """Find `mass:1.5`, which makes a text of the line: the parser complains one line later."""
    lines = text.splitlines()
    for number in range(max(line - 1, 0), min(line + 1, len(lines))):
        if match := re.match(r"\s*(?:- +)?([A-Za-z_]+:)[^\s:]", lines[number]):
            return number + 1, match[1]
    return None


def _code(character: object) -> str:
    return f"U+{character:04X}" if isinstance(character, int) else repr(character)
