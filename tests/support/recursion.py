"""The recursive algorithms from a model, its positions and sines: posture and algorithm in one."""

from dataclasses import replace

from moro.algorithms.articulated_body import joint_accelerations
from moro.algorithms.body_regressor import body_regressor
from moro.algorithms.composite_rigid_body import joint_inertia
from moro.algorithms.coriolis import joint_coriolis
from moro.algorithms.energies import energy_of_motion, energy_of_position
from moro.algorithms.external_wrench import joint_torques_in_contact
from moro.algorithms.kinematics import frame_jacobian, poses
from moro.algorithms.newton_euler import joint_torques
from moro.algorithms.posture import posture, with_frame
from moro.model import Coordinate


def inverse_dynamics(model, q, qd, qdd, sincos):
    return joint_torques(posture(model, q, sincos), qd, qdd)


def inverse_dynamics_in_contact(model, q, qd, qdd, wrench, sincos):
    return joint_torques_in_contact(with_tip(model, q, sincos), qd, qdd, wrench)


def forward_dynamics(model, q, qd, tau, sincos):
    return joint_accelerations(posture(model, q, sincos), rotors(model), qd, tau)


def inertia_matrix(model, q, sincos):
    return joint_inertia(posture(model, q, sincos), rotors(model))


def coriolis_matrix(model, q, qd, sincos):
    return joint_coriolis(posture(model, q, sincos), qd)


def kinetic_energy(model, q, qd, sincos):
    return energy_of_motion(posture(model, q, sincos), rotors(model), qd)


def potential_energy(model, q, sincos):
    return energy_of_position(posture(model, q, sincos))


def forward_kinematics(model, q, sincos):
    return poses(with_tip(model, q, sincos))[-1]


def jacobian(model, q, sincos):
    return frame_jacobian(with_tip(model, q, sincos))


def regressor(model, q, qd, qdd, sincos):
    return body_regressor(posture(model, q, sincos), qd, qdd)


def with_tip(model, q, sincos):
    return with_frame(posture(model, q, sincos), model.tip.link, model.tip.placement)


def rotors(model):
    return [x.drive.rotor_inertia for x in model.coordinates]


def without_rotors(model):
    drives = [replace(x.drive, rotor_inertia=0) for x in model.coordinates]
    return replace(model, coordinates=tuple(Coordinate(drive=x) for x in drives))


def parameters(model):
    """p of the regressor: its PARAMETERS of all bodies."""
    return [x for body in model.bodies for x in body_parameters(body)]


def body_parameters(body):
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    return (xx, xy, xz, yy, yz, zz, *body.first_moment, body.mass)
