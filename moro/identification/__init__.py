"""Identification: what torques tell of a robot's inertial parameters.

standard_parameters   what the energies are linear in
independence          which of their functions depend on others
base_parameters       those that torques can tell apart
regressor             tau = Y p
"""
