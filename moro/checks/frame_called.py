"""The frame of a model that a person means."""

from __future__ import annotations

from moro.checks.values import index, suggestion
from moro.model import Frame, Model, Placement

#: so many names are listed where there is none of the one given
_LISTED = 20


def frame_called(model: Model, i: int | str) -> Frame:
    """Return frame i: the one that is called so, or else that of joint i. 0 is the base.

    Raises ValueError, with the nearest name and what there is, for a name that no frame has;
    IndexError or TypeError for a number that counts none.
    """
    joints = {str(k): Frame(str(k), k - 1, Placement()) for k in range(len(model.joints) + 1)}
    named = {**joints, **{frame.name: frame for frame in model.frames}}
    if not isinstance(i, str):
        i = index(i, 0, len(model.joints), "frame")
        return named[str(i)] if i else joints["0"]
    if i in named:
        return named[i]
    names = [name for name in named if name not in joints]
    there = [*names[:_LISTED], *["..."] * (len(names) > _LISTED), f"0 to {len(model.joints)}"]
    raise ValueError(
        f"no frame is called {i!r}; there are {', '.join(there)}{suggestion(i, named)}"
    )
