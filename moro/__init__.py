"""moro: exact symbolic equations of motion of robot arms.

    Robot       DH rows in, every symbolic quantity out
    load        a robot.yaml, or a packaged arm by its name, as a Robot
    Collected   a long result in named constants, of ``collect=True``
    Model       the plain data that the recursive algorithms read (Robot.model())

``moro_codegen`` makes compiled kernels of the same robots.
"""

from typing import TYPE_CHECKING

from moro.late import late

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
    __getattr__, __dir__ = late(__name__, _HOMES)
