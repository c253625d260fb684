"""Robots for tests: textbook arms with symbols, and seeded random arms of every kind."""

import sympy as sp

from moro import Robot
from moro.abc import g, joint_variable, l1, l2, q1, q2, symbol

pi = sp.pi


def planar(n):
    """Planar arm with centres of mass at lc_i from joint i, gravity -g along y."""
    robot = Robot(*((symbol("l", i), 0, 0, joint_variable(i)) for i in range(1, n + 1)))
    robot.masses = None
    robot.cm_positions = [[symbol("lc", i) - symbol("l", i), 0, 0] for i in range(1, n + 1)]
    robot.inertia_tensors = None
    robot.gravity = [0, -symbol("g"), 0]
    return robot


def symbolic(twists, a=True, d=True, kinds=None, convention="dh"):
    """Arm with these twists and everything else symbolic: lengths, masses, full tensors."""
    n = len(twists)
    kinds = kinds or "r" * n
    rows = []
    for i, (alpha, kind) in enumerate(zip(twists, kinds, strict=True), 1):
        q = joint_variable(i)
        length, offset = symbol("a", i) if a else 0, symbol("d", i) if d else 0
        rows.append((length, alpha, offset, q) if kind == "r" else (length, alpha, q, 0, "p"))
    robot = Robot(*rows, convention=convention)
    robot.masses = None
    robot.cm_positions = [[sp.Symbol(f"{x}_{i}") for x in "xyz"] for i in range(1, n + 1)]
    robot.inertia_tensors = [full_tensor(i) for i in range(1, n + 1)]
    robot.gravity = [0, 0, -symbol("g")]
    return robot


def full_tensor(i):
    return sp.Matrix(3, 3, lambda j, k: sp.Symbol(f"I_{''.join(sorted('xyz'[j] + 'xyz'[k]))}{i}"))


def symbolic_puma560():
    return symbolic([pi / 2, 0, -pi / 2, pi / 2, -pi / 2, 0])


def symbolic_seven():
    """Seven joints with alternating axes, as the KUKA LWR and iiwa have them."""
    return symbolic([pi / 2, -pi / 2] * 3 + [0], a=False)


def random_robot(rng, n, convention="dh", gravity=True):
    """Numeric arm with random joint types, twists (some parallel), offsets and inertias."""
    rows, tensors = [], []
    for i in range(1, n + 1):
        q, kind = joint_variable(i), rng.choice(["r", "r", "r", "p"])
        alpha = rng.choice([0, pi / 2, -pi / 2, pi, pi / 3, decimal(rng)])
        theta = rng.choice([0, pi / 2, -pi, pi / 4, decimal(rng)])
        a, d = rng.choice([0, decimal(rng)]), rng.choice([0, decimal(rng)])
        rows.append((a, alpha, d + q, theta, "p") if kind == "p" else (a, alpha, d, theta + q, "r"))
        tensors.append(random_tensor(rng))
    robot = Robot(*rows, convention=convention, name=f"random_{n}")
    robot.masses = [abs(decimal(rng)) + 1 for _ in range(n)]
    robot.cm_positions = [[decimal(rng) for _ in range(3)] for _ in range(n)]
    robot.inertia_tensors = tensors
    robot.gravity = [decimal(rng) for _ in range(3)] if gravity else [0, 0, 0]
    return robot


def decimal(rng):
    return sp.Rational(rng.randint(-100, 100), 100)


def random_tensor(rng):
    """Tensor of a body: its second moments are those of three points and a ball."""
    A = sp.Matrix(3, 3, lambda j, k: decimal(rng))
    S = A * A.T + sp.eye(3) / 20
    return sp.eye(3) * S.trace() - S


def two_links(**values):
    robot = Robot((l1, 0, 0, q1), (l2, 0, 0, q2))
    for name, value in values.items():
        setattr(robot, name, value)
    return robot


def complete():
    return two_links(
        masses=None,
        cm_positions=[[-sp.Symbol("x"), 0, 0], [-sp.Symbol("y"), 0, 0]],
        inertia_tensors=None,
        gravity=[0, -g, 0],
    )


# -- construction ---------------------------------------------------------------------------------
