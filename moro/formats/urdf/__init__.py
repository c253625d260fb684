"""URDF, the format of ROS.

reading    elements and attributes, and what is wrong with them
elements   links and joints of a file, validated
structure  that they are one tree, and what mimics what
build      links that can be put together
reader     from a path to these
"""
