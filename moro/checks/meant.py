"""What was meant by a word that is not known: its synonym, the nearest word, or where to go."""

from __future__ import annotations

from collections.abc import Iterable

#: what the field calls the same thing; of each line, the words that are known are suggested
_SYNONYMS = [
    line.split()
    for line in (
        # functions of kernels
        "tau inverse_dynamics inverse_dynamic invdyn id rnea newton_euler torque torques",
        "inertia_matrix mass_matrix joint_space_inertia crba M D H",
        "coriolis_matrix coriolis centrifugal C",
        "gravity_vector gravity gravity_torque gravity_torques gravity_load gravload grav G g",
        "bias nonlinear_effects nle h N velocity_product coriolis_vector bias_forces",
        "forward_dynamics direct_dynamics aba fd fdyn accel acceleration accelerations qdd",
        "forward_kinematics direct_kinematics fk fkine kinematics pose tip T",
        "jacobian geometric_jacobian jacobian_matrix jacob0 jac J",
        "kinetic_energy kinetic K",
        "potential_energy potential P U V",
        "tau_derivatives inverse_dynamics_derivatives rnea_derivatives id_derivatives",
        "forward_dynamics_derivatives aba_derivatives fd_derivatives linearize linearise",
        "regressor joint_torque_regressor identification Y",
        "tau_with_wrench external_force external_wrench wrench fext contact",
        # fields of files, and what is set on a Robot
        "mass masses m weight",
        "com cm_positions cm coms cog center_of_mass centre_of_mass centers_of_mass r_cm",
        "inertia inertia_tensors inertia_tensor inertias tensor tensors I",
        "rotor_inertia rotor_inertias motor_inertia armature reflected_inertia Jm jm",
        "friction viscous_friction damping viscous_damping B",
        "viscous viscous_friction damping",
        "coulomb coulomb_friction Tc dry static_friction",
        "limits joint_limits limit range qlim position_limits",
        "gravity g gravity_vector",
        "joint joint_type type kind",
        "links joints rows dh",
        "parameters params symbols constants variables",
        "convention dh_convention",
        "xyz position origin translation offset",
        "rpy orientation euler roll_pitch_yaw",
        "R rotation rotation_matrix",
        "gear_ratio gear gears reduction",
        "static stiction breakaway static_friction",
        "smooth width tanh",
        "stiffness spring k",
        "bodies body payload payloads",
        "parent parent_link on",
        "tool tcp tool0 end_effector",
        "theta offset angle",
        "alpha twist",
        "a length",
    )
]

_GEAR = (
    "drives are given at the link side: rotor inertia and viscous friction of the motor times the"
    " gear ratio squared, Coulomb friction times the ratio; links of a robot.yaml, and of Robot.of,"
    " have gear_ratio"
)
_TOOL = (
    "a tool is part of the last link: its mass, centre of mass and inertia belong there, and the"
    " last row says where frame n is; a robot.yaml, and Robot.of, has bodies and a tool"
)
_BASE = (
    "frame 0 is the base: a tilted one is a matter of gravity, a shifted one of the first row; a"
    " robot.yaml, and Robot.of, has a base"
)

#: what is not there, and what to do
_ELSEWHERE = {
    "gear_ratio": _GEAR,
    "gear_ratios": _GEAR,
    "gear": _GEAR,
    "tool": _TOOL,
    "payload": f"{_TOOL}; one that changes is a parameter, a symbol in the mass",
    "end_effector": _TOOL,
    "flange": _TOOL,
    "base": _BASE,
    "base_frame": _BASE,
    "inverse_kinematics": "there are no inverse kinematics",
    "ikine": "there are no inverse kinematics",
    "ik": "there are no inverse kinematics",
    "jacobian_dot": 'make it one of yours: Function("jacobian_dot", robot.J.diff(t))',
    "jdot": 'make it one of yours: Function("jacobian_dot", robot.J.diff(t))',
}


def meant(word: str, known: Iterable[str]) -> str | None:
    """Return the one of the ``known`` words that ``word`` stands for, or is mistyped from."""
    known = list(known)
    for spelling in (word, word.lower()):
        for words in _SYNONYMS:
            if spelling in words and (there := [x for x in words if x in known and x != word]):
                return there[0]
    return nearest(word, known)


def elsewhere(word: str) -> str | None:
    """Return what to do for what has no place of its own."""
    return _ELSEWHERE.get(word.lower())


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word with the fewest slips of the finger to ``word``, if they are few.

    Or the only one that begins or ends with it.
    """
    typed, known = _plain(word), list(known)
    few = max(1, len(typed) // 4)
    near = [x for x in known if len(set(typed) ^ set(_plain(x))) <= 2 * few]  # of many, quickly
    slips = {x: _slips(typed, _plain(x)) for x in near}
    best = min(near, key=slips.__getitem__, default=None)
    if best is not None and slips[best] < len(typed) and slips[best] <= few:
        return best
    if len(typed) < 4:
        return None
    found = [x for x in known if _plain(x).startswith(typed) or _plain(x).endswith(typed)]
    return found[0] if len(found) == 1 else None


def _plain(word: str) -> str:
    return word.lower().replace("_", "").replace("-", "").replace(" ", "")


def _slips(a: str, b: str) -> int:
    """Count letters left out, put in, replaced, or swapped with the next one."""
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        earlier, before, row = before, row, [i]
        for j, y in enumerate(b, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (x != y))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                cost = min(cost, earlier[j - 2] + 1)
            row.append(cost)
    return row[-1]


def hint(word: str, known: Iterable[str]) -> str:
    """Return "did you mean 'x'? ", or what to do instead, to go before a list of what is known."""
    if advice := elsewhere(word):
        return f"{advice}; "
    name = meant(word, known)
    return f"did you mean {name!r}? " if name else ""
