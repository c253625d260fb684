"""Functions at a named frame: "jacobian@camera" is the Jacobian of the frame called camera."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from moro.checks.frame_called import frame_called
from moro.model import Model
from moro_codegen.functions.arguments import LAST, Argument
from moro_codegen.functions.catalogue import FUNCTIONS
from moro_codegen.functions.function import Function
from moro_codegen.functions.system import System
from moro_codegen.graph.nodes import Node


def at_frame(function: Function, name: str, model: Model) -> Function:
    """Return the function of a frame at another one than the last, jacobian_camera.

    It is that of the arm whose last frame this is. Raises ValueError for a function that is of no
    frame, a frame that the model does not have, or one whose name makes no identifier.
    """
    if function.frame is None:
        there = ", ".join(one.name for one in FUNCTIONS.values() if one.frame is not None)
        raise ValueError(f"{function.name}@{name}: {function.name} is of no frame; {there} are")
    frame_called(model, name)
    identifier = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
    if not identifier:
        raise ValueError(
            f"{function.name}@{name}: the frame's name has no letter or digit (of A-Z, a-z, 0-9), "
            "so it cannot be part of a function's"
        )

    def build(system: System, *given: Sequence[Node]) -> Sequence[Sequence[Node]]:
        return function.build(_ending_at(system, name), *given)

    def said(text: str) -> str:
        return text.replace(LAST, f"frame {name}")

    def described(arguments: Sequence[Argument]) -> tuple[Argument, ...]:
        return tuple(replace(a, description=said(a.description)) for a in arguments)

    return replace(
        function,
        name=f"{function.name}_{identifier}",
        inputs=described(function.inputs),
        outputs=described(function.outputs),
        summary=said(function.summary),
        build=build,
        algorithm=said(function.algorithm),
        frame=name,
        kind=function.name,
    )


def _ending_at(system: System, name: str) -> System:
    """Return the system whose last frame is the one of this name."""

    def ending(model: Model) -> Model:
        return replace(model, frames=(*model.frames, frame_called(model, name)))

    forms = system.forms and system.forms.of(ending(system.forms.model))
    return replace(system, model=ending(system.model), forms=forms)
