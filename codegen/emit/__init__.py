"""Programs as text: C, Cython, NumPy."""
