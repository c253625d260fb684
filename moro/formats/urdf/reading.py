"""Reads elements and attributes, and keeps what is wrong and what is to be said."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import sympy as sp

from moro.checks import meant
from moro.formats import decimals
from moro.formats.errors import Problem, nearest
from moro.formats.xml import Element
from moro.spatial.vectors import Vector

_T = TypeVar("_T")

#: attributes that are read, which are no slips for others
_KEYS = (
    *("name", "type", "link", "joint", "xyz", "rpy", "value", "lower", "upper", "multiplier"),
    *("offset", "ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
)


@dataclass
class Reading:
    """Everything here returns None where there is a problem, after keeping that.

    ``of`` says of what an element is: "joint shoulder".
    """

    as_written: bool = False
    problems: list[Problem] = field(default_factory=list)
    #: legal, and probably not meant
    remarks: list[Problem] = field(default_factory=list)
    #: decimals, and what they were read as
    meant: dict[str, str] = field(default_factory=dict)

    def problem(self, element: Element, key: str, of: str, message: str) -> None:
        """Keep a problem with an element or its attribute ``key``."""
        self.problems.append(Problem(element.line, _place(element.tag, key, of), message))

    def remark(self, element: Element, key: str, of: str, message: str) -> None:
        """Keep what was probably not meant."""
        self.remarks.append(Problem(element.line, _place(element.tag, key, of), message))

    # -- elements ---------------------------------------------------------------------------------

    def only(self, element: Element, tag: str, of: str) -> Element | None:
        """Return the one child of a tag, if there is any; a second one is a problem."""
        found = [*element.all(tag)]
        for other in found[1:]:
            self.problem(other, "", of, f"is there twice: the first is in line {found[0].line}")
        return found[0] if found else None

    def needed(self, element: Element, tag: str, of: str) -> Element | None:
        """Return the one child of a tag."""
        found = self.only(element, tag, of)
        if found is None:
            self.problem(element, "", of, f"there is no <{tag}> in it")
        return found

    def passes_over(
        self, element: Element, of: str, read: Collection[str], known: Collection[str] = ()
    ) -> None:
        """Remark on children and attributes that are not read and are near to what is."""
        for child in element.children:
            if child.tag not in (*read, *known) and (near := nearest(child.tag, read)):
                self.remark(child, "", of, f"is passed over{near}")

    def knows(self, element: Element, of: str, keys: Collection[str]) -> None:
        """Remark on attributes that are near to what is read."""
        for key in element.attributes:
            if key not in keys and (near := nearest(key, keys)):
                self.remark(element, key, of, f"is passed over{near}")

    # -- attributes -------------------------------------------------------------------------------

    def text(self, element: Element, key: str, of: str) -> str | None:
        """Return an attribute that is not empty."""
        text = element.attributes.get(key)
        if text is None:
            self.missing(element, key, of)
        elif not text.strip():
            self.problem(element, key, of, "is empty")
            return None
        return text

    def missing(self, element: Element, key: str, of: str) -> None:
        """Keep that there is no such attribute."""
        near = meant.nearest(key, (x for x in element.attributes if x not in _KEYS))
        self.problem(element, key, of, "is missing" + (f"; there is `{near}`" if near else ""))

    def number(
        self, element: Element, key: str, of: str, default: Any = None, *, least: Any = None
    ) -> Any | None:
        """Return a number, not below ``least``, or the default where there is none."""
        text = element.attributes.get(key)
        if text is None:
            if default is None:
                self.missing(element, key, of)
            return default
        found = self._found(decimals.number(text), element, key, of)
        if found is not None and least is not None and found.value < least:
            self.problem(element, key, of, f"must not be negative, not {short(found.value)}")
            return None
        return None if found is None else found.value

    def vector(self, element: Element, key: str, of: str) -> list[decimals.Number] | None:
        """Return three decimals; zeros where there are none."""
        text = element.attributes.get(key, "0 0 0")
        return self._found(decimals.numbers(text, 3), element, key, of)

    def length(self, x: decimals.Number) -> Any:
        """Return a length; what computing has left of a zero is 0."""
        exact, is_said = (x.value, False) if self.as_written else decimals.meant_zero(x.value)
        if is_said:
            self.meant[x.text] = "0"
        return exact

    def entries(self, numbers: Sequence[Any]) -> list[Any]:
        """Return the entries of a tensor; what is nothing beside the largest is 0."""
        largest = max(map(abs, numbers))
        meant = [decimals.meant_zero(x, largest) for x in numbers]
        if self.as_written or not any(is_said for _, is_said in meant):
            return [*numbers]
        self.meant["entries of tensors below 1e-10 of the largest"] = "0"
        return [exact for exact, _ in meant]

    def angle(self, x: decimals.Number) -> Any:
        """Return the angle that a decimal means."""
        exact, is_said = decimals.angle(x, self.as_written)
        if is_said:
            self.meant[x.text] = str(exact)
        return exact

    def direction(self, element: Element, key: str, of: str) -> Vector | None:
        """Return a direction, of any length."""
        if key not in element.attributes:
            self.missing(element, key, of)
            return None
        found = self.vector(element, key, of)
        if found is None:
            return None
        if not any(x.value for x in found):
            self.problem(element, key, of, "0 0 0 is no direction")
            return None
        (x, y, z), is_said = decimals.direction(found, self.as_written)
        if is_said:
            self.meant[" ".join(each.text for each in found)] = f"({x}, {y}, {z})"
        return sp.sympify(x), sp.sympify(y), sp.sympify(z)

    def _found(self, found: _T | str, element: Element, key: str, of: str) -> _T | None:
        if isinstance(found, str):
            self.problem(element, key, of, found)
            return None
        return found


def _place(tag: str, key: str, of: str) -> str:
    return f"<{tag}{' ' * bool(key)}{key}>{' of ' * bool(of)}{of}"


def short(x: Any) -> str:
    """Return a number as a message shows it."""
    return f"{float(x):.6g}"
