"""XML as elements with their lines.

The parser is that of Python's own library (expat), which fetches nothing. Document type
declarations, with which entities are made (a billion laughs, files of others), are refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from moro.formats.errors import Problem

#: bytes of a file; a humanoid's takes some 200 kB
MAX_SIZE = 20_000_000
#: elements in elements
_MAX_DEPTH = 100


class DocumentError(ValueError):
    """A text that is no XML of ours."""

    def __init__(self, line: int | None, message: str) -> None:
        super().__init__(message)
        self.problem = Problem(line, "", message)


@dataclass
class Element:
    """An element of an XML document."""

    tag: str
    attributes: dict[str, str]
    #: where it begins, from 1
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the children of a tag."""
        return (child for child in self.children if child.tag == tag)

    def walk(self) -> Iterator[Element]:
        """Yield the element and all in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed(element.children)


def parse(data: bytes) -> Element:
    """Return the root element. Raises DocumentError with the line."""
    if not data.strip():
        raise DocumentError(None, "the file is empty")
    parser = expat.ParserCreate()
    parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
    top: list[Element] = []
    inside: list[Element] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, parser.CurrentLineNumber)
        if len(inside) == _MAX_DEPTH:
            raise DocumentError(element.line, f"more than {_MAX_DEPTH} elements in one another")
        (inside[-1].children if inside else top).append(element)
        inside.append(element)

    def end(_: str) -> None:
        inside.pop()

    def doctype(*_: object) -> None:
        message = "a document type (<!DOCTYPE ...>) is not read: entities may hide anything"
        raise DocumentError(parser.CurrentLineNumber, message)

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, str(error))
        raise DocumentError(error.lineno, f"not XML: {reason}{_open(inside)}") from None
    except (LookupError, ValueError) as error:
        if isinstance(error, DocumentError):
            raise
        raise DocumentError(1, f"not XML: {error}") from None  # an encoding that is none
    return top[0]


def _open(inside: list[Element]) -> str:
    """Say which element is open."""
    if not inside:
        return ""
    return f" (in <{inside[-1].tag}> of line {inside[-1].line})"
