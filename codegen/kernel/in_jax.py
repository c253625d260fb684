"""The functions of a kernel for JAX, on the CPU: compiled code that XLA calls, with derivatives.

A handler of XLA's foreign function interface hands the arrays of all samples to the kernel's loop,
so that ``jax.vmap`` and ``jax.jit`` cost nothing. Derivatives are those of
``moro_codegen.kernel.frameworks``.
"""

from __future__ import annotations

import ctypes
import hashlib
import math
import os
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero

from moro_codegen.backends import toolchain
from moro_codegen.emit.render import render
from moro_codegen.kernel import store
from moro_codegen.kernel.frameworks import (
    Call,
    Compiled,
    Derivative,
    Framework,
    advice,
    derivative,
)
from moro_codegen.signature import Signature


class InJAX:
    """What ``kernel.jax`` is: the kernel's functions under their names."""

    def __init__(self, kernel: Compiled):
        self._kernel = kernel
        if kernel.library is None or kernel.backend != "c":
            raise ValueError(f'kernel.jax needs a kernel in C, not backend="{kernel.backend}"')
        raw = dict(_registered(kernel))
        for name, signature in kernel.signatures.items():
            once = partial(_once, signature.name)
            by = derivative(_JAX, signature, kernel, raw, once)
            setattr(self, name, _function(signature, raw[name], by))

    def __getattr__(self, name: str) -> Any:
        there = ", ".join(self._kernel.signatures)
        raise AttributeError(f"this kernel has no {name!r}; its functions are: {there}")


def _registered(kernel: Compiled) -> Iterator[tuple[str, Call]]:
    """Yield every function of a kernel, by name, as JAX calls it, without derivatives."""
    library = ctypes.CDLL(str(kernel.library))
    handlers = ctypes.CDLL(str(_built(kernel)))
    for which, (name, signature) in enumerate(kernel.signatures.items()):
        loop = ctypes.cast(library[f"{kernel.name}_{name}_loop"], ctypes.c_void_p)
        handlers.bind(which, loop)
        target = f"moro_{kernel.manifest['key'][:16]}_{name}"
        ffi: Any = jax.ffi  # which has no types
        handler = ffi.pycapsule(handlers[f"call_{name}"])
        ffi.register_ffi_target(target, handler, platform="cpu")
        yield name, _call(target, signature)


def _call(target: str, signature: Signature) -> Call:
    def call(*arrays: Any) -> tuple[Any, ...]:
        front = arrays[0].shape[: arrays[0].ndim - len(signature.inputs[0].sizes)]
        shape: Any = jax.ShapeDtypeStruct  # which has no types
        results = [shape((*front, *a.sizes), signature.dtype) for a in signature.outputs]
        return tuple(jax.ffi.ffi_call(target, results, vmap_method="broadcast_all")(*arrays))

    return call


def _built(kernel: Compiled) -> Path:
    """Return the library of handlers, compiled into the kernel's folder if it is not there."""
    holes = [_holes(name, signature) for name, signature in kernel.signatures.items()]
    source = render(
        "jax.c.jinja",
        name=kernel.name,
        functions=holes,
        most=max(hole["inputs"] + hole["outputs"] for hole in holes),
        size=_size(next(iter(kernel.signatures.values()))),
    )
    key = hashlib.sha256(f"{source} {jax.__version__}".encode()).hexdigest()[:16]
    there = os.access(kernel.directory, os.W_OK)
    path = (kernel.directory if there else store.cache()) / f"lib{kernel.name}_jax_{key}.so"
    if not path.is_file():
        _compile(source, path)
    return path


def _compile(source: str, path: Path) -> None:
    compiler = toolchain.find_compiler("native")
    with TemporaryDirectory(dir=path.parent) as folder:
        (Path(folder) / "handlers.c").write_text(source, encoding="utf-8")
        command = [
            *compiler.command, "-O1", "-shared", "-fPIC", f"-I{jax.ffi.include_dir()}",
            "handlers.c", "-o", "handlers.so",
        ]  # fmt: skip
        done = toolchain.run(command, Path(folder))
        if done.returncode != 0:
            raise toolchain.ToolchainError(
                f"the handlers for JAX {jax.__version__} do not compile:\n{toolchain.words(done)}"
            )
        (Path(folder) / "handlers.so").replace(path)


def _holes(name: str, signature: Signature) -> dict[str, Any]:
    """Return what the template says of a function: strides in bytes, of samples first."""
    size = _size(signature)
    arguments = (*signature.inputs, *signature.outputs)
    inner = [size * math.prod(a.sizes[k + 1 :]) for a in arguments for k in range(len(a.sizes))]
    return {
        "name": name,
        "inputs": len(signature.inputs),
        "outputs": len(signature.outputs),
        "steps": [*(size * a.size for a in arguments), *inner],
    }


def _size(signature: Signature) -> int:
    """Return the bytes of a number."""
    return np.dtype(signature.dtype).itemsize


# -- calls ----------------------------------------------------------------------------------------


def _function(signature: Signature, call: Call, by: Derivative | None) -> Callable[..., Any]:
    """Return a function that takes what the kernel's takes: arrays with axes in front."""
    run = jax.custom_jvp(call)

    def jvp(primals: Sequence[Any], tangents: Sequence[Any]) -> tuple[Any, Any]:
        known = [None if isinstance(t, SymbolicZero) else t for t in tangents]
        if by is None:
            raise TypeError(advice(signature))
        if signature.parameters and known[-1] is not None:
            raise TypeError(f"{signature.name} has no derivative by its run-time parameters")
        return run(*primals), (by.forward(primals, known),)

    run.defjvp(jvp, symbolic_zeros=True)

    def function(*given: Any, parameters: Any = None) -> Any:
        results = run(*_JAX.arguments(signature, given, parameters))
        return results[0] if len(results) == 1 else results

    function.__name__ = function.__qualname__ = signature.name
    function.__doc__ = signature.summary
    return function


def _once(name: str, call: Call) -> Call:
    """Return a function that has derivatives, and none itself."""
    derivatives = jax.custom_jvp(call)
    derivatives.defjvp(partial(_no_second, name))
    return derivatives


def _no_second(name: str, primals: Sequence[Any], tangents: Sequence[Any]) -> tuple[Any, Any]:
    raise TypeError(f"{name} has first derivatives only: no derivative of its derivative")


def _array(value: Any, dtype: str) -> Any:
    config: Any = jax.config  # which has no types
    if dtype == "float64" and not config.jax_enable_x64:
        raise TypeError(
            "the kernel computes in double precision: "
            'jax.config.update("jax_enable_x64", True), or compile it with dtype="float32"'
        )
    return jnp.asarray(value, dtype)


_JAX = Framework(jnp, _array)
