from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

class Library:
    path: str
    def __init__(self, path: str) -> None: ...
    def text(self, name: str) -> str: ...
    def said(self, name: str) -> str | None: ...

def gufunc(
    library: Library,
    symbol: str,
    name: str,
    signature: str,
    nin: int,
    nout: int,
    dtype: str,
) -> np.ufunc: ...

class Function:
    library: Library
    name: str
    gufunc: np.ufunc
    general: Callable[..., Any]
    def __init__(
        self,
        library: Library,
        symbol: str,
        gufunc: np.ufunc,
        name: str,
        doc: str,
        inputs: Sequence[tuple[int, ...]],
        outputs: Sequence[tuple[int, ...]],
        parameters: tuple[int, Sequence[float] | None] | None,
        general: Callable[..., Any],
        origin: tuple[Callable[..., Any], tuple[Any, ...]],
        dtype: str,
    ) -> None: ...
    @property
    def call(self) -> Callable[..., Any]: ...
