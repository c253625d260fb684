"""A program as C99: one header, one source, nothing but <math.h>.

Every routine is written twice from the same statements, over ``double`` for one sample and over
vectors of the compiler for several samples side by side, so that both round alike.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from moro_codegen.backends import processors
from moro_codegen.emit.describe import argument_lines, conventions, operations, wrapped
from moro_codegen.emit.parts import Give, Keep, Parts, Step, Take, in_parts
from moro_codegen.emit.render import render
from moro_codegen.emit.statements import (
    FAR,
    Assign,
    Call,
    Identifiers,
    Load,
    ReduceAngles,
    RoutineBody,
    Sines,
    body,
    literal,
)
from moro_codegen.emit.words import MACROS, TYPES

if TYPE_CHECKING:
    from moro_codegen.functions.arguments import Argument
    from moro_codegen.program import Program, Routine
    from moro_codegen.signature import Signature

LINE = 100

#: the most bytes that arrays of vectors may take of the stack, where fewer lanes can see to that:
#: threads have 64 kB and less on small systems
STACK = 24 * 1024

#: registers of vectors, in bytes
REGISTERS = (64, 32, 16)

#: what is for LANES samples, and the beginnings of names for a certain number
LANE_NAMES = {
    "lanes": "pack", "lane_bits": "bits", "lane_memory": "memory", "EVEN": "EVEN_", "ODD": "ODD_",
    "EACH_LANE": "EACH_LANE_", "sign_lanes": "sign_pack", "sines_pack": "sines_pack",
    "sines_lanes": "sines_lanes_", "turn_lanes": "turn_lanes_", "load_any": "load_any_lanes_",
    "store_any": "store_any_lanes_", "load": "load_lanes_", "store": "store_lanes_",
}  # fmt: skip

#: what C, <math.h> and our own templates call something else
_WORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while asm typeof
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs
    fdim floor fma fmax fmin fmod frexp hypot ilogb j0 j1 jn ldexp lgamma log log10 log1p log2 logb
    modf nan pow remainder rint round scalbn signgam sin sinh sqrt tan tanh tgamma trunc y0 y1 yn
    gamma drem scalb significand without_turns FAR
    S1 S2 S3 S4 S5 S6 C1 C2 C3 C4 C5 C6 LANES REDUCIBLE SHUFFLE HELPER RARE PART TWO_OVER_PI ROUNDER
    SIGN_BIT ONE_BITS JOIN4 JOIN8 JOIN16 HALF_PI_1 HALF_PI_2 HALF_PI_3 HALF_PI_4
    FROM PAIR NAMED OF_LANES
    turned turn_far sign sines sines_of_large l parameters count
    """.split()  # noqa: SIM905
#: and what its headers do; sinf is the sine of a float
RESERVED = (
    MACROS
    | TYPES
    | {*_WORDS, *(f"{word}f" for word in _WORDS), *LANE_NAMES}
    | {f"{stem}{n}" for stem in LANE_NAMES.values() for n in (2, 4, 8, 16)}
)

#: what the templates say of a scalar type: angles to try the sines and cosines with, and how much
#: these may differ from libm's; for sines and cosines, pi/2 in parts, a number whose sum
#: with another rounds that to an integer and holds it in its lowest bits, minimax polynomials (for
#: double those of fdlibm)
SCALARS: dict[str, dict[str, Any]] = {
    "double": {
        "bits": 64,
        "widths": (8, 4, 2),
        "reducible": "1e5",
        "samples": (0.5, 2.0, -355.0, 11.0, 31415.9, -99999.5),
        "tolerance": 4 * 2.0**-52,
        "parts": "37, 37 and 53",
        "constants": {
            "TWO_OVER_PI": 2 / math.pi,
            "ROUNDER": 1.5 * 2.0**52,
            "HALF_PI_1": 1.5707963267923333,
            "HALF_PI_2": 2.5633441515839558e-12,
            "HALF_PI_3": 1.0562999066987428e-23,
            "S1": -1.66666666666666324348e-01,
            "S2": 8.33333333332248946124e-03,
            "S3": -1.98412698298579493134e-04,
            "S4": 2.75573137070700676789e-06,
            "S5": -2.50507602534068634195e-08,
            "S6": 1.58969099521155010221e-10,
            "C1": 4.16666666666666019037e-02,
            "C2": -1.38888888888741095749e-03,
            "C3": 2.48015872894767294178e-05,
            "C4": -2.75573143513906633035e-07,
            "C5": 2.08757232129817482790e-09,
            "C6": -1.13596475577881948265e-11,
        },
    },
    "float": {
        "bits": 32,
        "widths": (16, 8, 4),
        "reducible": "1e3f",
        "samples": (0.5, 2.0, -355.0, 11.0, 314.159, -999.5),
        "tolerance": 4 * 2.0**-23,
        "parts": "11, 11, 11 and 24",
        "constants": {
            "TWO_OVER_PI": 2 / math.pi,
            "ROUNDER": 1.5 * 2.0**23,
            "HALF_PI_1": 1.5703125,
            "HALF_PI_2": 0.0004837512969970703,
            "HALF_PI_3": 7.549533620476723e-08,
            "HALF_PI_4": 2.5633440682570896e-12,
            "S1": -0.16666655,
            "S2": 0.008332155,
            "S3": -0.00019514446,
            "C1": 0.041666646,
            "C2": -0.0013887308,
            "C3": 2.44322e-05,
        },
    },
}


def emit(program: Program, *, batch: bool = True) -> dict[str, str]:
    """Return the texts of ``<name>.c`` and ``<name>.h``, by file name.

    Without ``batch`` there are the functions for one sample only.
    """
    return {
        f"{program.name}.c": source(program, batch=batch),
        f"{program.name}.h": _header(program, batch),
    }


def source(program: Program, *, batch: bool = True, sincos: str = "", data: str = "") -> str:
    """Return the text of ``<name>.c``, which includes ``<name>.h``.

    Without ``batch`` there are the functions for one sample only. ``sincos`` is a macro that may
    name a function to compute sines and cosines with; ``data`` are definitions to be added.
    """
    scalar, f = SCALARS[program.scalar], suffix(program)
    widths = scalar["widths"] if batch else ()
    return render(
        "kernel.c.jinja",
        real=program.scalar,
        f=f,
        far=literal(FAR[program.scalar], f),
        sizes=sorted({2, 4, *widths}),
        batch=batch,
        lane_names=LANE_NAMES.items(),
        sincos=sincos,
        data=data,
        **{
            **scalar,
            "constants": [(name, literal(x, f)) for name, x in scalar["constants"].items()],
            "samples": [literal(angle, f) for angle in scalar["samples"]],
            "tolerance": literal(scalar["tolerance"], f),
        },
        x86=processors.X86,
        arm=processors.ARM,
        **described(program),
    )


def _header(program: Program, batch: bool) -> str:
    """Return the text of ``<name>.h``."""
    notes = [
        *conventions(program),
        "",
        "No allocation, no state, no locks: safe in real-time loops and several threads.",
    ]
    guard = f"{program.name.upper()}_H"
    return render("kernel.h.jinja", notes=notes, guard=guard, batch=batch, **described(program))


def described(program: Program) -> dict[str, Any]:
    """Return what sources and headers both say."""
    return {
        "title": f"{program.name}: dynamics of a robot arm with {program.dof} joints",
        "header": f"{program.name}.h",
        "routines": [_Emission(program, routine).holes() for routine in program.routines],
        "fault": f"const char *{program.name}_fault(void)",
    }


@dataclass(frozen=True)
class _Emission:
    """What the templates say of one routine."""

    program: Program
    routine: Routine

    def holes(self) -> dict[str, object]:
        """Return the texts that the templates ask for."""
        inputs, outputs = self.inputs, self.routine.outputs
        return {
            "name": self.name,
            "lanes_name": self.lanes_name,
            "lanes_prototype": self.lanes_prototype(self.lanes_name, ""),
            "lanes_room": self.lanes_room,
            "lanes_bytes": self.lanes_bytes,
            "operations": operations(self.routine),
            "notes": self.notes(),
            "batch_notes": self.batch_notes(),
            "signature": self.signature.core,
            "single": self.single(),
            "batch": self.batch(),
            "loop": self.loop(),
            "scalar_parts": self.scalar_parts(),
            "scalar_body": self.scalar_body(),
            "lanes_parts": self.lanes_parts(),
            "lanes_body": self.lanes_body(),
            "loads_size": sum(a.size for a in inputs),
            "stores_size": sum(a.size for a in outputs),
            "loads": self.transfers("load", "x", inputs),
            "stores": self.transfers("store", "y", outputs),
            "plain_loads": [f"{local} = {place};" for local, place in self.places("x", inputs)],
            "plain_stores": [f"{place} = {local};" for local, place in self.places("y", outputs)],
            "plain_call": self.plain_call(),
            "loop_body": self.loop_body(),
            **self.local,
        }

    @cached_property
    def local(self) -> dict[str, str]:
        """Names for the functions' own variables, where no argument has them."""
        arguments = (*self.inputs, *self.routine.outputs)
        names = Identifiers([*RESERVED, *(a.name for a in arguments)])
        return {wish: names.take(wish) for wish in ("x", "y", "w", "k", "all", "left")}

    @property
    def name(self) -> str:
        return f"{self.program.name}_{self.routine.function.name}"

    @property
    def lanes_name(self) -> str:
        return f"{self.name}_lanes"

    @property
    def real(self) -> str:
        """The scalar type: double or float."""
        return self.program.scalar

    @cached_property
    def signature(self) -> Signature:
        return self.program.signature(self.routine)

    @property
    def inputs(self) -> tuple[Argument, ...]:
        return self.signature.inputs

    # -- prototypes ------------------------------------------------------------------------------

    def single(self) -> str:
        """``void puma560_tau(const double q[6], ..., double tau[6])``."""
        parameters = [f"const {self.real} {declarator(a)}" for a in self.inputs]
        parameters += [f"{self.real} {declarator(a)}" for a in self.routine.outputs]
        return prototype(self.name, parameters)

    def batch(self) -> str:
        """``void puma560_tau_batch(size_t count, const double *q, ptrdiff_t q_stride, ...)``."""
        parameters = ["size_t count"]
        for arguments, type_ in (
            (self.inputs, f"const {self.real}"),
            (self.routine.outputs, self.real),
        ):
            for a in arguments:
                strides = [f"ptrdiff_t {stride}" for stride in stride_names(a)]
                parameters.append(", ".join([f"{type_} *{a.name}", *strides]))
        return prototype(f"{self.name}_batch", parameters)

    def loop(self) -> str:
        """``void puma560_tau_loop(char **args, ...)``: NumPy's PyUFuncGenericFunction."""
        return prototype(
            f"{self.name}_loop",
            [
                "char **args",
                "const ptrdiff_t *dimensions",
                "const ptrdiff_t *strides",
                "void *data",
            ],
        )

    # -- comments of the header ------------------------------------------------------------------

    def notes(self) -> list[str]:
        """Say what the function computes and what its arguments are."""
        return [
            *wrapped(self.routine.function.summary),
            "",
            *argument_lines([*self.inputs, *self.routine.outputs]),
            "",
            *wrapped(
                "All inputs are read before any result is written, so a result may share memory "
                f"with an input. Takes {operations(self.routine)}."
            ),
        ]

    def batch_notes(self) -> list[str]:
        """Say what strides are, and what may overlap."""
        names = [name for a in (*self.inputs, *self.routine.outputs) for name in stride_names(a)]
        steps = [name for name in names if not name.endswith("_stride")]
        return wrapped(
            "Strides count components and may be zero or negative: *_stride leads from sample to "
            f"sample, {', '.join(steps)} from component to component. An array of count rows, "
            "each the components of one sample, has the row's length as stride and 1 as step; an "
            "input with stride 0 is the same for all samples. Results must not overlap inputs."
        )

    # -- bodies ----------------------------------------------------------------------------------

    @cached_property
    def text(self) -> RoutineBody:
        """The statements, with names that neither C nor our own variables have."""
        arguments = (*self.inputs, *self.routine.outputs)
        own = (*self.local.values(), "x", "y", *(a.name for a in arguments))
        reserved = {*RESERVED, *own}
        return body(self.program, self.routine, reserved, suffix(self.program))

    @cached_property
    def parts(self) -> Parts:
        """The same, in parts that compilers can take."""
        return in_parts(self.text, [(a.name, a.size) for a in self.inputs])

    @property
    def is_divided(self) -> bool:
        return len(self.parts.steps) > 1

    @cached_property
    def stored(self) -> frozenset[int]:
        """The results that are known before the last part."""
        steps = itertools.chain(*self.parts.steps[:-1])
        return frozenset(step.index for step in steps if isinstance(step, Give))

    def scalar_parts(self) -> list[tuple[str, list[str]]]:
        """Return the parts over double but the last: prototype and lines."""
        arguments = [f"const {self.real} {declarator(a)}" for a in self.inputs]
        arguments.append(f"{self.real} *{self.local['w']}")
        return [
            (prototype(f"{self.name}_part_{k}", arguments, "PART"), self.scalar_lines(steps))
            for k, steps in enumerate(self.parts.steps[:-1], start=1)
        ]

    def scalar_body(self) -> list[str]:
        """Return the calls of the parts, and the last: all is read before results are written."""
        w, room = self.local["w"], self.parts.room
        lines, last = [], self.parts.steps[-1]
        if self.is_divided:
            lines.append(f"{self.real} {w}[{room + max(self.stored, default=-1) + 1}];")
            lines += self.calls(self.name, [*(a.name for a in self.inputs), w])
            last = tuple(step for step in last if not isinstance(step, Give))
        lines += self.scalar_lines(last, called=self.is_divided)
        targets = [
            f"{a.name}[{k}]" if a.shape else f"*{a.name}"
            for a in self.routine.outputs
            for k in range(a.size)
        ]
        values = (
            f"{w}[{room + k}]" if k in self.stored else x for k, x in enumerate(self.text.results)
        )
        return lines + [f"{to} = {x};" for to, x in zip(targets, values, strict=True)]

    def scalar_lines(self, steps: Iterable[Step], called: bool = False) -> list[str]:
        """Return the steps of a part; what is read by no step, nor handed on, is said so."""
        read = {s.argument for s in steps if isinstance(s, Load)}
        unused = () if called else (a.name for a in self.inputs if a.name not in read)
        lines = [f"(void){name};" for name in unused]
        for step in steps:
            lines += scalar_lines(
                step, self.inputs, self.local["w"], self.parts.room, self.program.scalar
            )
        return lines

    @property
    def lanes_room(self) -> int:
        """The vectors of x: inputs, and in their place what parts hand on."""
        return max(self.parts.room, sum(a.size for a in self.inputs))

    @property
    def lanes_bytes(self) -> int:
        """The largest registers to use: in long routines those that leave stack to others."""
        if not self.is_divided:
            return REGISTERS[0]
        vectors = self.lanes_room + sum(a.size for a in self.routine.outputs)
        return next((x for x in REGISTERS if vectors * x <= STACK), REGISTERS[-1])

    def lanes_prototype(self, name: str, kind: str) -> str:
        """Return the prototype of a function of x, all inputs, and y, all results."""
        x = "lanes *restrict" if self.is_divided else "const lanes *"
        y = "lanes *restrict" if self.is_divided else "lanes *"
        space = " " * self.is_divided
        return prototype(name, [f"{x}{space}x", f"{y}{space}y"], kind or "static")

    def lanes_parts(self) -> list[tuple[str, list[str]]]:
        """Return the parts over vectors but the last: prototype and lines.

        Values of which later parts know lie in x, where inputs are that nothing reads any more.
        """
        return [
            (self.lanes_prototype(f"{self.lanes_name}_part_{k}", "PART"), self.lanes_lines(steps))
            for k, steps in enumerate(self.parts.steps[:-1], start=1)
        ]

    def lanes_body(self) -> list[str]:
        """Return the calls of the parts, and the last one."""
        lines = self.calls(self.lanes_name, ["x", "y"]) if self.is_divided else []
        lines += self.lanes_lines(self.parts.steps[-1], called=self.is_divided)
        given = {s.index for steps in self.parts.steps for s in steps if isinstance(s, Give)}
        constant = [node.op == "const" for node in self.routine.results]
        return lines + [
            f"y[{k}] = {f'(lanes){{0}} + {x}' if constant[k] else x};"
            for k, x in enumerate(self.text.results)
            if k not in given
        ]

    def lanes_lines(self, steps: Sequence[Step], called: bool = False) -> list[str]:
        """Return the steps of a part over vectors."""
        first = dict(zip((a.name for a in self.inputs), offsets(self.inputs), strict=True))
        lines = []
        if not called:
            if not any(isinstance(s, (Load, Take, Keep)) for s in steps):
                lines.append("(void)x;")
            if self.is_divided and not any(isinstance(s, Give) for s in steps):
                lines.append("(void)y;")
        for step in steps:
            lines += lanes_lines(step, first, suffix(self.program))
        return lines

    def calls(self, name: str, given: Iterable[str]) -> list[str]:
        """Return the calls of all parts but the last."""
        arguments = ", ".join(given)
        return [f"{name}_part_{k}({arguments});" for k in range(1, len(self.parts.steps))]

    # -- batches ---------------------------------------------------------------------------------

    def transfers(self, call: str, lanes: str, arguments: Sequence[Argument]) -> list[str]:
        """Move the samples from k on: vectors and scalars at once, matrices row by row."""
        lines = []
        lanes, k, left = (self.local[name] for name in (lanes, "k", "left"))
        for a, offset in zip(arguments, offsets(arguments), strict=True):
            stride, *axes = stride_names(a)
            *rows, columns = a.sizes or (1,)
            step = axes[-1] if axes else "1"
            for row, places in enumerate(itertools.product(*map(range, rows))):
                at = "".join(f" + {i} * {axis}" for i, axis in zip(places, axes, strict=False) if i)
                lines.append(
                    f"{call}({lanes} + {offset + row * columns}, {columns}, "
                    f"{a.name} + {k} * {stride}{at}, {stride}, {step}, {left});"
                )
        return lines

    def places(self, local: str, arguments: Sequence[Argument]) -> Iterator[tuple[str, str]]:
        """Pair every component's local copy with its place in sample k."""
        for a, offset in zip(arguments, offsets(arguments), strict=True):
            stride, *axes = stride_names(a)
            for j, indices in enumerate(itertools.product(*map(range, a.sizes))):
                at = "".join(f" + {i} * {axis}" for i, axis in zip(indices, axes, strict=True) if i)
                place = f"{a.name}[{self.local['k']} * {stride}{at}]"
                yield f"{self.local[local]}[{offset + j}]", place

    def plain_call(self) -> str:
        x, y = self.local["x"], self.local["y"]
        arguments = [f"{x} + {offset}" for offset in offsets(self.inputs)]
        arguments += [f"{y} + {offset}" for offset in offsets(self.routine.outputs)]
        return f"{self.name}({', '.join(arguments)})"

    def loop_body(self) -> list[str]:
        """Return the call of the batch function with NumPy's arguments.

        NumPy lists the strides from sample to sample of all arguments, then those of the axes.
        """
        arguments = [*self.inputs, *self.routine.outputs]
        axis = itertools.count(len(arguments))
        calls = ["(size_t)dimensions[0]"]
        for k, a in enumerate(arguments):
            type_ = f"const {self.real}" if k < len(self.inputs) else self.real
            strides = [f"strides[{i}] / size" for i in (k, *itertools.islice(axis, len(a.shape)))]
            calls.append(", ".join([f"({type_} *)(void *)args[{k}]", *strides]))
        return [
            f"const ptrdiff_t size = (ptrdiff_t)sizeof({self.real});",
            "(void)data;",
            f"{self.name}_batch(",
            *(f"    {call}," for call in calls[:-1]),
            f"    {calls[-1]});",
        ]


def scalar_lines(
    step: Step, inputs: Iterable[Argument], shared: str, room: int, real: str
) -> list[str]:
    """Return a step over double or float; ``shared`` is the array of the parts, then of results."""
    match step:
        case Take(name, place):
            return [f"const {real} {name} = {shared}[{place}];"]
        case Keep(name, place):
            return [f"{shared}[{place}] = {name};"]
        case Give(name, index):
            return [f"{shared}[{room + index}] = {name};"]
        case Load(name, argument, index):
            scalar = any(a.name == argument and not a.shape for a in inputs)
            return [
                f"const {real} {name} = {f'*{argument}' if scalar else f'{argument}[{index}]'};"
            ]
        case Assign(name, expression):
            return [f"const {real} {name} = {expression};"]
        case Call(name, function, arguments):
            called = c_name(function, "f" if real == "float" else "")
            return [f"const {real} {name} = {called}({', '.join(arguments)});"]
        case ReduceAngles(names, angles, _):
            return [
                f"const {real} {name} = turned({angle});"
                for name, angle in zip(names, angles, strict=True)
            ]
        case Sines(angles, pairs, (angle, sine, cosine)):
            n, room = len(angles), len(angles) + len(angles) % 2 + 2 * (len(angles) % 4 == 3)
            return [
                f"const {real} {angle}[{n}] = {{{', '.join(angles)}}};",
                f"{real} {sine}[{room}], {cosine}[{room}];",
                f"sines({n}, {angle}, {sine}, {cosine});",
                *named_pairs(real, pairs, sine, cosine),
            ]


def lanes_lines(step: Step, first: Mapping[str, int], f: str) -> list[str]:
    """Return a step over vectors; ``first`` says where in x an argument begins."""
    match step:
        case Take(name, place):
            return [f"const lanes {name} = x[{place}];"]
        case Keep(name, place):
            return [f"x[{place}] = {name};"]
        case Give(name, index):
            return [f"y[{index}] = {name};"]
        case Load(name, argument, index):
            return [f"const lanes {name} = x[{first[argument] + index}];"]
        case Assign(name, expression):
            return [f"const lanes {name} = {expression};"]
        case Call(name, "sign", (x,)):
            return [f"lanes {name};", f"sign_lanes(&{x}, &{name});"]
        case Call(name, function, arguments):
            # a constant argument has no lanes
            values = (a if a[0].isdigit() or a[0] == "-" else f"{a}[l]" for a in arguments)
            return [
                f"lanes {name} = {{0}};",
                "for (int l = 0; l < LANES; l++)",
                f"    {name}[l] = {c_name(function, f)}({', '.join(values)});",
            ]
        case ReduceAngles(names, angles, array):
            return [
                f"lanes {array}[{len(angles)}] = {{{', '.join(angles)}}};",
                f"turn_lanes({len(angles)}, {array});",
                *(f"const lanes {name} = {array}[{k}];" for k, name in enumerate(names)),
            ]
        case Sines(angles, pairs, (angle, sine, cosine)):
            n = len(angles)
            return [
                f"const lanes {angle}[{n}] = {{{', '.join(angles)}}};",
                f"lanes {sine}[{n}], {cosine}[{n}];",
                f"sines_lanes({n}, {angle}, {sine}, {cosine});",
                *named_pairs("lanes", pairs, sine, cosine),
            ]


def c_name(function: str, f: str) -> str:
    """Return what a function is called for the scalar type."""
    return function if function == "sign" else function + f


def suffix(program: Program) -> str:
    """Return what C adds to the numbers and functions of the scalar type."""
    return "f" if program.scalar == "float" else ""


def named_pairs(
    type_: str, pairs: Iterable[tuple[str, str]], sine: str, cosine: str
) -> Iterator[str]:
    """Give the sines and cosines that are used their names."""
    for k, (s, c) in enumerate(pairs):
        names = [f"{name} = {array}[{k}]" for name, array in ((s, sine), (c, cosine)) if name]
        yield f"const {type_} {', '.join(names)};"


def declarator(argument: Argument) -> str:
    """``q[6]``, ``M[36]``; a scalar is a pointer to one."""
    return f"{argument.name}[{argument.size}]" if argument.shape else f"*{argument.name}"


def stride_names(argument: Argument) -> list[str]:
    """Return names for the stride between samples and for those along the axes of one sample."""
    steps = {1: ["step"], 2: ["row_step", "column_step"]}
    axes = {0: [], **steps, 3: ["layer_step", *steps[2]]}[len(argument.shape)]
    return [f"{argument.name}_{axis}" for axis in ["stride", *axes]]


def offsets(arguments: Iterable[Argument]) -> list[int]:
    """Return where each argument begins if all are laid end to end."""
    return [0, *itertools.accumulate(a.size for a in arguments)][:-1]


def prototype(name: str, parameters: Sequence[str], kind: str = "") -> str:
    """Return a prototype, on one line if it fits."""
    start = f"{kind} void {name}(".lstrip()
    line = f"{start}{', '.join(parameters)})"
    if len(line) <= LINE:
        return line
    return f"{start}\n    " + ",\n    ".join(parameters) + ")"
