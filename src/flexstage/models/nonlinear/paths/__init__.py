"""Paths of equilibria and their critical points."""
