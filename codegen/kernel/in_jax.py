"""The functions of a kernel for JAX, on the CPU: compiled code that XLA calls, with derivatives.

A handler of XLA's foreign function interface hands the arrays of all samples to the kernel's loop,
so that ``jax.vmap`` and ``jax.jit`` cost nothing. Derivatives are those of the kernel's own
functions: ``tau`` and ``bias`` have theirs from ``tau_derivatives``, ``forward_dynamics`` from
``forward_dynamics_derivatives``, ``potential_energy`` from ``gravity_vector``,
``forward_kinematics`` from ``jacobian``.
"""

from __future__ import annotations

import ctypes
import hashlib
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero

from moro_codegen.backends import toolchain
from moro_codegen.emit.render import render
from moro_codegen.kernel import store
from moro_codegen.signature import Part, Signature

#: from arguments to results, arrays of JAX
Call = Callable[..., tuple[Any, ...]]
#: from primals (of all inputs) and tangents (None: none) to the tangents of the results
Rule = Callable[[Sequence[Any], Sequence[Any]], tuple[Any, ...]]


class Compiled(Protocol):
    """What is asked of a kernel."""

    name: str
    backend: str
    directory: Path
    library: Path | None
    manifest: dict[str, Any]
    signatures: dict[str, Signature]


class InJAX:
    """What ``kernel.jax`` is: the kernel's functions under their names."""

    def __init__(self, kernel: Compiled):
        self._kernel = kernel
        if kernel.library is None or kernel.backend != "c":
            raise ValueError(f'kernel.jax needs a kernel in C, not backend="{kernel.backend}"')
        raw = dict(_registered(kernel))
        for name, signature in kernel.signatures.items():
            setattr(self, name, _function(signature, raw[name], _rule(signature, kernel, raw)))

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


def _function(signature: Signature, call: Call, rule: Rule | None) -> Callable[..., Any]:
    """Return a function that takes what the kernel's takes: arrays with axes in front."""
    run = jax.custom_jvp(call)

    def jvp(primals: Sequence[Any], tangents: Sequence[Any]) -> tuple[Any, Any]:
        known = [None if isinstance(t, SymbolicZero) else t for t in tangents]
        if rule is None:
            raise TypeError(
                f"{signature.name} has no derivative here: {_ADVICE.get(signature.name, _NONE)}"
            )
        if signature.parameters and known[-1] is not None:
            raise TypeError(f"{signature.name} has no derivative by its run-time parameters")
        return run(*primals), rule(primals, known)

    run.defjvp(jvp, symbolic_zeros=True)

    def function(*given: Any, parameters: Any = None) -> Any:
        results = run(*_arrays(signature, given, parameters))
        return results[0] if len(results) == 1 else results

    function.__name__ = function.__qualname__ = signature.name
    function.__doc__ = signature.summary
    return function


def _arrays(signature: Signature, given: Sequence[Any], parameters: Any) -> list[Any]:
    """Return all inputs, with the same axes in front."""
    names = [a.name for a in signature.given]
    if signature.parameters and len(given) == len(names) + 1:
        *given, parameters = given
    if len(given) != len(names):
        raise TypeError(f"{signature.name} takes {', '.join(names)}: {len(given)} were given")
    config: Any = jax.config  # which has no types
    if signature.dtype == "float64" and not config.jax_enable_x64:
        raise TypeError(
            f"{signature.name} computes in double precision: "
            'jax.config.update("jax_enable_x64", True), or compile the kernel with dtype="float32"'
        )
    arrays = [jnp.asarray(x, signature.dtype) for x in given]
    if signature.parameters:
        arrays.append(jnp.asarray(_values(signature, parameters), signature.dtype))
    fronts = []
    for x, a in zip(arrays, signature.inputs, strict=True):
        front, core = x.shape[: x.ndim - len(a.sizes)], x.shape[x.ndim - len(a.sizes) :]
        if x.ndim < len(a.sizes) or core != a.sizes:
            shape = ", ".join(["...", *map(str, a.sizes)])
            raise ValueError(f"{a.name} must have shape ({shape}), not {x.shape}")
        fronts.append(front)
    front = jnp.broadcast_shapes(*fronts)
    both = zip(arrays, signature.inputs, strict=True)
    return [jnp.broadcast_to(x, (*front, *a.sizes)) for x, a in both]


def _values(signature: Signature, parameters: Any) -> Any:
    """Return the values of all run-time parameters, of an array or a dictionary of some."""
    if parameters is not None and not isinstance(parameters, Mapping):
        return parameters
    given = dict(parameters or {})
    values = []
    for x in signature.parameters:
        value = given.pop(x.name, x.default)
        if value is None:
            raise ValueError(f"{signature.name} needs a value of {x.name}, which has no default")
        values.append(jnp.asarray(value, signature.dtype))
    if given:
        raise ValueError(f"{signature.name} has no parameters {', '.join(given)}")
    return jnp.stack(jnp.broadcast_arrays(*values), axis=-1)


# -- derivatives ----------------------------------------------------------------------------------


def _rule(signature: Signature, kernel: Compiled, raw: Mapping[str, Call]) -> Rule | None:
    """Return how tangents go through a function, if the kernel has what that takes."""
    if len(signature.parts) > 1:
        return None
    (part,) = signature.parts
    needed, make = _RULES.get(part.name, ("", None))
    alike = Part(needed, 0, part.frame)
    found = (x for x, s in kernel.signatures.items() if _is_of(s, alike))
    name = next(found, None)
    if make is None or name is None:
        return None
    derivative = jax.custom_jvp(raw[name])
    derivative.defjvp(partial(_no_second, signature.name))
    return make(derivative, raw[signature.name])


def _is_of(signature: Signature, part: Part) -> bool:
    """Return whether a function computes one thing, of a frame, and nothing else."""
    return [(x.name, x.frame) for x in signature.parts] == [(part.name, part.frame)]


def _no_second(name: str, primals: Sequence[Any], tangents: Sequence[Any]) -> tuple[Any, Any]:
    raise TypeError(f"{name} has first derivatives only: no derivative of its derivative")


def _of_tau(derivatives: Call, _: Call) -> Rule:
    return lambda x, dx: (_applied(derivatives(*x), dx[:3], x[0]),)


def _of_bias(derivatives: Call, _: Call) -> Rule:
    def rule(x: Sequence[Any], dx: Sequence[Any]) -> tuple[Any, ...]:
        q, qd, *parameters = x
        by_q, by_qd, _ = derivatives(q, qd, jnp.zeros_like(q), *parameters)
        return (_applied((by_q, by_qd), dx[:2], q),)

    return rule


def _of_height(gravity: Call, _: Call) -> Rule:
    def rule(x: Sequence[Any], dx: Sequence[Any]) -> tuple[Any, ...]:
        (G,) = gravity(*x)
        return (jnp.einsum("...i,...i->...", G, dx[0]),)

    return rule


def _of_pose(jacobian: Call, pose: Call) -> Rule:
    """DR = [w]x R and dp = v, with (v, w) = J dq."""

    def rule(x: Sequence[Any], dx: Sequence[Any]) -> tuple[Any, ...]:
        (T,), (J,) = pose(*x), jacobian(*x)
        moved = jnp.einsum("...ij,...j->...i", J, dx[0])
        v, w = moved[..., :3], moved[..., 3:]
        turned = jnp.cross(w[..., None, :], jnp.swapaxes(T[..., :3, :3], -1, -2))
        upper = jnp.concatenate([jnp.swapaxes(turned, -1, -2), v[..., None]], axis=-1)
        return (jnp.concatenate([upper, jnp.zeros_like(T[..., 3:, :])], axis=-2),)

    return rule


def _applied(matrices: Sequence[Any], tangents: Sequence[Any], like: Any) -> Any:
    """Return the sum of matrix times tangent."""
    total = jnp.zeros_like(like)
    for matrix, tangent in zip(matrices, tangents, strict=True):
        if tangent is not None:
            total = total + jnp.einsum("...ij,...j->...i", matrix, tangent)
    return total


#: function: (the kernel's function that has its derivatives, how they are used)
_RULES: dict[str, tuple[str, Callable[[Call, Call], Rule]]] = {
    "tau": ("tau_derivatives", _of_tau),
    "bias": ("tau_derivatives", _of_bias),
    "forward_dynamics": ("forward_dynamics_derivatives", _of_tau),
    "potential_energy": ("gravity_vector", _of_height),
    "forward_kinematics": ("jacobian", _of_pose),
}
_NONE = f"functions that have one are {', '.join(_RULES)}"
_ADVICE = {
    name: f'compile the kernel with functions=("{name}", "{needed}")'
    for name, (needed, _) in _RULES.items()
}
