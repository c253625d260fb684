"""What JAX and PyTorch have in common as callers of a kernel: arguments, and first derivatives.

Derivatives are those of the kernel's own functions: ``tau`` and ``bias`` have theirs from
``tau_derivatives``, ``forward_dynamics`` from ``forward_dynamics_derivatives``,
``potential_energy`` from ``gravity_vector``, ``forward_kinematics`` from ``jacobian``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from moro_codegen.signature import Part, Signature

#: from arguments to results, arrays of a framework
Call = Callable[..., tuple[Any, ...]]


class Compiled(Protocol):
    """What is asked of a kernel."""

    name: str
    backend: str
    directory: Path
    library: Path | None
    manifest: dict[str, Any]
    signatures: dict[str, Signature]


@dataclass(frozen=True)
class Framework:
    """Arrays of JAX or PyTorch."""

    #: jax.numpy, or torch: of what both have by the same names
    space: Any
    #: from anything, and a type by NumPy's name, to an array
    array: Callable[[Any, str], Any]

    def arguments(self, signature: Signature, given: Sequence[Any], parameters: Any) -> list[Any]:
        """Return all inputs of a call, with the same axes in front."""
        names = [a.name for a in signature.given]
        if signature.parameters and len(given) == len(names) + 1:
            *given, parameters = given
        if len(given) != len(names):
            raise TypeError(f"{signature.name} takes {', '.join(names)}: {len(given)} were given")
        arrays = [self.array(x, signature.dtype) for x in given]
        if signature.parameters:
            arrays.append(self.array(self._values(signature, parameters), signature.dtype))
        fronts = []
        for x, a in zip(arrays, signature.inputs, strict=True):
            place = x.ndim - len(a.sizes)
            if place < 0 or tuple(x.shape[place:]) != a.sizes:
                shape = ", ".join(["...", *map(str, a.sizes)])
                raise ValueError(f"{a.name} must have shape ({shape}), not {tuple(x.shape)}")
            fronts.append(x.shape[:place])
        front = self.space.broadcast_shapes(*fronts)
        both = zip(arrays, signature.inputs, strict=True)
        return [self.space.broadcast_to(x, (*front, *a.sizes)) for x, a in both]

    def _values(self, signature: Signature, parameters: Any) -> Any:
        """Return the values of all run-time parameters, of an array or a dictionary of some."""
        if parameters is not None and not isinstance(parameters, Mapping):
            return parameters
        given = dict(parameters or {})
        values = []
        for x in signature.parameters:
            value = given.pop(x.name, x.default)
            if value is None:
                raise ValueError(
                    f"{signature.name} needs a value of {x.name}, which has no default"
                )
            values.append(self.array(value, signature.dtype))
        if given:
            raise ValueError(f"{signature.name} has no parameters {', '.join(given)}")
        shape = self.space.broadcast_shapes(*(x.shape for x in values))
        return self.space.stack([self.space.broadcast_to(x, shape) for x in values], -1)


@dataclass(frozen=True)
class Derivative:
    """The derivative of a function of a kernel, at inputs x: an array for each that counts.

    Its axes are those of the samples, of the result, and of the input.
    """

    framework: Framework
    at: Callable[[Sequence[Any]], tuple[Any, ...]]
    #: letters for the axes of the result
    axes: str

    def forward(self, x: Sequence[Any], dx: Sequence[Any]) -> Any:
        """Return the tangent of the result for those of the inputs; None: none."""
        parts = [
            self.framework.space.einsum(f"...{self.axes}z,...z->...{self.axes}", D, tangent)
            for D, tangent in zip(self.at(x), dx, strict=False)
            if tangent is not None
        ]
        return sum(parts[1:], parts[0])

    def backward(self, x: Sequence[Any], by_result: Any) -> list[Any]:
        """Return the derivatives by the inputs of what has this derivative by the result."""
        einsum = self.framework.space.einsum
        return [einsum(f"...{self.axes}z,...{self.axes}->...z", D, by_result) for D in self.at(x)]


def derivative(
    framework: Framework,
    signature: Signature,
    kernel: Compiled,
    raw: Mapping[str, Call],
    wrapped: Callable[[Call], Call] = lambda call: call,
) -> Derivative | None:
    """Return the derivative of a function, if the kernel has what that takes.

    ``raw`` are the kernel's functions; ``wrapped`` is put around that which has the derivatives.
    """
    if len(signature.parts) > 1:
        return None
    (part,) = signature.parts
    needed, at = _RULES.get(part.name, ("", None))
    alike = Part(needed, 0, part.frame)
    name = next((x for x, s in kernel.signatures.items() if _is_of(s, alike)), None)
    if at is None or name is None:
        return None
    derivatives, value = wrapped(raw[name]), raw[signature.name]
    axes = "abcd"[: len(signature.outputs[0].sizes)]
    return Derivative(framework, lambda x: at(framework, derivatives, value, x), axes)


def advice(signature: Signature) -> str:
    """Say why a function has no derivative, and how it gets one."""
    needed, _ = _RULES.get(signature.name, (None, None))
    how = (
        f'compile the kernel with functions=("{signature.name}", "{needed}")'
        if needed
        else f"functions that have one are {', '.join(_RULES)}"
    )
    return f"{signature.name} has no derivative here: {how}"


def _is_of(signature: Signature, part: Part) -> bool:
    """Return whether a function computes one thing, of a frame, and nothing else."""
    return [(x.name, x.frame) for x in signature.parts] == [(part.name, part.frame)]


def _of_tau(_: Framework, derivatives: Call, __: Call, x: Sequence[Any]) -> tuple[Any, ...]:
    return derivatives(*x)


def _of_bias(f: Framework, derivatives: Call, _: Call, x: Sequence[Any]) -> tuple[Any, ...]:
    q, qd, *parameters = x
    return derivatives(q, qd, f.space.zeros_like(q), *parameters)[:2]


def _of_height(_: Framework, gravity: Call, __: Call, x: Sequence[Any]) -> tuple[Any, ...]:
    return gravity(*x)


def _of_pose(f: Framework, jacobian: Call, pose: Call, x: Sequence[Any]) -> tuple[Any, ...]:
    """With (v, w) = J dq: dR = [w]x R and dp = v."""
    (T,), (J,) = pose(*x), jacobian(*x)
    cross = f.array(_CROSS, str(np.dtype(str(J.dtype).removeprefix("torch."))))
    turned = f.space.einsum("abc,...bz,...cd->...adz", cross, J[..., 3:, :], T[..., :3, :3])
    upper = f.space.concatenate([turned, J[..., :3, None, :]], -2)
    return (f.space.concatenate([upper, f.space.zeros_like(upper[..., :1, :, :])], -3),)


#: of a cross product: +1 for (0, 1, 2) and its rotations, -1 for the others
_CROSS = np.cross(np.eye(3)[:, None], np.eye(3)[None]).transpose(2, 0, 1)

_At = Callable[[Framework, Call, Call, Sequence[Any]], tuple[Any, ...]]
#: function: (the kernel's function that has its derivatives, how they are used)
_RULES: dict[str, tuple[str, _At]] = {
    "tau": ("tau_derivatives", _of_tau),
    "bias": ("tau_derivatives", _of_bias),
    "forward_dynamics": ("forward_dynamics_derivatives", _of_tau),
    "potential_energy": ("gravity_vector", _of_height),
    "forward_kinematics": ("jacobian", _of_pose),
}
