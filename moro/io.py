"""Reading robot files, under the name that users know: ``moro.formats.loading``."""

from moro.formats.loading import (
    Problem,
    RobotFileError,
    RobotFileWarning,
    description,
    locate,
    packaged,
    read,
)

__all__ = [
    "Problem",
    "RobotFileError",
    "RobotFileWarning",
    "description",
    "locate",
    "packaged",
    "read",
]
