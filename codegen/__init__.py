"""Kernels from robot models."""
