"""The C functions of a kernel, called without Python's arrays: by address, ctypes and capsules."""

import ctypes
import pickle

import numpy as np
import pytest
from exports import states, two_link

import moro_codegen as mc

FUNCTIONS = ("tau", ("tau", "kinetic_energy"))


@pytest.fixture(scope="module", params=[("c", "float64"), ("c", "float32"), ("cython", "float64")])
def kernel(request, tmp_path_factory):
    backend, dtype = request.param
    folder = tmp_path_factory.mktemp("kernel")
    return mc.compile(two_link(payload=0.5), FUNCTIONS, folder, backend, dtype)


def pointers(kernel, *arrays):
    real = ctypes.c_double if kernel.signatures["tau"].dtype == "float64" else ctypes.c_float
    return [x.ctypes.data_as(ctypes.POINTER(real)) for x in arrays]


def given(kernel):
    dtype = kernel.signatures["tau"].dtype
    return [*(np.array(x[0], dtype) for x in states(2)), np.array([0.75], dtype)]


def test_ctypes(kernel):
    arrays = given(kernel)
    tau, K = np.empty(2, arrays[0].dtype), np.empty(1, arrays[0].dtype)
    kernel.ctypes["tau_kinetic_energy"](*pointers(kernel, *arrays, tau, K))
    expected = kernel.tau_kinetic_energy(*arrays)
    assert np.array_equal(tau, expected[0])
    assert K[0] == expected[1]
    with pytest.raises(ctypes.ArgumentError):
        kernel.ctypes["tau"](*pointers(kernel, *arrays), "tau")


def test_addresses(kernel):
    assert set(kernel.address) == {"tau", "tau_kinetic_energy"}
    arrays = given(kernel)
    tau = np.empty(2, arrays[0].dtype)
    call = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 5)(kernel.address["tau"])
    call(*(x.ctypes.data for x in (*arrays, tau)))
    assert np.array_equal(tau, kernel.tau(*arrays))
    assert mc.Kernel(kernel.directory).address == kernel.address


def test_capsules(kernel):
    capsule = kernel.capsule["tau"]
    name, pointer = ctypes.pythonapi.PyCapsule_GetName, ctypes.pythonapi.PyCapsule_GetPointer
    name.restype, name.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    real = "double" if kernel.signatures["tau"].dtype == "float64" else "float"
    text = f"void (const {real} *, const {real} *, const {real} *, const {real} *, {real} *)"
    assert name(capsule).decode() == text
    assert pointer(capsule, text.encode()) == kernel.address["tau"]


def test_a_kernel_is_pickled_as_ever(kernel):
    assert kernel.ctypes
    assert pickle.loads(pickle.dumps(kernel)).address == kernel.address  # noqa: S301


def test_without_a_library(tmp_path):
    with pytest.raises(ValueError, match='backend="numpy" has no functions in C'):
        mc.compile(two_link(), directory=tmp_path, backend="numpy").address  # noqa: B018


def test_another_kernel_in_its_place(tmp_path):
    program = mc.generate(two_link())
    old = mc.build(program, tmp_path / "arm")
    mc.build(mc.generate(two_link(payload=0.5)), tmp_path / "arm")
    with pytest.raises(ValueError, match=r"libtwo_link.so has been replaced by another kernel's"):
        old.address  # noqa: B018
