"""Kernels against the symbolic route, and against 50 digits.

at_states        the formulas of the texts at states, as arrays
symbolic_route   what results must be at states
by_recursion     what results must be that closed forms made
verification     a kernel against the route that it was not made by
accuracy         a kernel against 50 digits
"""
