"""Reading robot files, under the name that users know: ``moro.formats.loading``."""

from moro.formats.loading import *  # noqa: F403
from moro.formats.loading import __all__ as __all__
