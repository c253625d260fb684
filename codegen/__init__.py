"""moro_codegen: compiled kernels of robot models.

compile         a robot's dynamics as compiled functions: a Kernel
generate        those functions as a Program, before any language
build           the kernel of a program, in a folder of one's own
lambdify        any symbolic result as a fast function of NumPy arrays
FUNCTIONS       what can be compiled, by name
Function        a SymPy expression as one more function to compile
Regressor       "regressor" with or without the parameters that are zero
ToolchainError  no C compiler that works
"""

from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moro_codegen.backends.toolchain import ToolchainError
    from moro_codegen.functions.catalogue import KNOWN as FUNCTIONS
    from moro_codegen.functions.own import UserFunction as Function
    from moro_codegen.functions.regressor import Regressor
    from moro_codegen.kernel.kernel import Kernel
    from moro_codegen.lambdified import lambdify
    from moro_codegen.pipeline import build, compile
    from moro_codegen.program import Program, generate
    from moro_codegen.proof.verification import Verification, verify

# sees to it that `import moro` finds the moro that belongs here
from moro_codegen import installation as installation

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
    "Regressor": "moro_codegen.functions.regressor:Regressor",
    "ToolchainError": "moro_codegen.backends.toolchain:ToolchainError",
    "Verification": "moro_codegen.proof.verification:Verification",
    "build": "moro_codegen.pipeline:build",
    "compile": "moro_codegen.pipeline:compile",
    "generate": "moro_codegen.program:generate",
    "lambdify": "moro_codegen.lambdified:lambdify",
    "verify": "moro_codegen.proof.verification:verify",
}

if not TYPE_CHECKING:  # which knows the names above, and finds others wrong

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = resolve_name(_HOMES[name])
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *_HOMES})
