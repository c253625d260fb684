"""moro: exact symbolic equations of motion of robot arms.

    Robot       DH rows in, every symbolic quantity out
    load        a robot.yaml, or a packaged arm by its name, as a Robot
    Collected   a long result in named constants, of ``collect=True``
    Model       the plain data that the recursive algorithms read (Robot.model())

``moro_codegen`` makes compiled kernels of the same robots.
"""

from moro.collected import Collected
from moro.model import Body, Joint, Model, Placement
from moro.robot import Robot
from moro.tables import Table

load = Robot.load

__all__ = ["Body", "Collected", "Joint", "Model", "Placement", "Robot", "Table", "load"]
