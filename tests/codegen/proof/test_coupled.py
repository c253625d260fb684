"""Kernels of robots whose coordinates move several joints, and of every kind of drive."""

import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from functions import KINDS
from robots import random_robot
from trees import coupled, matrix_of, random_rows

import moro as mr
import moro_codegen as mc
from moro import Robot
from moro.model import REVOLUTE, Body, Coordinate, Drive, Joint, Model, Parameter, Placement

PALLETIZER = [[(0, 1)], [(1, 1)], [(2, 1)], [(1, -1), (2, -1)], [(3, 1)]]


def five_joints():
    """The first five joints of the PUMA."""
    model = mr.load("puma560").model()
    return replace(
        model, joints=model.joints[:5], bodies=model.bodies[:5], frames=model.frames[:5],
        coordinates=model.coordinates[:5],
    )  # fmt: skip


def verified(robot, directory, functions=KINDS):
    kernel = mc.compile(robot, functions=functions, directory=directory)
    verification = mc.verify(kernel, robot)
    assert verification.passed, verification.max_errors
    assert set(verification.errors) == set(functions)
    return kernel


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(3))
def test_random_robots(seed, tmp_path):
    rng = random.Random(seed)
    model = random_robot(rng, 4, ["dh", "mdh"][seed % 2]).model()
    verified(coupled(model, *random_rows(rng, 4)), tmp_path)


@pytest.mark.sweep
def test_a_palletizer(tmp_path):
    free = replace(five_joints(), coordinates=(Coordinate(),) * 5)
    model = replace(coupled(free, PALLETIZER, 4), coordinates=(Coordinate(),) * 4)
    kernel, of_joints = verified(model, tmp_path / "coupled"), mc.compile(free, ("tau", "jacobian"))
    A = np.array(matrix_of(PALLETIZER, 4), dtype=float)
    q, qd, qdd = np.random.default_rng(0).uniform(-2, 2, (3, 4))
    tau = of_joints.tau(A @ q, A @ qd, A @ qdd)
    np.testing.assert_allclose(kernel.tau(q, qd, qdd), A.T @ tau, rtol=1e-12)
    np.testing.assert_allclose(kernel.jacobian(q), of_joints.jacobian(A @ q) @ A, atol=1e-14)


def test_a_joint_that_counts_the_other_way_costs_nothing():
    free, rows = mr.load("puma560").model(), [[(i, (-1) ** i)] for i in range(6)]
    turned = replace(coupled(free, rows, 6), coordinates=free.coordinates)
    for function in ("tau", "inertia_matrix", "forward_dynamics"):
        ops = [mc.generate(model, (function,)).routines[0].ops for model in (free, turned)]
        assert sum(ops[1].values()) <= sum(ops[0].values()) + 6, function  # signs of torques


def test_a_ratio_at_run_time(tmp_path):
    r = sp.Symbol("r")
    model = coupled(five_joints(), [[(0, 1)], [(1, 1)], [(1, r), (2, 1)], [(3, r)], [(4, 1)]], 5)
    model = replace(model, parameters=(Parameter(r, sp.Rational(3, 2)),))
    kernel = verified(model, tmp_path, ("tau", "bias", "inertia_matrix", "coriolis_matrix"))
    assert kernel.parameters == {"r": 1.5}
    at_two = model.map(lambda x: sp.sympify(x).subs(r, 2))
    other = mc.compile(replace(at_two, parameters=(), name="at_two"), ("tau",))
    q, qd, qdd = np.random.default_rng(0).uniform(-2, 2, (3, 5))
    tau = kernel.tau(q, qd, qdd, {"r": 2})
    np.testing.assert_allclose(tau, other.tau(q, qd, qdd), rtol=1e-12)


def driven(**drive):
    """A pendulum of mass and length 1 without gravity, and this drive."""
    rod = Body(1, (1, 0, 0), ((0, 0, 0), (0, 1, 0), (0, 0, 1)))
    model = Model("pendulum", (Joint(REVOLUTE, -1, Placement()),), (rod,), (0, 0, 0))
    free = {s for x in drive.values() for s in sp.sympify(x).free_symbols}
    return replace(
        model,
        coordinates=(Coordinate(drive=Drive(**drive)),),
        parameters=tuple(Parameter(s) for s in sorted(free, key=str)),
    )


class TestDrives:
    @pytest.mark.parametrize(
        ("drive", "qd", "torque"),
        [
            ({"coulomb": (3, 5)}, -2, -5),
            ({"coulomb": (3, 5), "width": sp.Rational(1, 2)}, 1, 4 * np.tanh(2) - np.tanh(2) ** 2),
            ({"coulomb": (3, 5), "width": 1}, 0, 0),
            ({"coulomb": (3, 3), "static": (4, 5), "stribeck_velocity": 2}, 2, 3 + np.exp(-1)),
            ({"coulomb": (3, 3), "static": (4, 5), "stribeck_velocity": 2}, -4,
             -3 - 2 * np.exp(-4)),
            ({"viscous": 7, "rotor_inertia": 100}, 2, 14),
        ],
    )  # fmt: skip
    def test_friction(self, drive, qd, torque, tmp_path):
        kernel = verified(driven(**drive), tmp_path)
        assert kernel.bias([0.3], [qd]) == pytest.approx(torque, rel=1e-14)

    def test_springs_are_in_the_potential_energy(self, tmp_path):
        model = driven(stiffness=sp.Rational(5), rest=sp.Rational(1, 2))
        kernel = verified(model, tmp_path)
        assert kernel.gravity_vector([2]) == pytest.approx(7.5)
        assert kernel.tau([2], [0], [0]) == pytest.approx(7.5)
        assert kernel.potential_energy([2]) == pytest.approx(2.5 * 1.5**2)
        robot, (q,) = Robot.of(model), model.qs
        half = sp.Rational(1, 2)
        assert robot.simplify(robot.potential_energy() - 5 * half * (q - half) ** 2) == 0
        assert robot.lagrangian() == robot.kinetic_energy() - robot.potential_energy()
        assert robot.gravity_vector()[0] == sp.diff(robot.potential_energy(), q)

    def test_constants_at_run_time(self, tmp_path):
        c, s, v, w, k, x = sp.symbols("c s v w k x", positive=True)
        drive = {"coulomb": (c, c), "static": (s, s), "stribeck_velocity": v, "width": w,
                 "stiffness": k, "rest": x}  # fmt: skip
        kernel = verified(driven(**drive), tmp_path)
        values = {"c": 3, "s": 4, "v": 2, "w": 0.5, "k": 10, "x": 1}
        expected = np.tanh(2 / 0.5) * (3 + np.exp(-1)) + 10 * (0.2 - 1)
        assert kernel.bias([0.2], [2], values) == pytest.approx(expected, rel=1e-14)

    def test_the_regressor_is_linear_in_them(self, tmp_path):
        third = sp.Rational(1, 3)
        drive = {"coulomb": (3, 5), "static": (4, 9), "stribeck_velocity": 2, "width": third,
                 "stiffness": 7, "rest": third, "viscous": 1, "rotor_inertia": 2}  # fmt: skip
        model = driven(**drive)
        names = [str(x.symbol) for x in Robot.of(model).base_parameters()]
        assert names[1:] == ["FV_1", "FC_1", "FD_1", "FS_1", "FE_1", "KQ_1", "KR_1"]
        kernel = verified(model, tmp_path)
        Y, p = kernel.regressor([0.4], [0.7], [1.3])
        assert Y @ p == pytest.approx(kernel.tau([0.4], [0.7], [1.3]), rel=1e-13)
