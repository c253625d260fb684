"""Against MuJoCo: torques, inertia matrix, poses and Jacobians of whatever a file may hold."""

import random

import pytest
from mjcfs import IS_4, body, inertial, joint, robot, worst, written

pytestmark = pytest.mark.filterwarnings("ignore::moro.formats.errors.RobotFileWarning")


def vector(rng, n=3):
    return " ".join(f"{rng.uniform(-1, 1):.3f}" for _ in range(n))


def placed(rng):
    turn = rng.choice(
        [
            f'quat="{vector(rng, 4)}"',
            f'euler="{vector(rng)}"',
            f'axisangle="{vector(rng, 4)}"',
            f'zaxis="{vector(rng)}"',
            'quat="0.7071 0 0.7071 0"',
            "",
        ]
    )
    return f'pos="{vector(rng)}" {turn}'


def moved(rng, name):
    kind = rng.choice(["hinge", "hinge", "slide"])
    axis = rng.choice([vector(rng), "0 0 1", "0 -1 0", "1 0 0"])
    acts = "".join(
        f' {key}="{rng.uniform(0.1, 1):.2f}"'
        for key in ("armature", "damping", "frictionloss", "stiffness", "springref", "ref")
        if rng.random() < 0.4
    )
    return joint(name, f'axis="{axis}" pos="{vector(rng)}"{acts}', kind)


def solid(rng):
    if rng.random() < 0.3:
        shape = rng.choice(["box", "ellipsoid", "capsule", "cylinder"])
        return f'<geom type="{shape}" size="0.1 0.2 0.3" {placed(rng)}/>'
    if IS_4 and rng.random() < 0.3:
        return inertial(2, vector(rng), 'fullinertia="1 1.1 1.2 0.1 -0.2 0.3"')
    turn = f'quat="{vector(rng, 4)}"'
    return inertial(1.5, vector(rng), f'diaginertia="0.5 0.6 0.7" {turn}')


def tree(rng, count):
    """Bodies on bodies, some without joints, some with two, in frames at times."""
    inside = [[] for _ in range(count + 1)]
    joints = 0
    for k in range(count, 0, -1):
        own = [solid(rng), f'<site name="s{k}" {placed(rng)}/>']
        for _ in range(rng.choice([0, 1, 1, 2]) if k > 1 else 1):
            own.append(moved(rng, f"q{joints}"))
            joints += 1
        text = body(f"b{k}", *own, *inside[k], more=placed(rng))
        if rng.random() < 0.3:
            text = f"<frame {placed(rng)}>{text}</frame>"
        inside[rng.randrange(k)].append(text)
    return inside[0], joints


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(6))
def test_random_trees(tmp_path, seed):
    rng = random.Random(seed)
    bodies, joints = tree(rng, rng.randint(2, 6))
    ties = ""
    if joints > 2:
        ties = (
            '<equality><joint joint1="q0" joint2="q1" polycoef="0.1 -1.5 0 0 0"/></equality>'
            '<option gravity="1 2 -9"/>'
        )
    assert worst(written(tmp_path, robot(*bodies, rest=ties)), tmp_path) < 1e-9


def test_a_floating_robot_that_is_held(tmp_path):
    leg = body("leg", joint("hip", 'axis="0 1 0"'), inertial(1, "0 0 -0.2"), more='pos="0 0.1 0"')
    trunk = body("trunk", "<freejoint/>", inertial(5), leg, more='pos="0 0 1" euler="0.3 0.2 0.1"')
    path = written(tmp_path, robot(trunk))
    assert worst(path, tmp_path, root="trunk") < 1e-9


def test_what_moves_freely_and_carries_nothing_is_left_out(tmp_path):
    cube = body("cube", "<freejoint/>", '<geom size="0.1" mass="9"/>', '<site name="top"/>')
    arm = body("arm", joint("q1", 'axis="0 1 0"'), inertial(1, "0 0 1"))
    assert worst(written(tmp_path, robot(cube, arm)), tmp_path) < 1e-9
