"""Kernels against the symbolic route, and against 50 digits.

at_states        the formulas of the texts at states, as arrays
symbolic_route   what results must be at states
verification     a kernel against the symbolic route
accuracy         a kernel against 50 digits
"""
