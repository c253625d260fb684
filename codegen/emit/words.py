"""Macros and types of C's headers: names that generated code must not give to anything."""

from __future__ import annotations

from itertools import product

_BITS = ("8", "16", "32", "64")
_INTEGERS = (*_BITS, "MAX", "PTR", *(f"_FAST{n}" for n in _BITS), *(f"_LEAST{n}" for n in _BITS))
_TYPES = tuple(f"{u}INT{n}" for u, n in product(("", "U"), _INTEGERS))
_LIMITED = (*_TYPES, "PTRDIFF", "SIZE", "SIG_ATOMIC", "WCHAR", "WINT")
_FLOATS = ("", "f", "l", "f16", "f32", "f64", "f128", "f32x", "f64x")
_CONSTANTS = """
    E LOG2E LOG10E LN2 LN10 PI PI_2 PI_4 1_PI 2_PI 2_SQRTPI SQRT2 SQRT1_2 SQRTPI
    """.split()  # noqa: SIM905 - tables of words, here and below
_FP = """
    NAN QNAN SNAN INFINITE ZERO NORMAL SUBNORMAL SUPERNORMAL ILOGB0 ILOGBNAN LLOGB0 LLOGBNAN
    INT_UPWARD INT_DOWNWARD INT_TOWARDZERO INT_TONEAREST INT_TONEARESTFROMZERO FAST_FMA FAST_FMAF
    FAST_FMAL FAST_FMAF32 FAST_FMAF64 FAST_FMAF128 FAST_FMAF32X FAST_FMAF64X
    """.split()  # noqa: SIM905
_SINGLE = """
    NAN INFINITY NULL MATH_ERRNO MATH_ERREXCEPT math_errhandling MAXFLOAT HUGE DOMAIN SING OVERFLOW
    UNDERFLOW TLOSS PLOSS X_TLOSS EDOM ERANGE EILSEQ HUGE_VALF HUGE_VALL fpclassify isfinite isinf
    isnan isnormal issubnormal iszero signbit offsetof isgreater isgreaterequal isless islessequal
    islessgreater isunordered iseqsig iscanonical issignaling unreachable linux unix i386 assert
    bool true false
    """.split()  # noqa: SIM905

#: of <math.h>, <stdint.h> and <stddef.h> on any system and in any mode, and what compilers define
MACROS = frozenset(
    [
        *(f"{x}_{what}" for x, what in product(_LIMITED, ("MAX", "MIN", "WIDTH", "C"))),
        *(f"M_{x}{kind}" for x, kind in product(_CONSTANTS, _FLOATS)),
        *(f"HUGE_VAL{'_' * bool(kind)}{kind.upper()}" for kind in _FLOATS),
        *(f"SNAN{kind.upper()}" for kind in _FLOATS),
        *(f"FP_{x}" for x in _FP),
        *_SINGLE,
    ]
)

#: of the same headers
TYPES = frozenset(
    [
        *(f"{x.lower()}_t" for x in _TYPES),
        *(f"{x}_t" for x in ("size", "ptrdiff", "wchar", "max_align", "nullptr")),
        *("float_t", "double_t"),
    ]
)
