"""What tests of the algorithms share: exact cases, and numbers by routes outside the algorithms."""

from dataclasses import dataclass, replace

import numpy as np
from arms import numeric, reference_model, reference_states, sincos
from exact import exact_arm, exact_state, rational
from recursion import inverse_dynamics

from moro.closed_form import ClosedForm
from moro.model import Coordinate, Drive, Model
from moro.scalars.dual import DualRing


@dataclass
class Exact:
    """A tree of point masses, with rotors, at an exact state."""

    model: Model
    points: list
    sincos: list
    q: list
    qd: list
    qdd: list

    @property
    def n(self):
        return self.model.dof

    @property
    def rotors(self):
        return [x.drive.rotor_inertia for x in self.model.coordinates]

    def torques(self, qd, qdd, gravity=True):
        """Newton-Euler, with the rotors (tested against point masses in test_newton_euler)."""
        model = self.model if gravity else replace(self.model, gravity=(0, 0, 0))
        rigid = inverse_dynamics(model, self.q, qd, qdd, self.sincos)
        return [x + rotor * a for x, rotor, a in zip(rigid, self.rotors, qdd, strict=True)]

    @property
    def M(self):
        """The inertia matrix, column by column."""
        rest, unit = [0] * self.n, np.eye(self.n, dtype=int).tolist()
        return [self.torques(rest, e, gravity=False) for e in unit]


def exact_case(seed, massive=False, tree=None):
    """An arm (odd seeds: a tree) of up to 6 joints; ``massive``: whose inertia is not singular."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    model, points = exact_arm(rng, n, tree=bool(seed % 2) if tree is None else tree)
    rotors = [abs(rational(rng)) + massive if rng.random() < 0.5 + massive else 0 for _ in range(n)]
    coordinates = tuple(Coordinate(drive=Drive(rotor)) for rotor in rotors)
    return Exact(replace(model, coordinates=coordinates), points, *exact_state(rng, n))


def reference_case(name):
    """(model, sincos, state) of all states of a packaged arm together."""
    states = reference_states(name)
    state = {key: np.array([s[key] for s in states]) for key in states[0]}
    model = numeric(reference_model(name))
    return model, sincos(model, state["q"].T), state


def by_formulas(robot, q):
    """Jacobian sums and Christoffel symbols of a robot at q (n, samples), not in closed form."""
    ring = DualRing(robot.qs, dict(zip(robot.qs, q, strict=True)))
    return ClosedForm(robot.model(), ring), ring


def numbers(rows):
    """Values of a vector or a matrix over DualRing, samples last."""
    if isinstance(rows[0], (list, tuple)):
        return np.array([[x.value for x in row] for row in rows])
    return np.array([x.value for x in rows])


def assert_close(found, expected, rtol=1e-12):
    """Equal to within rtol of the largest entry of each sample (samples last)."""
    expected = np.asarray(expected, dtype=float)
    found = arrays(found, expected.shape[-1])
    assert found.shape == expected.shape
    axes = tuple(range(expected.ndim - 1))
    largest = np.abs(expected).max(axis=axes) if axes else np.abs(expected)
    floor = 1e-9 * np.abs(expected).max() + 1e-300
    assert (np.abs(found - expected) <= rtol * np.maximum(largest, floor)).all()


def arrays(values, samples):
    """Nested sequences of numbers and of arrays over samples, as one array."""
    if isinstance(values, (list, tuple)):
        return np.array([arrays(x, samples) for x in values])
    return np.broadcast_to(np.asarray(values, dtype=float), (samples,))
