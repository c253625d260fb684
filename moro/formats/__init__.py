"""Readers: each one makes a Model of what is given, and says where it is wrong; and robot.yaml out.

source        where a robot's model comes from
hand_made     a Model made by hand
coupling      joints that move by sums of joint variables
assembly      links as texts and files describe them, put together to a Model
assembled     these, as what a robot is given by
taken_apart   a Model as such links
dh            rows of Denavit-Hartenberg parameters
yaml          robot.yaml, and dictionaries with its fields
xml           XML as elements with their lines; what is hostile is refused
decimals      numbers of files, exact; angles and directions that decimals mean
urdf          URDF, the format of ROS
mjcf          MJCF, the format of MuJoCo
recognition   what a file is that is no robot file
loading       the robot of a file, or a packaged one
saving        any robot to a robot.yaml
"""
