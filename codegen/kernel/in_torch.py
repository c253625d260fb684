"""The functions of a kernel for PyTorch, on the CPU: custom operators, with derivatives.

They take whole batches, through ``torch.vmap`` as well, and stay one node in the graphs of
``torch.compile``. Gradients are those of ``moro_codegen.kernel.frameworks``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import torch

from moro_codegen.kernel.frameworks import (
    Call,
    Compiled,
    Derivative,
    Framework,
    advice,
    derivative,
)
from moro_codegen.signature import Signature


class InTorch:
    """What ``kernel.torch`` is: the kernel's functions under their names."""

    def __init__(self, kernel: Compiled):
        self._kernel = kernel
        raw = _OPERATORS.get(kernel.manifest["key"])
        if raw is None:
            raw = _OPERATORS[kernel.manifest["key"]] = _registered(kernel)
        for name, signature in kernel.signatures.items():
            setattr(self, name, _function(signature, raw[name]))

    def __getattr__(self, name: str) -> Any:
        there = ", ".join(self._kernel.signatures)
        raise AttributeError(f"this kernel has no {name!r}; its functions are: {there}")


#: of the kernels of this process, by their keys: PyTorch knows an operator by its name
_OPERATORS: dict[str, dict[str, Call]] = {}


def _registered(kernel: Compiled) -> dict[str, Call]:
    """Return every function of a kernel, by name, as an operator of PyTorch."""
    operators: dict[str, Any] = {}
    raw: dict[str, Call] = {}
    for name, signature in kernel.signatures.items():
        operators[name] = _operator(kernel, signature)
        raw[name] = _always_a_tuple(operators[name])
    for name, signature in kernel.signatures.items():
        _give_gradients(operators[name], signature, derivative(_TORCH, signature, kernel, raw))
    return raw


def _operator(kernel: Compiled, signature: Signature) -> Any:
    """Return a function as an operator on inputs with the same axes in front."""
    call = getattr(kernel, signature.name)
    several = len(signature.outputs) > 1

    def run(*tensors: Any) -> Any:
        results = call(*(x.detach().numpy() for x in tensors))
        found = tuple(torch.from_numpy(np.asarray(x)) for x in (results if several else [results]))
        return found if several else found[0]

    def shaped(*tensors: Any) -> Any:
        first = tensors[0]
        front = first.shape[: first.ndim - len(signature.inputs[0].sizes)]
        found = tuple(first.new_empty((*front, *a.sizes)) for a in signature.outputs)
        return found if several else found[0]

    def mapped(info: Any, dims: Sequence[int | None], *tensors: Any) -> tuple[Any, Any]:
        moved = [
            x.expand(info.batch_size, *x.shape) if d is None else x.movedim(d, 0)
            for x, d in zip(tensors, dims, strict=True)
        ]
        return operator(*moved), (0,) * len(signature.outputs) if several else 0

    arguments = ", ".join(f"Tensor {a.name}" for a in signature.inputs)
    results = ", ".join(["Tensor"] * len(signature.outputs))
    operator = torch.library.custom_op(
        f"moro::{kernel.name}_{kernel.manifest['key'][:16]}_{signature.name}",
        run,
        mutates_args=(),
        device_types="cpu",
        schema=f"({arguments}) -> {f'({results})' if several else results}",
    )
    operator.register_fake(shaped)
    operator.register_vmap(mapped)
    return operator


def _always_a_tuple(operator: Any) -> Call:
    def call(*tensors: Any) -> tuple[Any, ...]:
        results = operator(*tensors)
        return tuple(results) if isinstance(results, (tuple, list)) else (results,)

    return call


def _give_gradients(operator: Any, signature: Signature, by: Derivative | None) -> None:
    def keep(ctx: Any, inputs: Sequence[Any], output: Any) -> None:
        ctx.save_for_backward(*inputs)

    def backward(ctx: Any, *by_results: Any) -> Any:
        if by is None:
            raise TypeError(advice(signature))
        if signature.parameters and ctx.needs_input_grad[-1]:
            raise TypeError(f"{signature.name} has no derivative by its run-time parameters")
        found = by.backward(ctx.saved_tensors, by_results[0])
        return (*found, None) if signature.parameters else tuple(found)

    operator.register_autograd(backward, setup_context=keep)


def _function(signature: Signature, call: Call) -> Callable[..., Any]:
    """Return a function that takes what the kernel's takes: tensors with axes in front."""

    def function(*given: Any, parameters: Any = None) -> Any:
        results = call(*_TORCH.arguments(signature, given, parameters))
        return results[0] if len(results) == 1 else results

    function.__name__ = function.__qualname__ = signature.name
    function.__doc__ = signature.summary
    return function


def _tensor(value: Any, dtype: str) -> Any:
    if isinstance(value, torch.Tensor) and value.device.type != "cpu":
        raise ValueError(f"kernels compute on the CPU, and a tensor is on {value.device}")
    return torch.as_tensor(value, dtype=getattr(torch, dtype))


_TORCH = Framework(torch, _tensor)
