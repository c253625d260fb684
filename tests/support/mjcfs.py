"""Small MJCFs for tests."""

import mujoco

import moro as mr
import moro_codegen as mc
from benchmarks import survey
from benchmarks.mjcf_survey import Peer

#: actuators have armature from MuJoCo 4 on, and principal axes are right to more than 7 digits
IS_4 = int(mujoco.__version__.partition(".")[0]) >= 4
BALL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def inertial(mass=1, pos="0 0 0", more='diaginertia="1 1 1"'):
    return f'<inertial pos="{pos}" mass="{mass}" {more}/>'


def body(name, *inside, more=""):
    return f'<body name="{name}" {more}>' + "\n".join(inside) + "</body>"


def joint(name, more="", kind="hinge"):
    return f'<joint name="{name}" type="{kind}" {more}/>'


def robot(*bodies, rest="", radian=True, name="robot"):
    """A file of one body a line; the first is in line 3."""
    angle = '<compiler angle="radian"/>' if radian else ""
    start = [f'<mujoco model="{name}">{angle}', "<worldbody>"]
    return "\n".join([*start, *bodies, "</worldbody>", rest, "</mujoco>"])


def written(folder, text, name="robot.xml"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def loaded(folder, *bodies, **more):
    """The robot of a file, and its model."""
    how = {key: more.pop(key) for key in ("root", "tip", "fix", "as_written") if key in more}
    arm = mr.load(written(folder, robot(*bodies, **more)), **how)
    return arm, arm.model()


def worst(path, folder, **how):
    """The largest difference from MuJoCo, of whatever it computes too."""
    arm = mr.load(path, as_written=True, **how)
    peer = Peer(path, arm.joint_names, how.get("root"))
    functions = (*survey.FUNCTIONS, *survey.dynamics(arm))
    kernel = mc.compile(arm, functions=functions, backend="numpy", directory=folder)
    return max(survey.compared(arm, kernel, peer).values())
