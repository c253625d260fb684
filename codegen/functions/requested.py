"""What ``functions=`` may ask for, brought to one form: the functions to generate, each once."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TypeAlias

from moro.checks.meant import hint
from moro.model import Model
from moro_codegen.functions.base_regressor import Regressor
from moro_codegen.functions.catalogue import FUNCTIONS, KNOWN, REGRESSOR, Function
from moro_codegen.functions.own import UserFunction
from moro_codegen.functions.together import together

#: a name of KNOWN, the regressor with a choice, a function of one's own, or any that is ready
One: TypeAlias = str | Regressor | UserFunction | Function
#: one of these, or a tuple of several to be computed together
Request: TypeAlias = One | tuple[One, ...]

#: the C functions made of a function f are called f, f_batch, f_1 and so on
DERIVED = re.compile(r"(.+?)(_batch|_loop|_lanes|_\d+|_lanes_\d+)")


def requested(functions: Sequence[Request], model: Model) -> tuple[Function, ...]:
    """Return the functions asked for, ready for a model.

    Raises ValueError for a name that does not exist or is asked for twice; TypeError for what is no
    request.
    """
    if isinstance(functions, str):
        raise TypeError(f"functions is a tuple of names: functions=({functions!r},)")
    found = [_requested(item, model) for item in functions]
    own = [item for item in _flat(functions) if isinstance(item, UserFunction)]
    names = [function.name for function in found]
    for name in (function.name for function in own):
        derived = DERIVED.fullmatch(name)
        if name in KNOWN:
            raise ValueError(f"a function cannot be named {name!r}: that is one of moro's own")
        if derived and derived[1] in names:
            raise ValueError(f"a function cannot be named {name!r}: that belongs to {derived[1]}")
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two functions are called {name}")
    if not found:
        raise ValueError(f"no functions: there are {', '.join(KNOWN)}")
    return tuple(found)


def named(name: str, model: Model) -> Function:
    """Return the function of a name. Raise ValueError, with the nearest name, if there is none."""
    if name not in KNOWN:
        raise ValueError(f"no function {name!r}; {hint(name, KNOWN)}there are {', '.join(KNOWN)}")
    return Regressor().entry(model) if name == REGRESSOR.name else FUNCTIONS[name]


def _requested(item: Request, model: Model) -> Function:
    if isinstance(item, str):
        return named(item, model)
    if isinstance(item, Function):
        return item
    if isinstance(item, (Regressor, UserFunction)):
        return item.entry(model)
    if isinstance(item, tuple):
        return together([_requested(one, model) for one in item])
    raise TypeError(
        f"functions are names, moro_codegen.Function(name, expression), "
        f"moro_codegen.Regressor(zeros=...), or tuples of them, not {item!r}"
    )


def _flat(functions: Sequence[Request]) -> list[object]:
    return [one for item in functions for one in (item if isinstance(item, tuple) else (item,))]
