"""moro: exact symbolic equations of motion of robot arms.

    Robot       DH rows in, every symbolic quantity out
    load        a robot.yaml, or a packaged arm by its name, as a Robot
    Collected   a long result in named constants, of ``collect=True``
    Model       the plain data that the recursive algorithms read (Robot.model())

``moro_codegen`` makes compiled kernels of the same robots.
"""

from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moro import abc as abc
    from moro.model import Body, Joint, Model, Placement
    from moro.printing.collected import Collected
    from moro.printing.tables import Table
    from moro.robot import Robot

    load = Robot.load

__version__ = "0.1.0"

__all__ = [
    "Body",
    "Collected",
    "Joint",
    "Model",
    "Placement",
    "Robot",
    "Table",
    "__version__",
    "load",
]

#: where names are, imported when they are first asked for: reading a file needs no SymPy
_HOMES = {
    "Body": "moro.model:Body",
    "Collected": "moro.printing.collected:Collected",
    "Joint": "moro.model:Joint",
    "Model": "moro.model:Model",
    "Placement": "moro.model:Placement",
    "Robot": "moro.robot:Robot",
    "Table": "moro.printing.tables:Table",
    "abc": "moro.abc",
    "load": "moro.robot:Robot.load",
}

if not TYPE_CHECKING:  # which knows the names above, and finds others wrong

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = resolve_name(_HOMES[name])
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *_HOMES})
