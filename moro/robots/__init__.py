"""Packaged arms, as data."""
