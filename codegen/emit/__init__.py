"""Programs as text: C, NumPy."""
