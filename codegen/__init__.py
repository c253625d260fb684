"""moro_codegen: compiled kernels of robot models.

compile         a robot's dynamics as compiled functions: a Kernel
generate        those functions as a Program, before any language
build           the kernel of a program, in a folder of one's own
export          the functions as sources to take along: C, Python, ...
lambdify        any symbolic result as a fast function of NumPy arrays
FUNCTIONS       what can be compiled, by name
Function        a SymPy expression as one more function to compile
Regressor       "regressor" with or without the parameters that are zero
ToolchainError  no C compiler that works
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from moro_codegen.backends.toolchain import ToolchainError
    from moro_codegen.exported import export
    from moro_codegen.functions.catalogue import KNOWN as FUNCTIONS
    from moro_codegen.functions.own import UserFunction as Function
    from moro_codegen.functions.regressors import Regressor
    from moro_codegen.kernel.kernel import Kernel
    from moro_codegen.lambdified import lambdify
    from moro_codegen.pipeline import build, compile
    from moro_codegen.program import Program, generate
    from moro_codegen.proof.verification import Verification, verify

# first: sees to it that `import moro` finds the moro that belongs here
from moro_codegen import installation as installation  # isort: split

from moro.late import late

__all__ = [
    "FUNCTIONS",
    "Function",
    "Kernel",
    "Program",
    "Regressor",
    "ToolchainError",
    "Verification",
    "build",
    "compile",
    "export",
    "generate",
    "lambdify",
    "verify",
]

#: where names are, imported when they are first asked for: help needs neither SymPy nor NumPy
_HOMES = {
    "FUNCTIONS": "moro_codegen.functions.catalogue:KNOWN",
    "Function": "moro_codegen.functions.own:UserFunction",
    "Kernel": "moro_codegen.kernel.kernel:Kernel",
    "Program": "moro_codegen.program:Program",
    "Regressor": "moro_codegen.functions.regressors:Regressor",
    "ToolchainError": "moro_codegen.backends.toolchain:ToolchainError",
    "Verification": "moro_codegen.proof.verification:Verification",
    "build": "moro_codegen.pipeline:build",
    "compile": "moro_codegen.pipeline:compile",
    "export": "moro_codegen.exported:export",
    "generate": "moro_codegen.program:generate",
    "lambdify": "moro_codegen.lambdified:lambdify",
    "verify": "moro_codegen.proof.verification:verify",
}

if not TYPE_CHECKING:  # which knows the names above, and finds others wrong
    __getattr__, __dir__ = late(__name__, _HOMES)
