"""Readers: each one makes a Model of what is given, and says where it is wrong.

source        where a robot's model comes from
dh            rows of Denavit-Hartenberg parameters
yaml          robot.yaml
hand_made     a Model made by hand
recognition   what a file is that is no robot.yaml
loading       the robot of a file, or a packaged one
"""
