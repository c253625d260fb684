"""moro_codegen: compiled kernels of robot models.

compile         a robot's dynamics as compiled functions: a Kernel
build           the same for a generated program, in a folder of one's own
FUNCTIONS       what can be compiled, by name
ToolchainError  no C compiler that works
"""

from moro_codegen.functions import FUNCTIONS
from moro_codegen.kernel import Kernel, build, compile
from moro_codegen.toolchain import ToolchainError
from moro_codegen.verify import Verification, verify

__all__ = [
    "FUNCTIONS",
    "Kernel",
    "ToolchainError",
    "Verification",
    "build",
    "compile",
    "verify",
]
