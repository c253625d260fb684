"""``kernel.torch``: the numbers of the kernel, through vmap and compile; gradients by gradcheck."""

import numpy as np
import pytest
from exports import two_link

import moro_codegen as mc

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

FUNCTIONS = (
    "tau", "tau_derivatives", "bias", "forward_dynamics", "forward_dynamics_derivatives",
    "potential_energy", "gravity_vector", "forward_kinematics", "jacobian", "inertia_matrix",
)  # fmt: skip
X = np.random.default_rng(0).uniform(-2, 2, (3, 4, 2))


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    return mc.compile(two_link(payload=0.5), FUNCTIONS, tmp_path_factory.mktemp("torch"))


def tensors(grad=False):
    return [torch.tensor(x, requires_grad=grad) for x in X]


def test_has_the_numbers_of_the_kernel(kernel):
    assert np.array_equal(kernel.torch.tau(*tensors()), kernel.tau(*X))
    assert np.array_equal(
        kernel.torch.tau(X[0], [0, 0], 1.0 * X[2, 0]), kernel.tau(X[0], [0, 0], X[2, 0])
    )
    found, expected = kernel.torch.tau_derivatives(*tensors()), kernel.tau_derivatives(*X)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
    assert kernel.torch.potential_energy(X[0, 0]) == kernel.potential_energy(X[0, 0])
    again = mc.Kernel(kernel.directory)
    assert np.array_equal(again.torch.tau(*tensors()), kernel.tau(*X))


def test_goes_through_vmap_and_compile(kernel):
    q, qd, qdd = tensors()
    mapped = torch.vmap(kernel.torch.tau, (None, 0, 1))(q[0], qd, qdd.T)
    assert np.array_equal(mapped, kernel.tau(X[0, 0], X[1], X[2]))
    by_q = torch.autograd.functional.jacobian(lambda q: kernel.torch.tau(q, qd, qdd).sum(0), q)
    assert np.allclose(by_q.transpose(0, 1), kernel.tau_derivatives(*X)[0], rtol=1e-13)
    whole = torch.compile(kernel.torch.tau, backend="eager", fullgraph=True)
    assert np.array_equal(whole(q, qd, qdd), kernel.tau(*X))


@pytest.mark.parametrize(
    ("name", "inputs"),
    [
        ("tau", 3), ("bias", 2), ("forward_dynamics", 3), ("potential_energy", 1),
        ("forward_kinematics", 1),
    ],
)  # fmt: skip
def test_gradients(kernel, name, inputs):
    given = tensors(grad=True)[:inputs]
    assert torch.autograd.gradcheck(getattr(kernel.torch, name), given)


def test_what_has_no_derivative_says_so(kernel):
    q, qd, qdd = tensors(grad=True)
    with pytest.raises(TypeError, match="inertia_matrix has no derivative here"):
        kernel.torch.inertia_matrix(q).sum().backward()
    (slope,) = torch.autograd.grad(kernel.torch.tau(q, qd, qdd).sum(), q, create_graph=True)
    with pytest.raises(TypeError, match="tau_derivatives has no derivative here"):
        slope.sum().backward()
    payload = torch.tensor([0.5], requires_grad=True)
    with pytest.raises(TypeError, match="no derivative by its run-time parameters"):
        kernel.torch.tau(q, qd, qdd, payload).sum().backward()


def test_parameters_and_wrong_calls(kernel):
    q, qd, qdd = tensors()
    found = kernel.torch.tau(q, qd, qdd, parameters={"payload": torch.ones(4)})
    assert np.array_equal(found, kernel.tau(*X, {"payload": 1}))
    with pytest.raises(ValueError, match="has no parameters mass"):
        kernel.torch.tau(q, qd, qdd, parameters={"mass": 1})
    with pytest.raises(TypeError, match="tau takes q, qd, qdd: 2 were given"):
        kernel.torch.tau(q, qd)
    with pytest.raises(ValueError, match=r"qd must have shape \(\.\.\., 2\), not \(3,\)"):
        kernel.torch.tau(q, [1, 2, 3], qdd)
    with pytest.raises(ValueError, match="on the CPU, and a tensor is on meta"):
        kernel.torch.tau(q.to("meta"), qd, qdd)
    with pytest.raises(AttributeError, match="no 'coriolis_matrix'; its functions are: tau"):
        _ = kernel.torch.coriolis_matrix
