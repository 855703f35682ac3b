"""Meshes, their fineness, and error estimates from their sequence."""
