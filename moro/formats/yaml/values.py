"""What a value of a robot file may be: one validator for each kind.

Validators read the nodes of ``document.py``, or Python's values in them, and return exact SymPy
values. What they refuse comes back from pydantic with its location.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NoReturn

import sympy
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    PlainValidator,
    Tag,
    ValidationInfo,
    WrapValidator,
)
from pydantic_core import PydanticCustomError

from moro.abc import joint_variable
from moro.checks import values as checks
from moro.checks.tensors import FORMS
from moro.formats import names
from moro.formats.dh.rows import read_convention
from moro.formats.errors import nearest
from moro.formats.yaml.document import List, Scalar, Table
from moro.formats.yaml.expressions import JOINT_VARIABLE, RESERVED, ExpressionError, parse, quoted


@dataclass(frozen=True)
class Context:
    """What a validator needs to know of the rest of the file."""

    #: the declared parameters
    symbols: dict[str, sympy.Symbol]
    #: the joint variables that there can be, q1 and q_1 of the first
    coordinates: dict[str, Any]

    @classmethod
    def of(cls, tree: Table) -> Context:
        """Look through ``tree``, which may still hold anything."""
        declared, links = tree.get("parameters"), tree.get("links")
        names = declared if isinstance(declared, Table) else ()
        count = len(links) if isinstance(links, List) else 0
        variables = {f"q{i}": joint_variable(i) for i in range(1, count + 1)}
        return cls(
            {name: sympy.Symbol(name) for name in names},
            variables | {f"q_{name[1:]}": q for name, q in variables.items()},
        )


def _context(info: ValidationInfo) -> Context:
    if not isinstance(info.context, Context):
        raise TypeError("validate with context=Context.of(tree)")
    return info.context


def refuse(message: str) -> NoReturn:
    """Refuse a value; pydantic says where it is."""
    raise PydanticCustomError("refused", "{message}", {"message": message})


def is_null(node: object) -> bool:
    """Whether a node says that there is nothing, by `~` or `null`."""
    return isinstance(node, Scalar) and node.kind == "null" and bool(node.text)


def found(node: object) -> str:
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
    return _checked(checks.constant, _expression(node, _context(info).symbols, checks.scalar))


def _angle(node: object, info: ValidationInfo) -> Any:
    return _checked(checks.constant, _expression(node, _context(info).symbols, checks.angle))


def _displacement(node: object, info: ValidationInfo) -> Any:
    """Read an expression that may hold joint variables too."""
    context = _context(info)
    return _expression(node, context.symbols | context.coordinates, checks.angle)


def _expression(node: object, names: Mapping[str, Any], read: Callable[..., Any]) -> Any:
    if not isinstance(node, Scalar) or node.kind in ("null", "bool"):
        refuse(f"found {found(node)}; expected a number or an expression")
    if node.value is not None:
        return _checked(read, node.value)
    try:
        return parse(node.text, names)
    except ExpressionError as error:
        refuse(str(error))


def _checked(check: Callable[..., Any], value: Any) -> Any:
    """Return what a check of moro's makes of a value; the place says what the value is of."""
    try:
        return check(value, "")
    except (TypeError, ValueError) as error:
        refuse(str(error).strip())


def _must(check: Callable[..., Any]) -> AfterValidator:
    return AfterValidator(lambda value: _checked(check, value))


Number = Annotated[Any, PlainValidator(_number)]
Angle = Annotated[Any, PlainValidator(_angle)]
#: with joint variables, where it is how far a joint has moved
Displacement = Annotated[Any, PlainValidator(_displacement)]
NotNegative = Annotated[Number, _must(checks.not_negative)]
Positive = Annotated[NotNegative, _must(checks.not_zero)]
NotZero = Annotated[Number, _must(checks.not_zero)]

# --- lists of numbers ----------------------------------------------------------------------------


def _listed(node: object, counts: tuple[int, ...], expected: str) -> List:
    """Return ``node`` if it is a list with one of the ``counts`` of entries."""
    if not isinstance(node, List):
        refuse(f"found {found(node)}; expected {expected}")
    if len(node) in counts:
        return node
    only = node[0] if len(node) == 1 else None
    if isinstance(only, Scalar) and len(only.text.split()) in counts:
        refuse(f"found `[{only.text}]`; separate the values by commas, [{_commas(only.text)}]")
    refuse(f"found {found(node)}; expected {expected}")


def _commas(text: str) -> str:
    return ", ".join(text.split())


def _vector(expected: str, of: Any = Number) -> Any:
    return Annotated[tuple[of, ...], BeforeValidator(lambda node: _listed(node, (3,), expected))]


def _or_none(vector: Any) -> Any:
    """Return a validator of vectors that takes `~`, not set, for None."""
    return Annotated[
        vector, WrapValidator(lambda node, read: None if is_null(node) else read(node))
    ]


Position = _vector("[x, y, z] in m, in the frame of the link")
FirstMoment = _vector("[m x, m y, m z] in kg m, in the frame of the link")
Acceleration = _or_none(_vector("[x, y, z] in m/s^2, in the base frame, such as [0, 0, -9.81]"))
Shift = _vector("[x, y, z] in m, in the frame of the parent")
Angles = _vector("[roll, pitch, yaw] in rad: turns about the parent's x, y and z axes", of=Angle)

#: how the axes of a frame are called
_AXES = {
    f"{sign}{axis}": tuple(sympy.Integer(int(sign + "1") * (axis == x)) for x in "xyz")
    for sign in ("", "+", "-")
    for axis in "xyz"
}


def _axis_shape(node: object) -> object:
    expected = "[x, y, z], or `x`, `y`, `z`, `-x`, ..: the joint's axis in the frame of the link"
    if isinstance(node, Scalar) and (axis := _AXES.get(node.text.lower())):
        entries = List(node.line)
        entries.extend(Scalar(str(x), "int", node.line) for x in axis)
        return entries
    return _listed(node, (3,), expected)


Axis = Annotated[tuple[Number, ...], BeforeValidator(_axis_shape), _must(checks.direction)]


def _rows_shape(node: object) -> List:
    expected = "3 rows of 3, the axes of the frame as columns"
    for row in _listed(node, (3,), expected):
        _listed(row, (3,), expected)
    return node  # type: ignore[return-value]


Rotation = Annotated[
    tuple[tuple[Number, ...], ...], BeforeValidator(_rows_shape), _must(checks.rotation)
]


def _tensor_shape(node: object) -> List | Table:
    expected = f"{FORMS}, or 3 rows of 3, in kg m^2"
    if isinstance(node, Table):
        return node
    rows = _listed(node, (3, 6), expected)
    nested = [isinstance(row, List) for row in rows]
    if any(nested) and not (len(rows) == 3 and all(nested)):
        refuse(f"found a list that mixes rows and numbers; expected {expected}")
    for row in rows:
        if isinstance(row, List) and len(row) != 3:
            refuse(f"found a row that is {found(row)}; expected {expected}")
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


def _both_ways(node: object) -> List:
    if isinstance(node, Scalar):
        both = List(node.line)
        both.extend([node, node])
        return both
    return _listed(node, (2,), "one value, or [for qd > 0, for qd < 0], neither of them negative")


Coulomb = Annotated[tuple[NotNegative, ...], BeforeValidator(_both_ways)]

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
        refuse(f"found {found(node)}; expected {expected}{hint}")

    return PlainValidator(choose)


#: what is read as a joint type
JOINT_TYPES = ("revolute", "prismatic", "helical", "rotor", "fixed")

JointType = Annotated[
    Literal["revolute", "prismatic", "helical", "rotor", "fixed"],
    _choice(
        *JOINT_TYPES,
        read={"r": "revolute", "p": "prismatic"} | {word: word for word in JOINT_TYPES},
        also={
            "rotational": "write `revolute`",
            "continuous": "write `revolute` and leave out the limits",
            "linear": "write `prismatic`",
            "screw": "write `helical`, with its `pitch`",
            "motor": "write `rotor`, on the link that carries it",
            "flywheel": "write `rotor`",
        },
    ),
]
Side = Annotated[
    Literal["link", "motor"],
    _choice("link", "motor", read={"link": "link", "motor": "motor"}, also={}),
]
About = Annotated[
    Literal["com", "origin"],
    _choice("com", "origin", read={"com": "com", "origin": "origin"}, also={}),
]
Convention = Annotated[
    Literal["dh", "mdh"],
    PlainValidator(
        lambda node: _checked(
            read_convention, node.text if isinstance(node, Scalar) else found(node)
        )
    ),
]


def _text(node: object) -> str:
    if not isinstance(node, Scalar) or node.kind in ("null", "bool"):
        refuse(f"found {found(node)}; expected a name")
    return node.text


def _name(node: object) -> str:
    text = _text(node)
    if reason := names.fault(text):
        refuse(
            f"{quoted(text)} {reason}; files and functions of generated code have this name:"
            f" use `{names.identifier(text)}`"
        )
    return text


#: characters of the name of a link, a frame or a joint
MAX_LABEL = 100


def _label(node: object) -> str:
    """Read the name of a link, a frame or a joint: any text, but no number."""
    text = _text(node)
    if not text.strip() or not text.isprintable():
        refuse("expected a name")
    if text.isdigit():
        refuse(f"{quoted(text)} is a number, which joints have in their order; expected a name")
    if len(text) > MAX_LABEL:
        refuse(f"a name of {len(text)} characters; it has at most {MAX_LABEL}")
    return text


def _label_key(text: str) -> str:
    return _label(Scalar(text, "str", 1))


def _coordinate(text: str) -> int:
    """Read q1, q_1, .. as the number of the coordinate."""
    if not re.fullmatch(r"q_?[1-9][0-9]{0,3}", text):
        refuse(f"{quoted(text)} is no joint variable; expected `q1`, `q2`, ..")
    return int(text.removeprefix("q").removeprefix("_"))


def _parameter_name(name: str, info: ValidationInfo) -> sympy.Symbol:
    if reason := names.fault(name):
        refuse(f"{quoted(name)} {reason}; use `{names.identifier(name, prefix='p')}`")
    if name in RESERVED or JOINT_VARIABLE.fullmatch(name):
        meaning = {"pi": "the number pi", "t": "time"}.get(
            name, "a function" if name in RESERVED else "a joint variable"
        )
        refuse(f"`{name}` stands for {meaning}; give the parameter another name")
    return _context(info).symbols[name]


def _default(node: object, info: ValidationInfo) -> Any:
    if isinstance(node, Scalar) and node.kind == "null":
        return None
    return _checked(checks.number, _number(node, info))


Name = Annotated[str, PlainValidator(_name)]
#: of a link, a frame or a joint
Label = Annotated[str, PlainValidator(_label)]
LabelKey = Annotated[str, PlainValidator(_label_key)]
#: of a link, by its name or by its number
Reference = Annotated[str, PlainValidator(_text)]
CoordinateKey = Annotated[int, PlainValidator(_coordinate)]
ParameterKey = Annotated[Any, PlainValidator(_parameter_name)]
Default = Annotated[Any, PlainValidator(_default)]
