"""The mechanics of rigid bodies in space, over any scalar: only ``+ - *`` are asked of it.

angles       sines and cosines of plain numbers, as fractions
vectors      three-vectors and 3 x 3 matrices, as tuples
moments      the inertial parameters of a body
motion       velocities, accelerations, wrenches
transform    how all of these change between the frames of a link and of its parent
"""
