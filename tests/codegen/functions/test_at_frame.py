"""Functions at named frames, against the derivatives of the symbolic pose."""

import random
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import sympy as sp
from dynamics import exact_case
from robots import random_robot
from trees import sympified

import moro_codegen as mc
from moro import Robot
from moro.abc import q1, symbol
from moro.model import Frame, Placement, Shift, Turn
from moro_codegen.backends import c_text
from moro_codegen.emit.parts import in_parts
from moro_codegen.kernel.kernel import Kernel
from moro_codegen.program import generate

WRENCH = [1.5, -2.0, 0.5, 0.25, 3.0, -1.0]
ODD = 'left "hand"*/ camera'
AT_FRAMES = ("forward_kinematics", "jacobian", "tau_with_wrench")


def tree(seed):
    """A random tree with frames on an inner link, on the base and on the last link."""
    model = sympified(exact_case(seed, massive=True, tree=True).model)
    third = sp.Rational(1, 3)
    place = Placement.by(Shift((third, -third, 1)), Turn("x", third), Turn("z", sp.pi / 5))
    inner = Frame("camera", 1, place)
    frames = (inner, Frame("wall", -1, place), Frame("tool", len(model.joints) - 1, place))
    return replace(model, frames=frames)


def coupled(seed):
    """The same with its last joint moved by the first two coordinates."""
    model = tree(seed)
    *joints, last = model.joints
    last = replace(last, terms=((0, sp.Integer(-1)), (1, sp.Rational(1, 2))))
    return replace(model, joints=(*joints, last), coordinates=model.coordinates[:-1])


def pose_and_jacobian(robot, frame, q):
    """By differentiating the pose: the columns are dp/dq_k, and w of [w] = dR/dq_k R^T."""
    T = robot.T_i0(frame)
    T, *slopes = mc.lambdify([T, *(T.diff(x) for x in robot.qs)], robot)(q)
    spins = [slope[:3, :3] @ T[:3, :3].T for slope in slopes]
    columns = [
        [*slope[:3, 3], W[2, 1], W[0, 2], W[1, 0]] for slope, W in zip(slopes, spins, strict=True)
    ]
    return T, np.array(columns).T


def close(found, expected):
    return np.allclose(found, expected, rtol=0, atol=1e-12 * (1 + np.abs(expected).max()))


ROBOTS = [
    *((random_robot(random.Random(k), 5, convention), "3") for k, convention in
      enumerate(("dh", "mdh", "dh"))),
    *((Robot.of(tree(seed)), frame) for seed in (1, 3) for frame in ("camera", "wall", "2")),
    *((Robot.of(coupled(3)), frame) for frame in ("tool", "camera")),
]  # fmt: skip


@pytest.mark.sweep
@pytest.mark.parametrize(("robot", "frame"), ROBOTS)
def test_against_derivatives_of_the_pose(robot, frame, tmp_path):
    functions = ("tau", *(f"{name}@{frame}" for name in AT_FRAMES))
    backend = "c" if robot.convention else "numpy"
    kernel = mc.compile(robot, (*functions, functions), tmp_path, backend)
    n = robot.dof
    q, qd, qdd = np.random.default_rng(n).uniform(-2, 2, (3, n))
    T, J = pose_and_jacobian(robot, frame, q)
    of = {name: getattr(kernel, f"{name}_{frame}") for name in AT_FRAMES}
    assert close(of["forward_kinematics"](q), T)
    assert close(of["jacobian"](q), J)
    expected = kernel.tau(q, qd, qdd) - J.T @ WRENCH
    assert close(of["tau_with_wrench"](q, qd, qdd, WRENCH), expected)
    together = getattr(kernel, "_".join(name.replace("@", "_") for name in functions))
    for found, alone in zip(together(q, qd, qdd, WRENCH)[1:], (T, J, expected), strict=True):
        assert close(found, alone)
    assert mc.verify(Kernel(kernel.directory), robot).passed


def test_the_last_frame_by_its_name_is_the_last_frame(tmp_path):
    model = tree(3)
    kernel = mc.compile(model, ("jacobian", "jacobian@tool", "jacobian@0"), tmp_path)
    assert kernel.ops["jacobian"] == kernel.ops["jacobian_tool"]
    q = np.arange(len(model.qs)) / 3
    assert np.array_equal(kernel.jacobian(q), kernel.jacobian_tool(q))
    assert not kernel.jacobian_0(q).any()


def test_a_frame_elsewhere_fails_and_the_others_do_not(tmp_path):
    model = tree(1)
    kernel = mc.compile(model, ("jacobian@camera", "jacobian@tool"), tmp_path)
    camera, *rest = model.frames
    moved = replace(camera, placement=Placement.by(Shift((sp.Rational(1, 100), 0, 0))))
    errors = mc.verify(kernel, replace(model, frames=(moved, *rest))).max_errors
    assert errors["jacobian_camera"] > 1e-4
    assert errors["jacobian_tool"] < 1e-12
    with pytest.raises(ValueError, match="no frame is called 'camera'; there are 0 to "):
        mc.verify(kernel, replace(model, frames=()))


def test_frames_take_parameters(tmp_path):
    h = symbol("h")
    model = replace(tree(1), frames=(Frame("tip", 0, Placement.by(Shift((h, 0, 0)))),))
    robot = Robot.of(model)
    kernel = mc.compile(robot, ("forward_kinematics@tip",), tmp_path)
    q = [0.1] * robot.dof
    expected = mc.lambdify(robot.T_i0("tip"), robot)(q, {"h": 2.5})
    assert close(kernel.forward_kinematics_tip(q, {"h": 2.5}), expected)
    assert mc.verify(kernel, robot).passed


@pytest.mark.sweep
@pytest.mark.parametrize("backend", ["c", "cython", "numpy"])
def test_names_that_are_no_identifiers(backend, tmp_path):
    model = replace(tree(1), frames=(Frame(ODD, 0, Placement()),))
    kernel = mc.compile(model, (f"jacobian@{ODD}",), tmp_path, backend)
    assert list(kernel.signatures) == ["jacobian_left_hand_camera"]
    assert kernel.jacobian_left_hand_camera.__doc__.startswith('Jacobian of frame left "hand"')
    assert mc.verify(kernel, model).passed


def test_headers_say_which_frame(tmp_path):
    kernel = mc.compile(tree(1), ("tau_with_wrench", "tau_with_wrench@camera"), tmp_path)
    text = kernel.header.read_text()
    assert "moment about the origin of the last frame, on its link; in frame 0" in text
    assert "moment about the origin of frame camera, on its link; in frame 0" in text


def test_two_wrenches_in_one_call_are_two_arguments():
    (routine,) = generate(tree(1), [("tau_with_wrench@tool", "tau_with_wrench@camera")]).routines
    names = [a.name for a in routine.inputs]
    assert names[3:] == ["tau_with_wrench_tool_wrench", "tau_with_wrench_camera_wrench"]


@pytest.mark.parametrize(
    ("functions", "message"),
    [
        (("jacobian@camra",), r"called 'camra'; there are camera, wall, .*, 0 to .*\"camera\""),
        (("jacobian@",), "no frame is called ''"),
        (("jacobian@77",), "no frame is called '77'"),
        (("tau@camera",), "tau is of no frame; tau_with_wrench, forward_kinematics, jacobian, "),
        (("regressor@camera",), "regressor is of no frame"),
        (("jacobin@camera",), "no function 'jacobin'; did you mean 'jacobian'"),
        (("jacobian@a-b", "jacobian@a_b"), "called jacobian_a_b: jacobian@a-b and jacobian@a_b"),
        (("jacobian@camera", mc.Function("jacobian_camera", q1)), "two functions are called"),
        (("jacobian", "jacobian@batch"), "'jacobian_batch': that belongs to jacobian"),
        (("jacobian@+",), "no letter or digit"),
    ],
)
def test_refusals(functions, message):
    more = [Frame(name, 0, Placement()) for name in ("a-b", "a_b", "batch", "+")]
    model = replace(tree(1), frames=(*tree(1).frames, *more))
    with pytest.raises(ValueError, match=message):
        generate(model, functions)


def test_long_routines_leave_the_names_of_numbered_frames_free(tmp_path, monkeypatch):
    monkeypatch.setattr(c_text, "in_parts", partial(in_parts, length=1))
    model = tree(1)
    kernel = mc.compile(model, ("jacobian", "jacobian@1", "jacobian@2"), tmp_path)
    assert "jacobian_lanes_part_2(" in kernel.source.read_text()
    assert mc.verify(kernel, model).passed
