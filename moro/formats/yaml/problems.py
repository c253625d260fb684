"""What pydantic found wrong with a robot file, in words, with lines and fields."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from pydantic import ValidationError

from moro.checks.meant import elsewhere
from moro.formats.errors import Problem, nearest
from moro.formats.yaml.document import Scalar, Table, place
from moro.formats.yaml.schema import model_at
from moro.formats.yaml.values import found

#: in a file, counted from 0
Location = tuple[int | str, ...]


def problems(
    errors: ValidationError | None, between: Iterable[tuple[Location, str]], tree: Table
) -> Iterator[Problem]:
    """Put what is wrong with ``tree`` in words.

    ``between`` is what is wrong with fields together: that one is missing is not said where it is
    there, but misspelled.
    """
    details = errors.errors() if errors else []
    typos: set[Location] = set()
    for detail in sorted(details, key=lambda detail: detail["type"] == "missing"):
        location = tuple(step for step in detail["loc"] if step != "[key]")
        kind = detail["type"]
        if kind == "extra_forbidden":
            known = model_at(location).model_fields
            hint = nearest(str(location[-1]), known)
            typos |= {(*location[:-1], name) for name in known if f"`{name}`" in hint}
            advice = elsewhere(str(location[-1]))
            message = f"unknown field{hint or '; ' + (advice or 'known are ' + ', '.join(known))}"
            if comma := _decimal_comma(tree, location):
                location, message = comma
        elif kind == "missing":
            if location in typos:
                continue
            message = missing(location)
        elif kind == "model_type":
            fields = model_at((*location, "")).model_fields
            message = f"found {found(detail['input'])}; expected a mapping: {', '.join(fields)}"
        elif kind == "dict_type":
            message = f"found {found(detail['input'])}; expected a mapping: `name: default value`"
        elif kind == "tuple_type":
            message = f"found {found(detail['input'])}; expected a list of mappings"
        else:
            message = detail["msg"]
        yield Problem(*place(tree, location), message)
    for location, message in between:
        if location not in typos:
            yield Problem(*place(tree, location), message)


def missing(location: Location) -> str:
    """Say that a field is missing, and what it is."""
    field = model_at(location).model_fields[str(location[-1])]
    return f"missing; expected {field.description}"


def _decimal_comma(tree: Table, location: Location) -> tuple[Location, str] | None:
    """Find `{a: 1,5}`, in which 5 is a field without a value; return where it is, and what."""
    table: Any = tree
    for step in location[:-1]:
        inside = step in table if isinstance(table, Table) else isinstance(step, int)
        table = table[step] if inside else table  # a form of several is no step in the tree
    fields = list(table)
    field = str(location[-1])
    before = fields[fields.index(field) - 1] if field in fields else field
    whole = table.get(before)
    if not (field.isdigit() and isinstance(whole, Scalar) and whole.text.lstrip("+-").isdigit()):
        return None
    number = f"{whole.text}.{field}"
    return (*location[:-1], before), f"`{whole.text},{field}` has a decimal comma; write `{number}`"
