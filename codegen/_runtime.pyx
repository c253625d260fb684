"""Loads kernels and checks arrays."""
