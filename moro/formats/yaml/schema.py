"""What a robot file may say: one class for each mapping, one validator for each kind of value.

Validators read the nodes of ``document.py`` and return exact SymPy values. What they refuse comes
back from pydantic with its location; ``problems`` puts that in words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NoReturn

import sympy
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationError,
    ValidationInfo,
    field_validator,
)
from pydantic_core import PydanticCustomError

from moro.checks import values as checks
from moro.checks.meant import elsewhere
from moro.checks.tensors import FORMS
from moro.formats import names
from moro.formats.dh.rows import read_convention
from moro.formats.errors import Problem, nearest
from moro.formats.yaml.document import MAX_ITEMS, List, Scalar, Table, place
from moro.formats.yaml.expressions import JOINT_VARIABLE, RESERVED, ExpressionError, parse, quoted

MAX_LINKS = MAX_ITEMS

DYNAMIC_FIELDS = ("mass", "com", "inertia")


@dataclass(frozen=True)
class Context:
    """What a validator needs to know of the rest of the file."""

    #: the declared parameters
    symbols: dict[str, sympy.Symbol]
    #: whether any link has a mass, a centre of mass or an inertia: then all of them need all three
    dynamic: bool

    @classmethod
    def of(cls, tree: Table) -> Context:
        """Look through ``tree``, which may still hold anything."""
        declared = tree.get("parameters")
        links = tree.get("links")
        return cls(
            symbols={
                name: sympy.Symbol(name)
                for name in (declared if isinstance(declared, Table) else ())
            },
            dynamic=any(
                field in link
                for link in (links if isinstance(links, List) else ())
                if isinstance(link, Table)
                for field in DYNAMIC_FIELDS
            ),
        )


def _context(info: ValidationInfo) -> Context:
    if not isinstance(info.context, Context):
        raise TypeError("validate with context=Context.of(tree)")
    return info.context


def _refuse(message: str) -> NoReturn:
    raise PydanticCustomError("refused", "{message}", {"message": message})


def _found(node: object) -> str:
    """Say what a node is, for a message that goes on with what was expected."""
    if isinstance(node, List):
        return f"a list of {len(node)} value{'s' * (len(node) != 1)}"
    if isinstance(node, Table):
        return "a mapping"
    if isinstance(node, Scalar) and node.kind == "null":
        return "nothing" if not node.text.strip("~") else quoted(node.text)
    if isinstance(node, Scalar) and node.kind == "bool":
        return f"`{node.text}`, which YAML takes for a truth value"
    return quoted(node.text) if isinstance(node, Scalar) else repr(node)


# --- numbers -------------------------------------------------------------------------------------


def _number(node: object, info: ValidationInfo) -> Any:
    """Read an expression over numbers, pi and the declared parameters."""
    if not isinstance(node, Scalar) or node.kind in ("null", "bool"):
        _refuse(f"found {_found(node)}; expected a number or an expression")
    try:
        return parse(node.text, _context(info).symbols)
    except ExpressionError as error:
        _refuse(str(error))


def _checked(check: Callable[..., Any], value: Any) -> Any:
    """Return what a check of moro's makes of a value; the place says what the value is of."""
    try:
        return check(value, "")
    except (TypeError, ValueError) as error:
        _refuse(str(error).strip())


def _must(check: Callable[..., Any]) -> AfterValidator:
    return AfterValidator(lambda value: _checked(check, value))


Number = Annotated[Any, PlainValidator(_number)]
NotNegative = Annotated[Number, _must(checks.not_negative)]

# --- lists of numbers ----------------------------------------------------------------------------


def _listed(node: object, counts: tuple[int, ...], expected: str) -> List:
    """Return ``node`` if it is a list with one of the ``counts`` of entries."""
    if not isinstance(node, List):
        _refuse(f"found {_found(node)}; expected {expected}")
    if len(node) in counts:
        return node
    only = node[0] if len(node) == 1 else None
    if isinstance(only, Scalar) and len(only.text.split()) in counts:
        _refuse(f"found `[{only.text}]`; separate the values by commas, [{_commas(only.text)}]")
    _refuse(f"found {_found(node)}; expected {expected}")


def _commas(text: str) -> str:
    return ", ".join(text.split())


def _vector(expected: str) -> BeforeValidator:
    return BeforeValidator(lambda node: _listed(node, (3,), expected))


Position = Annotated[tuple[Number, ...], _vector("[x, y, z] in m, in the frame of the link")]
Acceleration = Annotated[
    tuple[Number, ...],
    _vector("[x, y, z] in m/s^2, in the base frame, such as [0, 0, -9.81]"),
]


def _tensor_shape(node: object) -> List | Table:
    expected = f"{FORMS}, or 3 rows of 3, in kg m^2, about the centre of mass"
    if isinstance(node, Table):
        return node
    rows = _listed(node, (3, 6), expected)
    nested = [isinstance(row, List) for row in rows]
    if any(nested) and not (len(rows) == 3 and all(nested)):
        _refuse(f"found a list that mixes rows and numbers; expected {expected}")
    for row in rows:
        if isinstance(row, List) and len(row) != 3:
            _refuse(f"found a row that is {_found(row)}; expected {expected}")
    return rows


def _form(node: Any) -> str:
    if isinstance(node, Table):
        return "named"
    return "rows" if isinstance(node[0], List) else "values"


Tensor = Annotated[
    Annotated[tuple[Number, ...], Tag("values")]
    | Annotated[tuple[tuple[Number, ...], ...], Tag("rows")]
    | Annotated[dict[str, Number], Tag("named")],
    Discriminator(_form),
    BeforeValidator(_tensor_shape),
    _must(checks.tensor),
]


def _range_shape(node: object) -> List:
    return _listed(node, (2,), "[lower, upper] in rad or m")


Range = Annotated[tuple[Number, ...], BeforeValidator(_range_shape), _must(checks.limits)]


def _coulomb_shape(node: object) -> List:
    if isinstance(node, Scalar):
        both = List(node.line)
        both.extend([node, node])
        return both
    return _listed(node, (2,), "one value, or [for qd > 0, for qd < 0], neither of them negative")


Coulomb = Annotated[tuple[NotNegative, ...], BeforeValidator(_coulomb_shape)]

# --- words ---------------------------------------------------------------------------------------


def _choice(*words: str, read: Mapping[str, str], also: Mapping[str, str]) -> PlainValidator:
    """One of ``words``, as ``read`` from what people write, in capitals too.

    ``also`` maps what they write instead to what to say about it.
    """

    def choose(node: object) -> str:
        text = node.text.lower() if isinstance(node, Scalar) else ""
        if text in read:
            return read[text]
        hint = f"; {also[text]}" if text in also else nearest(text, words)
        expected = " or ".join(f"`{word}`" for word in words)
        _refuse(f"found {_found(node)}; expected {expected}{hint}")

    return PlainValidator(choose)


#: what is read as a joint type
JOINT_TYPES = {"r": "revolute", "p": "prismatic", "revolute": "revolute", "prismatic": "prismatic"}

JointType = Annotated[
    Literal["revolute", "prismatic"],
    _choice(
        "revolute",
        "prismatic",
        read=JOINT_TYPES,
        also={
            "rotational": "write `revolute`",
            "continuous": "write `revolute` and leave out the limits",
            "linear": "write `prismatic`",
            "fixed": "a link that does not move is part of the link before it: put the product"
            " of both rows in one, and both bodies",
        },
    ),
]
Convention = Annotated[
    Literal["dh", "mdh"],
    PlainValidator(
        lambda node: _checked(
            read_convention, node.text if isinstance(node, Scalar) else _found(node)
        )
    ),
]


def _name(node: object) -> str:
    if not isinstance(node, Scalar) or node.kind in ("null", "bool"):
        _refuse(f"found {_found(node)}; expected a name")
    if reason := names.fault(node.text):
        _refuse(
            f"{quoted(node.text)} {reason}; files and functions of generated code have this name:"
            f" use `{names.identifier(node.text)}`"
        )
    return node.text


def _parameter_name(name: str, info: ValidationInfo) -> sympy.Symbol:
    if reason := names.fault(name):
        _refuse(f"{quoted(name)} {reason}; use `{names.identifier(name, prefix='p')}`")
    if name in RESERVED or JOINT_VARIABLE.fullmatch(name):
        meaning = {"pi": "the number pi", "t": "time"}.get(
            name, "a function" if name in RESERVED else "a joint variable"
        )
        _refuse(f"`{name}` stands for {meaning}; give the parameter another name")
    return _context(info).symbols[name]


def _default(node: object, info: ValidationInfo) -> Any:
    if isinstance(node, Scalar) and node.kind == "null":
        return None
    return _checked(checks.number, _number(node, info))


# --- mappings ------------------------------------------------------------------------------------


class _Mapping(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class Friction(_Mapping):
    """Friction of a joint, link side: ``viscous * qd``, and ``coulomb`` against the motion."""

    viscous: NotNegative = sympy.Integer(0)
    #: for qd > 0 and for qd < 0, both as magnitudes
    coulomb: Coulomb = (sympy.Integer(0), sympy.Integer(0))


_ALL_OR_NONE = "; leave out mass, com and inertia for all links or for none"


class Link(_Mapping):
    """A joint and the link that it moves: a row of DH parameters, and a body."""

    joint: JointType = Field(description="`revolute` or `prismatic`")
    a: Number = Field(description="the length along x, in m")
    alpha: Number = Field(description="the angle about x, in rad")
    d: Number = Field(description="the length along z, in m (prismatic: the offset added to q)")
    theta: Number = Field(description="the angle about z, in rad (revolute: the offset added to q)")
    mass: NotNegative | None = Field(
        default=None, validate_default=True, description="the mass, in kg" + _ALL_OR_NONE
    )
    com: Position | None = Field(
        default=None,
        validate_default=True,
        description="the centre of mass [x, y, z], in m, in the frame of the link" + _ALL_OR_NONE,
    )
    inertia: Tensor | None = Field(
        default=None,
        validate_default=True,
        description="the inertia, in kg m^2, about the centre of mass, in the axes of the link's"
        " frame" + _ALL_OR_NONE,
    )
    rotor_inertia: NotNegative | None = None
    friction: Friction | None = None
    limits: Range | None = None

    @field_validator(*DYNAMIC_FIELDS, mode="before")
    @classmethod
    def _all_or_none(cls, node: object, info: ValidationInfo) -> object:
        if node is None and _context(info).dynamic:
            raise PydanticCustomError("missing", "missing")
        return node


def _links_shape(node: object) -> List:
    if not isinstance(node, List):
        _refuse(f"found {_found(node)}; expected a list with one entry (`- joint: ...`) per joint")
    if not node:
        _refuse(f"no links; an arm has 1 to {MAX_LINKS}")
    return node


class RobotFile(_Mapping):
    """An arm as its file describes it, in exact numbers and SymPy symbols."""

    name: Annotated[str, PlainValidator(_name)] = Field(description="a name for generated code")
    convention: Convention = "dh"
    gravity: Acceleration = (sympy.Integer(0), sympy.Integer(0), sympy.Rational("-9.81"))
    #: symbol: default value, None where the value is given at run time only
    parameters: dict[
        Annotated[Any, PlainValidator(_parameter_name)], Annotated[Any, PlainValidator(_default)]
    ] = {}
    links: Annotated[tuple[Link, ...], BeforeValidator(_links_shape)] = Field(
        description="a list with one entry (`- joint: ...`) per joint"
    )


# --- from pydantic's errors to problems ----------------------------------------------------------


def problems(error: ValidationError, tree: Table) -> Iterator[Problem]:
    """Put what pydantic found wrong with ``tree`` in words, with lines and fields."""
    typos: set[tuple[Any, ...]] = set()  # missing fields that are there, but misspelled
    for detail in sorted(error.errors(), key=lambda detail: detail["type"] == "missing"):
        location = tuple(step for step in detail["loc"] if step != "[key]")
        kind = detail["type"]
        if kind == "extra_forbidden":
            known = _model(location).model_fields
            hint = nearest(str(location[-1]), known)
            typos |= {(*location[:-1], name) for name in known if f"`{name}`" in hint}
            advice = elsewhere(str(location[-1]))
            message = f"unknown field{hint or '; ' + (advice or 'known are ' + ', '.join(known))}"
            if comma := _decimal_comma(tree, location):
                location, message = comma
        elif kind == "missing":
            if location in typos:
                continue
            field = _model(location).model_fields[str(location[-1])]
            message = f"missing; expected {field.description}"
        elif kind == "model_type":
            fields = _model((*location, "")).model_fields
            message = f"found {_found(detail['input'])}; expected a mapping: {', '.join(fields)}"
        elif kind == "dict_type":
            message = f"found {_found(detail['input'])}; expected a mapping: `name: default value`"
        else:
            message = detail["msg"]
        yield Problem(*place(tree, location), message)


def _decimal_comma(tree: Table, location: tuple[Any, ...]) -> tuple[tuple[Any, ...], str] | None:
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


def _model(location: tuple[Any, ...]) -> type[BaseModel]:
    """Return the class of the mapping that the field at ``location`` is in."""
    if location[0] == "links" and len(location) > 2:
        return Friction if len(location) > 3 and location[2] == "friction" else Link
    return RobotFile
