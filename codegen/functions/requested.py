"""What ``functions=`` may ask for, brought to one form: the functions to generate, each once."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TypeAlias

from moro.checks.meant import hint
from moro.model import Model
from moro_codegen.functions.at_frame import at_frame
from moro_codegen.functions.catalogue import FUNCTIONS, KNOWN
from moro_codegen.functions.function import Function
from moro_codegen.functions.own import UserFunction
from moro_codegen.functions.regressors import KINDS, Regressor
from moro_codegen.functions.together import together

#: a name of KNOWN or one at a frame ("jacobian@camera"), the regressor with a choice, a function of
#: one's own, or any that is ready
One: TypeAlias = str | Regressor | UserFunction | Function
#: one of these, or a tuple of several to be computed together
Request: TypeAlias = One | tuple[One, ...]

#: the C functions made of a function f are called f, f_batch, f_part_1 and so on
DERIVED = re.compile(r"(.+?)(_batch|_loop|_lanes|(_lanes)?_part_\d+)")


def requested(functions: Sequence[Request], model: Model) -> tuple[Function, ...]:
    """Return the functions asked for, ready for a model.

    Raises ValueError for a name that does not exist or is asked for twice; TypeError for what is no
    request.
    """
    if isinstance(functions, str):
        raise TypeError(f"functions is a tuple of names: functions=({functions!r},)")
    found = [_requested(item, model) for item in functions]
    own = [item.name for item in _flat(functions) if isinstance(item, UserFunction)]
    for name in own:
        if name in KNOWN:
            raise ValueError(f"a function cannot be named {name!r}: that is one of moro's own")
    at_frames = [part.name for function in found for part in function.parts if part.frame]
    names = [function.name for function in found]
    for name in (*own, *at_frames):
        derived = DERIVED.fullmatch(name)
        if derived and derived[1] in names:
            raise ValueError(f"a function cannot be named {name!r}: that belongs to {derived[1]}")
    for name in names:
        if names.count(name) > 1:
            asked = dict.fromkeys(one.request for one in found if one.name == name)
            which = f": {' and '.join(asked)}" if len(asked) > 1 else ""
            raise ValueError(f"two functions are called {name}{which}")
    if not found:
        raise ValueError(f"no functions: there are {', '.join(KNOWN)}")
    return tuple(found)


def named(name: str, model: Model) -> Function:
    """Return the function of a name, or of one at a frame: jacobian, jacobian@camera.

    Raises ValueError, with the nearest name, if there is none.
    """
    name, at, frame = name.partition("@")
    if name not in KNOWN:
        raise ValueError(f"no function {name!r}; {hint(name, KNOWN)}there are {', '.join(KNOWN)}")
    if at:
        return at_frame(KNOWN[name], frame, model)
    return FUNCTIONS[name] if name in FUNCTIONS else _regressor(name).entry(model)


def _regressor(name: str) -> Regressor:
    """Return the request for a regressor that the catalogue names."""
    of = {kind.function.name: of for of, kind in KINDS.items()}
    return Regressor(of=of[name]) if name in of else Regressor(standard=True)


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
