"""A routine of the graph as a list of statements, for any language with infix arithmetic.

What the languages share is decided here once: the names, the order, and which nodes are written
inside the expression that uses them. A node that is used once is; its rounding does not depend on
it, because every operation of the graph is printed with its own parentheses where needed.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from moro_codegen.functions.arguments import Argument
    from moro_codegen.graph.nodes import Node
    from moro_codegen.program import Program, Routine

#: an expression longer than this gets a name of its own
WIDTH = 76

#: rounded to float, it and what is larger would be infinite
FLOAT_OVERFLOW = 2.0**128 - 2.0**103

#: sums of angles are rounded like their addends: larger ones than this go without whole turns
FAR = {"double": 1e3, "float": 32.0}

_SYMBOLS = {"add": ("+", 1), "sub": ("-", 1), "mul": ("*", 2), "div": ("/", 2)}
_NEGATION, _ATOM = 3, 4


class Text(NamedTuple):
    """An expression as printed, with how tightly its outermost operation binds."""

    text: str
    binds: int = _ATOM

    def within(self, binds: int) -> str:
        """Return the text as an operand of an operation that binds that tightly."""
        return self.text if self.binds >= binds else f"({self.text})"


@dataclass(frozen=True)
class Load:
    """``name`` is component ``index`` of the input argument ``argument``."""

    name: str
    argument: str
    index: int


@dataclass(frozen=True)
class Assign:
    """``name = expression``."""

    name: str
    expression: str


@dataclass(frozen=True)
class Sines:
    """Sines and cosines of several independent angles: of ``angles[k]``, ``pairs[k]``.

    A sine or cosine that nobody reads has no name (""). ``arrays`` are three names, free for the
    arrays of angles, sines and cosines.
    """

    angles: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...]
    arrays: tuple[str, str, str]


@dataclass(frozen=True)
class ReduceAngles:
    """``names[k]`` is the angle ``angles[k]``, by whole turns nearer to 0 if it is far from it.

    So that a sum of large angles is not rounded coarsely. ``array`` is a free name.
    """

    names: tuple[str, ...]
    angles: tuple[str, ...]
    array: str


@dataclass(frozen=True)
class Call:
    """``name = function(arguments)``, the function being ``sign`` or one of C's <math.h>."""

    name: str
    function: str
    arguments: tuple[str, ...]


Statement = Load | Assign | ReduceAngles | Sines | Call


class Identifiers:
    """Hands out identifiers, each once."""

    def __init__(self, reserved: Iterable[str]) -> None:
        self._taken = set(reserved)

    def take(self, wish: str) -> str:
        """Return the wish made an identifier, with underscores added until it is new."""
        name = re.sub(r"\W", "_", wish, flags=re.ASCII).strip("_") or "x"
        if name[0].isdigit():
            name = "x" + name
        while name in self._taken:
            name += "_"
        self._taken.add(name)
        return name


@dataclass(frozen=True)
class RoutineBody:
    """The statements of a routine, and the expression of each result, in order."""

    statements: tuple[Statement, ...]
    results: tuple[str, ...]
    #: hands out names that no statement has
    names: Identifiers = field(default_factory=lambda: Identifiers(()), compare=False)


def body(
    program: Program,
    routine: Routine,
    reserved: Iterable[str],
    suffix: str = "",
) -> RoutineBody:
    """Return the routine's statements.

    ``reserved`` are names that the language keeps to itself, ``suffix`` follows its constants.
    Large angles that are added to others are brought near 0 first.
    """
    return _Writer(program, routine, reserved, suffix).body()


def literal(value: object, suffix: str = "") -> str:
    """Return the shortest decimal that reads back as the double nearest to an exact value.

    With the suffix "f" of C's float, as the float nearest to it.
    """
    number = float(value)  # type: ignore[arg-type]
    if suffix == "f" and abs(number) < FLOAT_OVERFLOW:
        return f"{np.float32(number)!s}f"
    if suffix == "f" or not math.isfinite(number):
        raise ValueError(f"a constant of the kernel is not finite: {value}")
    return repr(number)


def component(argument: Argument, index: int) -> str:
    """Return the name of a component, counted from 1: q3, M12."""
    sizes = argument.sizes
    if not sizes:
        return argument.name
    places = []
    for n in reversed(sizes):
        index, place = divmod(index, n)
        places.append(place + 1)
    return argument.name + ("" if max(sizes) < 10 else "_").join(map(str, reversed(places)))


@dataclass
class _Writer:
    program: Program
    routine: Routine
    reserved: Iterable[str]
    suffix: str = ""
    statements: list[Statement] = field(default_factory=list)
    texts: dict[Node, Text] = field(default_factory=dict)
    pairs: dict[Node, tuple[str, str]] = field(default_factory=dict)
    temporaries: int = 0

    def __post_init__(self) -> None:
        routine = self.routine
        self.names = Identifiers(self.reserved)
        self.uses = Counter(a for node in routine.schedule for a in node.args)
        self.uses.update(routine.results)
        self.turns = {(n.op, n.args[0]) for n in routine.schedule if n.op in ("sin", "cos")}
        self.result_names = self._result_names()
        self.inputs = self._input_names()

    def body(self) -> RoutineBody:
        """Write the angles, their sines and cosines, then everything else in order."""
        self._load_inputs()
        leading = self._needed_for(self.routine.angles)
        inputs = self._reduce_angles(leading)
        again = self._read_otherwise(leading) if inputs else set()
        named = self.result_names
        self.result_names = {node: name for node, name in named.items() if node not in again}
        for node in self.routine.schedule:
            if node in leading:
                self._write(node)
        angles = [inputs.get(x, self._text(x)).text for x in self.routine.angles]
        self.result_names = named
        self.texts.update(inputs)
        self._write_sines(self.routine.angles, angles)
        for node in self.routine.schedule:
            if node not in leading or node in again:
                self._write(node)
        results = tuple(self._text(node).text for node in self.routine.results)
        return RoutineBody(tuple(self.statements), results, self.names)

    # -- names -----------------------------------------------------------------------------------

    def _input_names(self) -> dict[tuple[str, int], str]:
        """Name what is read: joint variables by their index, parameters by their own names."""
        names = {}
        for argument in self.routine.inputs:
            for k in range(argument.size):
                names[argument.name, k] = self.names.take(component(argument, k))
        for k, parameter in enumerate(self.program.parameters):
            names["parameters", k] = self.names.take(parameter.name)
        return names

    def _result_names(self) -> dict[Node, str]:
        """Name the nodes that are results; the first one that a node serves as names it."""
        names: dict[Node, str] = {}
        results = iter(self.routine.results)
        for argument in self.routine.outputs:
            self.names.take(argument.name)
            for k in range(argument.size):
                node = next(results)
                if node.op not in ("const", "input", "sin", "cos") and node not in names:
                    names[node] = self.names.take(component(argument, k))
        return names

    def _pair_names(self, angle: Node) -> tuple[str, str]:
        """Name sine and cosine of q2 s2, c2, of q2 + q3 s23, c23, of q2 - q3 s2m3, c2m3."""
        suffix = self._joints(angle) or f"_{len(self.pairs) + 1}"
        return (
            self.names.take("s" + suffix) if ("sin", angle) in self.turns else "",
            self.names.take("c" + suffix) if ("cos", angle) in self.turns else "",
        )

    def _joints(self, angle: Node) -> str:
        if angle.op == "input" and angle.value[0] == "q":
            return str(angle.value[1] + 1)
        if angle.op in ("add", "sub"):
            left, right = map(self._joints, angle.args)
            if left and right:
                separator = "m" if angle.op == "sub" else "" if self.program.dof < 10 else "_"
                return left + separator + right
        return ""

    def _temporary(self) -> str:
        self.temporaries += 1
        return self.names.take(f"t{self.temporaries}")

    # -- statements ------------------------------------------------------------------------------

    def _load_inputs(self) -> None:
        used = {a for node in self.routine.schedule for a in node.args} | set(self.routine.results)
        read = {node.value: node for node in used if node.op == "input"}
        for key, name in self.inputs.items():
            if key in read:
                self.statements.append(Load(name, *key))
                self.texts[read[key]] = Text(name)

    def _needed_for(self, angles: Sequence[Node]) -> set[Node]:
        """Return the operations that lead to the angles."""
        needed: set[Node] = set()
        stack = list(angles)
        while stack:
            node = stack.pop()
            if node not in needed and node.op not in ("const", "input"):
                needed.add(node)
                stack.extend(node.args)
        return needed

    def _reduce_angles(self, leading: set[Node]) -> dict[Node, Text]:
        """Reduce the inputs that are summed to angles, if angles are nothing but such sums.

        sin(a + b) = sin((a - 2 pi k) + b), but the double nearest to a + b is off by up to half a
        unit in its last place, 6e-11 at a million radians, and that of the small sum is not. The
        sum is another number then, so only sines and cosines may be made of it.

        Return the texts of the inputs as they are, for whatever else they are used in.
        """
        if any(node.op not in ("add", "sub", "neg") for node in leading):
            return {}
        summed = dict.fromkeys(
            a for n in self.routine.schedule if n in leading for a in n.args if a.op == "input"
        )
        if not summed:
            return {}
        untouched = {node: self.texts[node] for node in summed}
        angles = tuple(text.text for text in untouched.values())
        names = tuple(self.names.take(f"{angle}_turned") for angle in angles)
        self.statements.append(ReduceAngles(names, angles, self.names.take("turned")))
        self.texts.update((node, Text(name)) for node, name in zip(summed, names, strict=True))
        return untouched

    def _read_otherwise(self, leading: set[Node]) -> set[Node]:
        """Return the sums of angles that something else is made of too, and what they consist of.

        They are written once more, with the inputs as they are.
        """
        periodic = Counter(
            a
            for node in self.routine.schedule
            if node in leading or node.op in ("sin", "cos")
            for a in node.args
        )
        return self._needed_for([x for x in leading if self.uses[x] > periodic[x]])

    def _write_sines(self, angles: Sequence[Node], texts: Sequence[str]) -> None:
        if angles:
            for angle in angles:
                self.pairs[angle] = self._pair_names(angle)
            pairs = tuple(self.pairs[angle] for angle in angles)
            take = self.names.take
            arrays = take("angle"), take("sine"), take("cosine")
            self.statements.append(Sines(tuple(texts), pairs, arrays))

    def _write(self, node: Node) -> None:
        if node.op in ("sin", "cos"):
            (angle,) = node.args
            if angle not in self.pairs:
                self._write_sines([angle], [self._text(angle).text])
            self.texts[node] = Text(self.pairs[angle][node.op == "cos"])
        elif node.op in ("sign", "call"):
            function = "sign" if node.op == "sign" else node.value
            arguments = tuple(self._name(a) for a in node.args)
            name = self.result_names.get(node) or self._temporary()
            self.statements.append(Call(name, function, arguments))
            self.texts[node] = Text(name)
        else:
            self.texts[node] = self._expression(node)
            if self.uses[node] > 1 or node in self.result_names:
                self._name(node)

    def _expression(self, node: Node) -> Text:
        """Print an operation; the longest operand gets a name if the line would be too long."""
        while True:
            text = self._infix(node)
            written_out = [a for a in node.args if self._text(a).binds < _ATOM]
            if len(text.text) <= WIDTH or not written_out:
                return text
            self._name(max(written_out, key=lambda a: len(self._text(a).text)))

    def _infix(self, node: Node) -> Text:
        if node.op == "neg":
            return Text("-" + self._text(node.args[0]).within(_NEGATION + 1), _NEGATION)
        symbol, binds = _SYMBOLS[node.op]
        left, right = map(self._text, node.args)
        return Text(f"{left.within(binds)} {symbol} {right.within(binds + 1)}", binds)

    def _text(self, node: Node) -> Text:
        if node.op == "const":
            text = literal(node.value, self.suffix)
            return Text(text, _NEGATION if text.startswith("-") else _ATOM)
        return self.texts[node]

    def _name(self, node: Node) -> str:
        """Give the node's value a name, unless what is printed for it is one already."""
        text = self._text(node)
        if text.binds < _ATOM and node.op != "const":
            name = self.result_names.get(node) or self._temporary()
            self.statements.append(Assign(name, text.text))
            self.texts[node] = text = Text(name)
        return text.text
