"""Rotors: bodies that spin beside the turning of what carries them."""

import random
from dataclasses import replace

import pytest
import sympy as sp
from robots import random_robot, symbolic

import moro as mr
import moro_codegen as mc
from moro import Robot
from moro.abc import g, l1, lc1, m1, m2, q1, q2, q3, t
from moro.model import REVOLUTE, ROTOR, Body, Frame, Joint, Placement, Shift, Turn

a1, a2, k1, k2 = sp.symbols("a_1 a_2 k_r1 k_r2")
SYMBOLS = sp.symbols("m_l1 m_l2 m_m2 l_1 l_2 I_l1 I_l2 I_m1 I_m2")
ml1, ml2, mm2, L1, L2, Il1, Il2, Im1, Im2 = SYMBOLS


def siciliano():
    """Siciliano et al., Robotics, section 7.3.2: a planar arm with the motors at its joints."""
    motor_2 = {"mass": mm2, "com": [0, 0, 0], "inertia": [0, 0, 0]}
    row = {"joint": "revolute", "alpha": 0, "d": 0, "theta": 0}
    return Robot.of({
        "gravity": [0, -g, 0],
        "links": [
            {**row, "a": a1, "mass": ml1, "com": [L1 - a1, 0, 0], "inertia": [0, 0, Il1],
             "bodies": [motor_2]},
            {"joint": "rotor", "parent": 0, "theta": k1 * q1, "inertia": [0, 0, Im1]},
            {**row, "a": a2, "mass": ml2, "com": [L2 - a2, 0, 0], "inertia": [0, 0, Il2]},
            {"joint": "rotor", "parent": 1, "theta": k2 * q2, "inertia": [0, 0, Im2]},
        ],
    })  # fmt: skip


def test_the_planar_arm_with_motors():
    robot = siciliano()
    b11 = (Il1 + ml1 * L1**2 + k1**2 * Im1 + Il2 + ml2 * (a1**2 + L2**2 + 2 * a1 * L2 * sp.cos(q2))
           + Im2 + mm2 * a1**2)  # fmt: skip
    b12 = Il2 + ml2 * (L2**2 + a1 * L2 * sp.cos(q2)) + k2 * Im2
    b22 = Il2 + ml2 * L2**2 + k2**2 * Im2
    B = sp.Matrix([[b11, b12], [b12, b22]])
    assert robot.simplify(robot.inertia_matrix() - B) == sp.zeros(2, 2)
    h = -ml2 * a1 * L2 * sp.sin(q2)
    qd1, qd2 = q1.diff(t), q2.diff(t)
    C = sp.Matrix([[h * qd2, h * (qd1 + qd2)], [-h * qd1, 0]])
    assert robot.simplify(robot.coriolis_matrix() - C) == sp.zeros(2, 2)
    g2 = ml2 * L2 * g * sp.cos(q1 + q2)
    g1 = (ml1 * L1 + mm2 * a1 + ml2 * a1) * g * sp.cos(q1) + g2
    assert robot.simplify(robot.gravity_vector() - sp.Matrix([g1, g2])) == sp.zeros(2, 1)
    assert robot.joint_types == ["r", "r"]
    assert robot.model().tip.name == "2"
    assert len(robot.Ts) == 2


def test_rotors_of_rows():
    of_links = siciliano().with_parameters({mm2: 0})
    robot = Robot((a1, 0, 0, q1), (a2, 0, 0, q2))
    robot.masses, robot.gravity = [ml1, ml2], [0, -g, 0]
    robot.cm_positions = [[L1 - a1, 0, 0], [L2 - a2, 0, 0]]
    robot.inertia_tensors = [sp.diag(0, 0, Il1), sp.diag(0, 0, Il2)]
    robot.rotors = [(Im1, k1), (Im2, k2)]
    assert robot.rotors == [(Im1, k1), (Im2, k2)]
    assert robot.inertia_matrix() == of_links.inertia_matrix()
    assert "rotors" in robot.model_summary()
    assert robot.with_parameters({Im1: 0, k2: 9}).rotors == [(0, k1), (Im2, 9)]
    robot.rotors = [None, (Im2, k2)]
    assert not robot.inertia_matrix().has(Im1)
    robot.rotors = None
    assert robot.inertia_matrix()[1, 1] == Il2 + L2**2 * ml2


def spinning(robot, rng):
    """A model with rotors on its links that stand askew, and the same with joints that turn."""
    model = robot.model()
    last = len(model.joints) - 1
    rotors, bodies = [], []
    for i, carrying in ((last, last), (0, 0), (last, -1)):
        T, I, m = (abs(rng.randint(1, 9)) for _ in range(3))
        z = sp.Rational(rng.randint(-5, 5), 10)
        h, J = (0, 0, m * z), ((T + m * z**2, 0, 0), (0, T + m * z**2, 0), (0, 0, I))
        p = tuple(sp.Rational(rng.randint(-5, 5), 10) for _ in range(3))
        turns = Turn("x", sp.pi / rng.randint(2, 4)), Turn("z", sp.pi / 3)
        place = Placement.by(Shift(p), *turns)
        rotors.append(Joint(ROTOR, carrying, place, terms=((i, sp.Integer(rng.randint(2, 4))),)))
        bodies.append(Body(m, h, J))
    frames = model.frames or (Frame("tip", last, Placement()),)
    model = replace(model, bodies=(*model.bodies, *bodies), frames=frames)
    turning = [replace(x, type=REVOLUTE) for x in rotors]
    return (
        replace(model, joints=(*model.joints, *rotors)),
        replace(model, joints=(*model.joints, *turning)),
    )


@pytest.mark.parametrize("seed", range(4))
def test_a_rotor_is_a_joint_of_a_body_of_revolution(seed):
    """As if it turned: the closed forms are one, and the angles of rotors are in none."""
    rng = random.Random(seed)
    robot = random_robot(rng, 2, rng.choice(["dh", "mdh"]))
    still, turning = map(Robot.of, spinning(robot, rng))
    for method in ("inertia_matrix", "coriolis_matrix", "gravity_vector", "lagrangian"):
        found, expected = (sp.Matrix([getattr(x, method)()]) for x in (still, turning))
        assert still.simplify(found - expected) == sp.zeros(*found.shape), method
    equations = [sp.Matrix([x.lhs for x in y.dynamic_model()]) for y in (still, turning)]
    assert still.simplify(equations[0] - equations[1]) == sp.zeros(2, 1)


def test_the_torques_are_linear_in_their_inertia():
    robot = siciliano()
    names = [str(x) for x in robot.base_parameters().symbols]
    assert names == ["ZZR_1", "MXR_1", "ZZ_2", "MX_2", "ZZ_4"]
    Y, p = robot.regressor()
    left = sp.Matrix([x.lhs for x in robot.dynamic_model()])
    assert robot.simplify(Y * p - left) == sp.zeros(2, 1)


def test_kernels_take_no_sine_of_a_rotor(tmp_path):
    rng = random.Random(5)
    robot = random_robot(rng, 3, "mdh")
    model, _ = spinning(robot, rng)
    functions = (
        "tau", "bias", "inertia_matrix", "coriolis_matrix", "kinetic_energy", "regressor",
        "forward_dynamics", "tau_derivatives",
    )  # fmt: skip
    kernel = mc.compile(model, functions, directory=tmp_path, backend="numpy")
    verification = mc.verify(kernel, Robot.of(model))
    assert verification.passed, verification.max_errors
    plain = mc.generate(robot, ("tau",)).routines[0].ops["sincos"]
    assert kernel.ops["tau"]["sincos"] == plain


def wheel(**more):
    """A pendulum with a flywheel: Spong, Corke & Lozano, Automatica 37 (2001)."""
    return Robot.of({
        "gravity": [0, -g, 0],
        "tool": {"xyz": [l1, 0, 0]},
        "links": [
            {"joint": "revolute", "axis": "z", "mass": m1, "com": [lc1, 0, 0],
             "inertia": [0, 0, Il1]},
            {"joint": "rotor", "xyz": [l1, 0, 0], "mass": m2, "com": [0, 0, 0],
             "inertia": [0, 0, Im2]} | more,
        ],
    })  # fmt: skip


def test_a_flywheel_has_a_coordinate_of_its_own():
    robot = wheel()
    assert robot.joint_types == ["r", "m"]
    assert robot.frames == ["1", "tool"]
    D = sp.Matrix([[Il1 + m1 * lc1**2 + m2 * l1**2 + Im2, Im2], [Im2, Im2]])
    assert robot.simplify(robot.inertia_matrix() - D) == sp.zeros(2, 2)
    held = robot.gravity_vector()[0] - g * (m1 * lc1 + m2 * l1) * sp.cos(q1)
    assert robot.simplify(held) == 0


def test_files_and_parts(tmp_path):
    robot = siciliano()
    robot.save(tmp_path / "arm.yaml")
    loaded = mr.load(tmp_path / "arm.yaml")
    text = (tmp_path / "arm.yaml").read_text()
    assert "joint: rotor\n    parent: 0\n    axis: z\n    theta: k_r1*q1" in text
    assert loaded.simplify(loaded.inertia_matrix() - robot.inertia_matrix()) == sp.zeros(2, 2)
    upper = mr.load(tmp_path / "arm.yaml", tip="1")
    rest = Il1 + ml1 * L1**2 + mm2 * a1**2 + k1**2 * Im1
    assert upper.qs == [q1]
    assert upper.simplify(upper.inertia_matrix()[0, 0] - rest) == 0  # what is on the tip is not
    fixed = mr.load(tmp_path / "arm.yaml", fix={"q2": sp.pi / 2}).inertia_matrix()[0, 0]
    locked = Il2 + ml2 * (a1**2 + L2**2) + Im2
    assert upper.simplify(fixed - rest - locked) == 0
    assert "Rotors, the links that carry them" in with_rotors().report("tex")


def with_rotors():
    robot = symbolic([0, 0])
    robot.rotors = [None, (Im2, k2)]
    return robot


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("com", [1, 0, 0], r"symmetric about the z axis .* its first moment is not"),
        ("inertia", [1, 2, 3], "its inertia is not"),
        ("frames", {"x": {"xyz": [0, 0, 0]}}, "nothing is on a rotor; leave them out"),
    ],
)
def test_what_is_no_rotor(field, value, said):
    with pytest.raises(ValueError, match=said):
        wheel(**{field: value})


def test_what_is_no_list_of_rotors():
    robot = symbolic([0, 0])
    with pytest.raises(ValueError, match="rotors of joint 2 must be"):
        robot.rotors = [None, (1, 2, 3)]
    with pytest.raises(ValueError, match="ratio in rotors of joint 1 must not be 0"):
        robot.rotors = [(1, 0), None]
    with pytest.raises(ValueError, match="rotors must have 2 values"):
        robot.rotors = [None]
    with pytest.raises(ValueError, match="must be constant, not"):
        robot.rotors = [(q3, 1), None]
    model = with_rotors().model()
    on_rotor = replace(model.joints[0], parent=2, terms=((0, 1),))
    with pytest.raises(ValueError, match="joint 3 is a rotor"):
        Robot.of(
            replace(
                model, joints=(*model.joints, on_rotor), bodies=(*model.bodies, model.bodies[0])
            )
        )
