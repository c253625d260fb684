"""``from moro.core import Robot``, as programs for another package called moro have it."""

from moro.robot import Robot

__all__ = ["Robot"]
