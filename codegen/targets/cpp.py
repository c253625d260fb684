"""C++17: a header over the functions in C, with arrays, spans and Eigen's matrices."""

from __future__ import annotations

import math
from typing import Any

from moro_codegen.backends import c_text
from moro_codegen.emit.describe import operations, wrapped
from moro_codegen.emit.escape import printable
from moro_codegen.emit.render import render
from moro_codegen.emit.statements import Identifiers, literal
from moro_codegen.functions.arguments import Argument
from moro_codegen.signature import Signature
from moro_codegen.targets import Export, Target
from moro_codegen.targets.c import described, files, limits

#: words of C++ that C does not have, and what the header calls something itself
WORDS = frozenset(
    """
    alignas alignof and and_eq bitand bitor catch class co_await co_return co_yield compl concept
    const_cast consteval constexpr constinit decltype delete dynamic_cast explicit export friend
    mutable namespace new noexcept not not_eq operator or or_eq private protected public
    reinterpret_cast requires static_assert static_cast template this thread_local throw try typeid
    typename using virtual xor xor_eq char8_t char16_t char32_t
    std Eigen Real In Out Vector Matrix eigen parameter n fault version model joint_names q_min
    q_max default_parameters result
    """.split()  # noqa: SIM905
)


class Cpp(Target):
    """The folder of the target ``c``, with a header of C++."""

    name = "cpp"
    reserved = c_text.RESERVED | WORDS

    def files(self, export: Export) -> dict[str, str]:
        """Return those of C, and the header. Raise ValueError for what can name no namespace."""
        if export.name in self.reserved:
            raise ValueError(
                f"a namespace of C++ cannot be called {export.name!r}: give another prefix="
            )
        signatures = [g.signature for g in export.golden.functions]
        name, holes, f = export.name, described(export), c_text.suffix(export.program)
        low, high = limits(export)
        defaults = [p.default for p in export.program.parameters]
        header = render(
            "export_kernel.hpp.jinja",
            **{**holes, "functions": [_function(export, s) for s in signatures]},
            members=_members(export),
            low=[_number(x, f) for x in low],
            high=[_number(x, f) for x in high],
            defaults=[_number(math.nan if x is None else x, f) for x in defaults],
        )
        return {**files(export, cpp=True), f"{name}.hpp": header}


def _number(value: float, f: str) -> str:
    """Return a number as a constant expression of C++."""
    if math.isfinite(value):
        return literal(value, f)
    what = "quiet_NaN" if math.isnan(value) else "infinity"
    return f"{'-' * (value < 0)}std::numeric_limits<Real>::{what}()"


def _members(export: Export) -> list[str]:
    """Return identifiers for the places of the run-time parameters."""
    identifiers = Identifiers(c_text.RESERVED | WORDS)
    return [identifiers.take(p.name) for p in export.program.parameters]


def _function(export: Export, s: Signature) -> dict[str, Any]:
    """Return what the header says of a function."""
    defaults = all(p.default is not None for p in s.parameters)
    names = Identifiers((c_text.RESERVED | WORDS | {s.name}) - {"parameters"})
    inputs, outputs = ([_argument(a, names) for a in x] for x in (s.inputs, s.outputs))
    for a in inputs:
        a["default"] = a["text"] == "parameters" and defaults
    return {
        "name": s.name,
        "symbol": f"{export.name}_{s.name}",
        "summary": wrapped(s.summary),
        "inputs": inputs,
        "outputs": outputs,
        "operations": operations(s),
    }


def _argument(a: Argument, names: Identifiers) -> dict[str, Any]:
    sizes = a.sizes
    types = {0: "Real", 1: f"Vector<{a.size}>", 2: f"Matrix<{', '.join(map(str, sizes))}>"}
    return {
        "text": printable(a.name),
        "name": names.take(a.name),
        "type": types[len(sizes)],
        "size": a.size,
        "scalar": not sizes,
        "unit": printable(a.unit),
        "description": printable(a.description),
    }


TARGET = Cpp()
