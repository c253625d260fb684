"""The expression graph as text: C, Cython, NumPy."""
