from typing import Any

from sympy import Symbol

__all__: list[str]
t: Symbol

def joint_variable(i: int) -> Any: ...
def symbol(letter: str, i: int | None = None) -> Symbol: ...
def __getattr__(name: str) -> Any: ...
