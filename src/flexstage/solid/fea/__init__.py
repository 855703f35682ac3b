"""Solid reading: the description as a three-dimensional elastic body."""
