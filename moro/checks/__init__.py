"""Checks of what people give: each says what was found, what was expected, and what was meant.

values        numbers, vectors, tensors, names
constants     constants that can be computed, and those that are zero
tensors       the ways in which tensors of inertia are written
given         values as they were given
plausibility  units and orders that are probably not meant
frame_called  the frame that is meant
meant         what was probably meant by a word
callers       the line of the user's that a warning is about
"""
