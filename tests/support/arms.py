"""Arms for tests: the packaged ones with their reference numbers, and random ones of every kind."""

import json
from pathlib import Path

import numpy as np
import sympy as sp
import yaml

from moro.model import PRISMATIC, REVOLUTE, Body, Coordinate, Drive, Frame, Joint, Model, Placement

NAMES = ("puma560", "stanford_arm", "panda", "ur5", "two_link")
TESTS = Path(__file__).parents[1]


def reference_states(name):
    """States of a packaged arm with numbers from outside moro (see tests/reference)."""
    return json.loads((TESTS / "reference" / f"{name}.json").read_text())["states"]


def reference_model(name):
    """Model of a packaged arm, exact, made here from the file and not by moro."""
    data = yaml.safe_load((TESTS.parent / "moro" / "robots" / f"{name}.yaml").read_text())
    links = data["links"]
    rows = [
        (*vector(link[key] for key in ("a", "alpha", "d", "theta")), link["joint"][0])
        for link in links
    ]
    frictions = [link.get("friction", {}) for link in links]
    coulombs = [np.broadcast_to(friction.get("coulomb", 0), 2) for friction in frictions]
    drives = [
        {
            "rotor_inertia": exact(link.get("rotor_inertia", 0)),
            "viscous": exact(friction.get("viscous", 0)),
            "coulomb": tuple(exact(x) for x in coulomb.tolist()),
        }
        for link, friction, coulomb in zip(links, frictions, coulombs, strict=True)
    ]
    bodies = [(exact(link["mass"]), vector(link["com"]), tensor(link["inertia"])) for link in links]
    return model_from_rows(
        rows, data["convention"], bodies, vector(data["gravity"]), drives, data["name"]
    )


def exact(value):
    """SymPy number or expression of a value of a file, decimals as rationals."""
    return sp.Rational(repr(value)) if isinstance(value, float) else sp.sympify(value)


def vector(values):
    return tuple(exact(value) for value in values)


def tensor(values):
    xx, yy, zz, xy, xz, yz = vector(values)
    return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))


def model_from_rows(rows, convention, bodies, gravity, drives=(), name="arm", parents=None):
    """Model of rows (a, alpha, d, theta, "r" | "p"), with theta or d the constant part.

    ``bodies``: (mass, centre of mass, tensor about it), in the frames of the convention. With
    ``parents``, joint i comes after row ``parents[i]`` (-1: the base) instead of row i - 1.
    """
    count = len(rows)
    parents = list(range(-1, count - 1)) if parents is None else parents
    joints, placed = [], []
    for i, (a, alpha, d, theta, kind) in enumerate(rows):
        revolute = kind == "r"
        fixed = sp.Matrix([0, 0, 0 if not revolute else d])
        turn = sp.eye(3) if revolute else rotation(2, theta)
        if convention == "mdh":
            before = rotation(0, alpha), sp.Matrix([a, 0, 0])
        elif parents[i] < 0:
            before = sp.eye(3), sp.zeros(3, 1)
        else:
            before = after(rows[parents[i]])
        R, p = before[0] * turn, before[1] + before[0] * fixed
        joints.append(
            Joint(
                REVOLUTE if revolute else PRISMATIC,
                parents[i],
                Placement(as_tuples(R), tuple(p)),
                theta if revolute else d,
            )
        )
        mass, cm, inertia = bodies[i]
        R, p = after(rows[i]) if convention == "dh" else (sp.eye(3), sp.zeros(3, 1))
        cm, J = p + R * sp.Matrix(cm), R * sp.Matrix(inertia) * R.T
        J += mass * (cm.dot(cm) * sp.eye(3) - cm * cm.T)
        placed.append(Body(mass, tuple(mass * cm), as_tuples(J)))
    R, p = after(rows[-1]) if convention == "dh" else (sp.eye(3), sp.zeros(3, 1))
    tip = Frame("tip", count - 1, Placement(as_tuples(R), tuple(p)))
    coordinates = tuple(Coordinate(drive=Drive(**drive)) for drive in drives or [{}] * count)
    return Model(name, tuple(joints), tuple(placed), tuple(gravity), (tip,), coordinates)


def after(row):
    """What a standard DH row puts after its joint: Tx(a) Rx(alpha), as rotation and position."""
    return rotation(0, row[1]), sp.Matrix([row[0], 0, 0])


def rotation(axis, angle):
    turn = {0: sp.rot_axis1, 2: sp.rot_axis3}[axis](angle)
    return turn.T  # SymPy's turns the axes


def as_tuples(matrix):
    return tuple(tuple(row) for row in sp.Matrix(matrix).tolist())


def random_rows(rng, n, kinds="rrrp"):
    """n rows of random geometry: parallel, crossing, intersecting and general axes, all joints."""
    rows = []
    for _ in range(n):
        alpha = rng.choice([0, 1, -1, 2, 3]) * sp.pi / 2
        if rng.random() < 0.25:
            alpha = decimal(rng)
        a, d, theta = (decimal(rng) if rng.random() < 0.6 else sp.Integer(0) for _ in range(3))
        if rng.random() < 0.3:
            theta = rng.choice([-1, 1, 2]) * sp.pi / 2
        rows.append((a, alpha, d, theta, str(rng.choice(list(kinds)))))
    return rows


def random_bodies(rng, n):
    """n bodies (mass, centre of mass, tensor about it); now and then a point, a rod, or nothing."""
    bodies = []
    for _ in range(n):
        cm = [decimal(rng) if rng.random() < 0.7 else sp.Integer(0) for _ in range(3)]
        mass = sp.Integer(0) if rng.random() < 0.1 else abs(decimal(rng))
        points = sp.Matrix(3, 3, lambda *_: decimal(rng)) if rng.random() < 0.7 else sp.zeros(3)
        second = points * points.T / 10
        tensor = second.trace() * sp.eye(3) - second if mass else sp.zeros(3)
        bodies.append((mass, cm, as_tuples(tensor)))
    return bodies


def random_drives(rng, n):
    """n sets of rotor inertia and friction; now and then none."""
    sets = []
    for _ in range(n):
        rotor, viscous, positive, negative = (
            abs(decimal(rng)) if rng.random() < 0.7 else sp.Integer(0) for _ in range(4)
        )
        sets.append({"rotor_inertia": rotor, "viscous": viscous, "coulomb": (positive, negative)})
    return sets


def random_model(rng, n, tree=False, kinds="rrrp"):
    """Random arm (or tree) of n joints, exact: either convention, all kinds of joint and body."""
    parents = [int(rng.integers(-1, i)) if tree else i - 1 for i in range(n)]
    gravity = [decimal(rng) for _ in range(3)] if rng.random() < 0.5 else vector([0, 0, -9.81])
    return model_from_rows(
        random_rows(rng, n, kinds),
        str(rng.choice(["dh", "mdh"])),
        random_bodies(rng, n),
        gravity,
        random_drives(rng, n),
        parents=parents,
    )


def decimal(rng):
    """Random number of three decimals in (-1, 1), not 0."""
    return sp.Rational(int(rng.integers(1, 1000)) * int(rng.choice([-1, 1])), 1000)


def random_state(rng, n):
    """Positions, velocities and accelerations, as three arrays."""
    return rng.uniform(-3, 3, (3, n))


def numeric(model):
    """The model in floats."""
    return model.map(float)


def sincos(model, q):
    """Pairs for the algorithms."""
    return [
        (np.sin(x + j.offset), np.cos(x + j.offset)) for x, j in zip(q, model.joints, strict=True)
    ]
