"""The quick way into a function: one state, as arrays that need no checks."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any

import numpy as np

from moro_codegen.emit.describe import shape

if TYPE_CHECKING:
    from moro_codegen.signature import Signature


def quick(
    direct: Callable[..., Any], general: Callable[..., Any], signature: Signature
) -> Callable[..., Any]:
    """Return ``general``, but arrays of float64 for one state go straight to ``direct``.

    ``direct`` takes the inputs and, if there are any, the run-time parameters; it gives the calls
    back by raising ZeroDivisionError.
    """
    cores = [shape(a) for a in signature.given]
    defaults = [parameter.default for parameter in signature.parameters]
    constants = [np.array(defaults, dtype=float)] if defaults and None not in defaults else []
    if len(constants) < bool(defaults):
        return general

    @wraps(general)
    def function(*args: Any, **keywords: Any) -> Any:
        if keywords or len(args) != len(cores):
            return general(*args, **keywords)
        for x, core in zip(args, cores, strict=True):
            if type(x) is not np.ndarray or x.shape != core or x.dtype != np.float64:
                return general(*args)
        try:
            return direct(*args, *constants)
        except ZeroDivisionError:
            return general(*args)

    return function
