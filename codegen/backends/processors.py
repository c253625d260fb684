"""What compiled code may ask of a processor: of x86, by the macros of GCC and Clang.

Those that the compiler uses for arithmetic by itself; code that uses one dies on a processor that
lacks it.
"""

#: the macro that a compiler predefines, and what its __builtin_cpu_supports calls the feature
X86 = {
    "__SSE3__": "sse3",
    "__SSSE3__": "ssse3",
    "__SSE4_1__": "sse4.1",
    "__SSE4_2__": "sse4.2",
    "__POPCNT__": "popcnt",
    "__AVX__": "avx",
    "__AVX2__": "avx2",
    "__FMA__": "fma",
    "__BMI__": "bmi",
    "__BMI2__": "bmi2",
    "__FMA4__": "fma4",
    "__XOP__": "xop",
    "__AVX512F__": "avx512f",
    "__AVX512CD__": "avx512cd",
    "__AVX512BW__": "avx512bw",
    "__AVX512DQ__": "avx512dq",
    "__AVX512VL__": "avx512vl",
    "__APX_F__": "apxf",
}

#: the same for 64-bit Arm under Linux: the word of its auxiliary vector and the bit
ARM = {
    "__ARM_FEATURE_SVE": ("sve", "AT_HWCAP", "HWCAP_SVE"),
    "__ARM_FEATURE_SVE2": ("sve2", "AT_HWCAP2", "HWCAP2_SVE2"),
}

#: names by macro
FEATURES = {**X86, **{macro: name for macro, (name, *_) in ARM.items()}}
