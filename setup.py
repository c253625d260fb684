"""The compiled part of the build: only code can find the headers of NumPy that it needs."""

import sys

import numpy
from Cython.Build import cythonize
from setuptools import Extension, setup

setup(
    ext_modules=cythonize(
        [
            Extension(
                "moro_codegen._runtime",
                ["codegen/_runtime.pyx"],
                include_dirs=[numpy.get_include()],
                # dlopen, in a library of its own before glibc 2.34
                libraries=["dl"] if sys.platform == "linux" else [],
                define_macros=[("NPY_NO_DEPRECATED_API", "NPY_2_0_API_VERSION")],
            )
        ],
        compiler_directives={"language_level": 3},
    )
)
