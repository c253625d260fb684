"""What only code can say of the build: the packages in their folders, and the compiled part."""

import sys

import numpy
from setuptools import Extension, find_packages, setup

FOLDERS = {"moro": "moro", "moro_codegen": "codegen", "moro_codegen.templates": "templates"}

if sys.platform == "win32":
    sys.exit("moro-codegen needs Linux or macOS; on Windows it runs in WSL (wsl --install)")

setup(
    packages=[
        package
        for name, folder in FOLDERS.items()
        for package in (name, *(f"{name}.{inside}" for inside in find_packages(folder)))
    ],
    package_dir=FOLDERS,
    ext_modules=[
        Extension(
            "moro_codegen._runtime",
            ["codegen/_runtime.pyx"],
            include_dirs=[numpy.get_include()],
            # dlopen, in a library of its own before glibc 2.34
            libraries=["dl"] if sys.platform == "linux" else [],
            define_macros=[("NPY_NO_DEPRECATED_API", "NPY_2_0_API_VERSION")],
        )
    ],
    options={"build_ext": {"cython_c_in_temp": True}},  # no C file beside the source
)
