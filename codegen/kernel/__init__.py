"""What a user calls: kernels, and where they are kept."""
