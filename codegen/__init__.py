"""moro_codegen: compiled kernels of robot models.

compile         a robot's dynamics as compiled functions: a Kernel
build           the same for a generated program, in a folder of one's own
lambdify        any symbolic result as a fast function of NumPy arrays
FUNCTIONS       what can be compiled, by name
Function        a SymPy expression as one more function to compile
ToolchainError  no C compiler that works
"""

from moro_codegen.builder import build, compile
from moro_codegen.expressions import UserFunction as Function
from moro_codegen.kernel import Kernel
from moro_codegen.lambdify import lambdify
from moro_codegen.requested import KNOWN as FUNCTIONS
from moro_codegen.toolchain import ToolchainError
from moro_codegen.verify import Verification, verify

__all__ = [
    "FUNCTIONS",
    "Function",
    "Kernel",
    "ToolchainError",
    "Verification",
    "build",
    "compile",
    "lambdify",
    "verify",
]
