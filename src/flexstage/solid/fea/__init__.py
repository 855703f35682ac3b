"""Solid model: the description as a three-dimensional elastic body."""
